// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "eval/reproduction.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

std::string outcome_text(PairOutcome outcome) {
    switch (outcome) {
        case PairOutcome::holds:
            return "holds";
        case PairOutcome::fails:
            return "fails";
        case PairOutcome::open:
            return "open";
        case PairOutcome::missing:
            break;
    }
    return "missing";
}

Json pair_json(const PairResult& pair) {
    Json json{{"scene", pair.scene},
              {"of", pair.of},
              {"than", pair.than},
              {"outcome", outcome_text(pair.outcome)}};
    if (pair.outcome != PairOutcome::missing)
        json["difference_db"] = estimate_json(pair.difference_db);
    if (pair.published_db) json["published_db"] = *pair.published_db;
    return json;
}

Json claim_json(const ClaimResult& result) {
    Json json{{"variant", result.variant},
              {"region", result.region.empty() ? "whole" : result.region},
              {"verdict", verdict_text(result.verdict)},
              {"holds", result.holds},
              {"fails", result.fails},
              {"open", result.open},
              {"missing", result.missing},
              {"pairs", Json::array()}};
    for (const PairResult& pair : result.pairs) json["pairs"].push_back(pair_json(pair));
    return json;
}

}  // namespace

Json reproduction_json(const Reproduction& specification, const ReproductionResult& result) {
    Json json{{"items", Json::array()}, {"claims", Json::array()}};
    for (std::size_t i = 0; i < specification.items.size(); ++i) {
        const Item& item = specification.items[i];
        const ItemResult& found = result.items[i];
        json["items"].push_back({{"id", item.id},
                                 {"published", item.published},
                                 {"unit", item.unit},
                                 {"ours", estimate_json(found.ours)},
                                 {"tested", estimate_json(found.tested)},
                                 {"ratio", found.ours ? Json(found.ratio) : Json(nullptr)},
                                 {"verdict", verdict_text(found.verdict)},
                                 {"slowest", found.slowest},
                                 {"remark", found.remark}});
    }
    for (std::size_t i = 0; i < specification.claims.size(); ++i) {
        Json results = Json::array();
        for (const ClaimResult& each : result.claims[i]) results.push_back(claim_json(each));
        json["claims"].push_back({{"id", specification.claims[i].id}, {"results", results}});
    }
    return json;
}

}  // namespace vecino
