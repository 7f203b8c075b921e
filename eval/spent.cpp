// SPDX-License-Identifier: Apache-2.0
#include "eval/spent.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

double number_at(const Json& object, const char* key) {
    const Json value = object.value(key, Json());
    return value.is_number() ? value.get<double>() : 0.0;
}

}  // namespace

Spent spent_before(const RunDirectory& directory, const std::string& matrix) {
    const std::string file = directory.file("run.json");
    if (!std::filesystem::exists(file)) return {};
    const Json before = Json::parse(read_file(file), nullptr, false);
    const Json found = before.is_object() ? before.value("name", Json()) : "";
    const std::string name = found.is_string() ? found.get<std::string>() : found.dump();
    if (name == matrix) return {number_at(before, "seconds"), number_at(before, "samples")};
    throw Error(ExitCode::usage, directory.path() + ": found results of the matrix \"" + name +
                                     "\", allowed: \"" + matrix + "\" or an empty directory");
}

}  // namespace vecino
