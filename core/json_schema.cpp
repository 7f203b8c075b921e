// SPDX-License-Identifier: Apache-2.0
#include "core/json_schema.h"

#include <limits>
#include <utility>

namespace vecino {

nlohmann::json IntegerKind::schema() const {
    nlohmann::json schema{{"type", "integer"}, {"minimum", least}};
    if (most < std::numeric_limits<int>::max()) schema["maximum"] = most;
    return schema;
}

nlohmann::json RealKind::schema() const {
    const NumberRange unbounded;
    nlohmann::json schema{{"type", "number"}};
    if (range.least > unbounded.least) schema["minimum"] = range.least;
    if (range.most < unbounded.most) schema["maximum"] = range.most;
    return schema;
}

nlohmann::json Vec3Kind::schema() const {
    return array_schema(RealKind{range}.schema(), {3, 3});
}

nlohmann::json array_schema(const nlohmann::json& element, ElementCount count) {
    nlohmann::json schema{{"type", "array"}, {"items", element}};
    if (count.least > 0) schema["minItems"] = count.least;
    if (count.most > 0) schema["maxItems"] = count.most;
    return schema;
}

nlohmann::json document_schema(const std::string& title, nlohmann::json schema) {
    schema["$schema"] = "http://json-schema.org/draft-07/schema#";
    schema["title"] = title;
    return schema;
}

}  // namespace vecino
