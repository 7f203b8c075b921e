// SPDX-License-Identifier: Apache-2.0
//
// What a matrix holds a publication's results against: its measured items, its claims as predicates
// over cells, its graphs and figures. The "reproduction" part of a matrix file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/selection.h"

namespace vecino {

/// A way to run the same claims: as published, with another light sampling, with other weights.
struct Variant {
    std::string id, label;
    Selection where;  ///< with the matrix's fixed values where it names none
    /// What differs from `where` in the results that decide claims and shares: one costly seed, as
    /// published, has no interval, but several cheaper ones have. Empty: those of `where` decide.
    Selection tested_at;

    /// The same variant at the results that decide.
    [[nodiscard]] Variant tested() const;
};

enum class Quantity {
    quality,    ///< psnr_float_db
    noise,      ///< variance over seeds of the display values, mean over pixels and channels
    signature,  ///< of the failure that the scene shows (eval/failure.h)
};

enum class Relation { higher, lower, same };

/// "emitter", "edge" or "interior"; empty is the whole image.
using RegionName = std::string;

/// Holds when `of` is higher (lower) than `than` by more than margin_db, or the same within
/// margin_db, in every pair of results that agree in all parameters which neither selection names.
struct ClaimTest {
    Quantity quantity = Quantity::quality;
    Selection of, than;
    RegionName of_region, than_region;  ///< where each is measured; empty: the whole image
    Relation relation = Relation::higher;
    double margin_db = 0;
};

struct Claim {
    std::string id, section, text;
    std::string note;  ///< how the words were turned into numbers
    std::vector<ClaimTest> tests;
    bool any = false;  ///< one pair per scene is enough
};

enum class ItemQuantity {
    time,                ///< of the slowest result, s
    largest_time_share,  ///< of the slowest result, of the slowest path tracing's
    extrapolated_time,   ///< of the slowest result, at another number of samples
};

/// A number that the publication states.
struct Item {
    std::string id, section, text;
    std::string note;  ///< what to know when reading it
    double published = 0;
    std::string unit;  ///< "%", "min" or "h"
    ItemQuantity quantity = ItemQuantity::time;
    Selection of;
    double within = 0;  ///< points by which a share may differ; 0: times of another machine
    int spp = 0;        ///< of an extrapolated time
};

struct Graph {
    std::string id, title;
    Selection of;
};

enum class FigureKind {
    mosaic,     ///< one panel per result
    reference,  ///< the reference of each scene
    light,      ///< direct, indirect and both, from the reference
    strips,     ///< one picture in strips, of growing spp
};

struct Figure {
    std::string id, title;
    FigureKind kind = FigureKind::mosaic;
    std::vector<Selection> of;  ///< one after the other
};

struct Reproduction {
    std::string source;             ///< what is reproduced
    std::vector<Variant> variants;  ///< the first is as published; at least one
    Selection times_at;  ///< parameters at which published times (not shares) mean anything
    std::vector<Item> items;
    std::vector<Claim> claims;
    std::vector<Graph> graphs;
    std::vector<Figure> figures;
};

/// Of a matrix document with a "reproduction". Throws Error(usage) naming file, JSON pointer, what
/// was found and what is allowed.
Reproduction read_reproduction(const JsonValue& matrix);

}  // namespace vecino
