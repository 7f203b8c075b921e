// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/json_mutator.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

namespace vecino::fuzz {
namespace {

using Json = nlohmann::json;

std::size_t below(std::size_t count, RandomEngine& random) {
    return random() % count;
}

/// What readers trip over: bounds, what float cannot hold, and values of other kinds.
Json odd_value(RandomEngine& random) {
    static const std::vector<Json> values = {0,
                                             -0.0,
                                             1,
                                             -1,
                                             2,
                                             0.5,
                                             1e-30,
                                             1e-46,
                                             1e20,
                                             3e38,
                                             -3e38,
                                             3.5e38,
                                             1e300,
                                             -1e300,
                                             1.7e308,
                                             5e-324,
                                             65536,
                                             65537,
                                             2147483647,
                                             -2147483648LL,
                                             4294967296LL,
                                             9223372036854775807LL,
                                             18446744073709551615ULL,
                                             1e9,
                                             255,
                                             9999,
                                             nullptr,
                                             true,
                                             false,
                                             "",
                                             "path",
                                             "mean",
                                             "none",
                                             "\n",
                                             "a/b",
                                             "..",
                                             "{seed}",
                                             Json::array(),
                                             Json::object(),
                                             Json::array({1, 2, 3}),
                                             Json::array({0, 0, 0})};
    return values[below(values.size(), random)];
}

void collect(Json& json, std::vector<Json*>& nodes) {
    nodes.push_back(&json);
    if (!json.is_structured()) return;
    for (Json& child : json) collect(child, nodes);
}

Json& any_node(Json& json, RandomEngine& random) {
    std::vector<Json*> nodes;
    collect(json, nodes);
    return *nodes[below(nodes.size(), random)];
}

Json::iterator any_child(Json& json, RandomEngine& random) {
    return std::next(json.begin(), static_cast<std::ptrdiff_t>(below(json.size(), random)));
}

void scale_number(Json& node, RandomEngine& random) {
    static constexpr double factors[] = {-1, 0.5, 2, 1e-6, 1e6, 1 + 1e-7, 1e30, 1e-30};
    node = node.get<double>() * factors[below(std::size(factors), random)];
}

void change_structure(Json& node, RandomEngine& random) {
    switch (below(3, random)) {
        case 0:
            node.erase(any_child(node, random));
            break;
        case 1: {
            Json copy = *any_child(node, random);
            if (node.is_array()) {
                node.push_back(std::move(copy));
            } else {
                node[any_child(node, random).key() + "2"] = std::move(copy);
            }
            break;
        }
        default:
            any_child(node, random)->swap(*any_child(node, random));
    }
}

void change(Json& json, RandomEngine& random) {
    Json& node = any_node(json, random);
    if (node.is_structured() && !node.empty() && below(3, random) != 0) {
        change_structure(node, random);
    } else if (node.is_number() && below(2, random) == 0) {
        scale_number(node, random);
    } else if (below(4, random) == 0) {
        Json copy = any_node(json, random);
        node = std::move(copy);
    } else {
        node = odd_value(random);
    }
}

std::string text_of(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string mutated_json(const std::string& text, std::size_t most_bytes, RandomEngine& random) {
    Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) return "";
    for (std::size_t i = below(3, random) + 1; i > 0; --i) change(json, random);
    std::string result = text_of(json);
    return result.size() <= most_bytes ? result : "";
}

std::string crossed_json(const std::string& text, const std::string& other, RandomEngine& random) {
    Json json = Json::parse(text, nullptr, false);
    Json from = Json::parse(other, nullptr, false);
    if (json.is_discarded() || from.is_discarded()) return "";
    any_node(json, random) = any_node(from, random);
    return text_of(json);
}

}  // namespace vecino::fuzz
