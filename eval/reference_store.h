// SPDX-License-Identifier: Apache-2.0
//
// References of a run: rendered once, shared by all cells that are held against them, kept in the
// run directory with the first hits that tell regions apart and the light's parts.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "core/frame.h"
#include "eval/regions.h"
#include "eval/run_directory.h"

namespace vecino {

struct StoredReference {
    Image image;
    RegionMap regions;
    std::string file;  ///< relative to the run directory, without extension
};

/// What a reference is rendered with: its regions' planes, and direct and indirect light.
Planes reference_planes();

class ReferenceStore {
  public:
    explicit ReferenceStore(const RunDirectory& directory) : directory_(directory) {}

    /// The reference that key describes in full (scene, its state, settings, program). Made by make
    /// unless memory or the directory has it.
    const StoredReference& get(const std::string& key, const std::string& scene,
                               const std::function<Frame()>& make);

  private:
    const RunDirectory& directory_;
    std::map<std::string, StoredReference> references_;
};

/// 16 hexadecimal digits that tell texts apart.
std::string text_hash(const std::string& text);

}  // namespace vecino
