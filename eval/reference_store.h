// SPDX-License-Identifier: Apache-2.0
//
// References of a run: rendered once, shared by all cells that are held against them, kept in the
// run directory.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "core/grid.h"
#include "eval/run_directory.h"

namespace vecino {

struct StoredReference {
    Image image;
    std::string file;  ///< relative to the run directory, without extension
};

class ReferenceStore {
  public:
    explicit ReferenceStore(const RunDirectory& directory) : directory_(directory) {}

    /// The reference that key describes in full (scene, its state, settings, program). Made by make
    /// unless memory or the directory has it.
    const StoredReference& get(const std::string& key, const std::string& scene,
                               const std::function<Image()>& make);

  private:
    const RunDirectory& directory_;
    std::map<std::string, StoredReference> references_;
};

/// 16 hexadecimal digits that tell texts apart.
std::string text_hash(const std::string& text);

}  // namespace vecino
