// SPDX-License-Identifier: Apache-2.0
#include "eval/matrix.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/named_values.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

constexpr Named<Budget> kBudgets[] = {
    {"same_spp", Budget::same_spp},
    {"equal_samples", Budget::equal_samples},
};

/// Values chosen for a cell, by key. Keys that stand here show in the cell's name.
using Assignment = std::map<std::string, JsonValue>;
using Axes = std::map<std::string, std::vector<JsonValue>>;

std::vector<std::string_view> cell_keys() {
    std::vector<std::string_view> keys{"scene", "scheme", "budget"};
    for (const RenderOption& row : render_options()) keys.push_back(row.name);
    for (const SchemeOption& row : scheme_options()) keys.push_back(row.name);
    return keys;
}

void require_value(const std::string& key, const JsonValue& value) {
    if (key == "scene") {
        (void)value.string();
    } else if (key == "scheme") {
        std::vector<std::string_view> names;
        for (const Scheme& scheme : all_schemes()) names.push_back(scheme.name);
        if (std::ranges::find(names, value.string()) == names.end()) value.fail(join(names));
    } else if (key == "budget") {
        (void)value_of(kBudgets, value);
    } else {
        RenderSettings settings;
        SchemeParameters parameters;
        for (const RenderOption& row : render_options()) {
            if (row.name == key) row.set(settings, value);
        }
        for (const SchemeOption& row : scheme_options()) {
            if (row.name == key) row.set(parameters, value);
        }
    }
}

/// "size" takes an array as one value; everywhere else an array lists several.
std::vector<JsonValue> listed(const std::string& key, const JsonValue& value) {
    const bool one_size = key == "size" && value.raw().is_array() && !value.raw().empty() &&
                          !value.raw().front().is_array();
    if (one_size || !value.raw().is_array()) return {value};
    auto values = value.elements();
    if (values.empty()) value.fail("at least one value");
    return values;
}

Axes read_axes(const JsonValue& json) {
    json.require_keys(cell_keys());
    Axes axes;
    for (const auto& [key, value] : json.members()) {
        for (const JsonValue& each : listed(key, value)) require_value(key, each);
        axes.insert_or_assign(key, listed(key, value));
    }
    return axes;
}

void for_each_assignment(const Axes& axes, const std::function<void(const Assignment&)>& visit) {
    Assignment current;
    const std::function<void(Axes::const_iterator)> descend = [&](Axes::const_iterator axis) {
        if (axis == axes.end()) return visit(current);
        for (const JsonValue& value : axis->second) {
            current.insert_or_assign(axis->first, value);
            descend(std::next(axis));
        }
    };
    descend(axes.begin());
}

bool matches(const Assignment& cell, const Axes& pattern) {
    return std::ranges::all_of(pattern, [&](const auto& entry) {
        const auto found = cell.find(entry.first);
        return found != cell.end() &&
               std::ranges::any_of(entry.second, [&](const JsonValue& value) {
                   return value.raw() == found->second.raw();
               });
    });
}

class Expansion {
  public:
    explicit Expansion(const Matrix& matrix)
        : matrix_(matrix), json_(matrix.document, matrix.file) {}

    std::vector<Cell> run() {
        if (json_.has("fixed")) {
            for (const auto& [key, value] : json_.at("fixed").members())
                fixed_.insert_or_assign(key, value);
        }
        const Axes axes = read_axes(json_.at("axes"));
        std::vector<Axes> excluded;
        if (json_.has("exclude")) {
            for (const JsonValue& pattern : json_.at("exclude").elements()) {
                excluded.push_back(read_axes(pattern));
            }
        }
        for_each_assignment(axes, [&](const Assignment& assignment) {
            const auto fits = [&](const Axes& pattern) { return matches(assignment, pattern); };
            if (std::ranges::none_of(excluded, fits)) add(assignment);
        });
        if (json_.has("include")) {
            for (const JsonValue& extra : json_.at("include").elements()) add_include(axes, extra);
        }
        // Cells that read the same frame stand together; scenes in the order in which they are
        // named.
        std::ranges::stable_sort(cells_, {},
                                 [&](const Cell& cell) { return scene_order_.at(cell.scene); });
        return std::move(cells_);
    }

  private:
    void add_include(Axes axes, const JsonValue& extra) {
        for (const auto& [key, values] : read_axes(extra)) axes.insert_or_assign(key, values);
        for_each_assignment(axes, [&](const Assignment& assignment) { add(assignment); });
    }

    std::optional<JsonValue> value(const Assignment& assignment, const std::string& key) const {
        if (const auto found = assignment.find(key); found != assignment.end())
            return found->second;
        if (const auto found = fixed_.find(key); found != fixed_.end()) return found->second;
        return std::nullopt;
    }

    void add(const Assignment& assignment) {
        const auto scheme = value(assignment, "scheme");
        if (!scheme)
            json_.at("axes").fail("no key \"scheme\"", "\"scheme\" among the axes or in fixed");
        push(make_cell(assignment, nullptr), assignment);
        push(make_cell(assignment, &find_scheme(scheme->string())), assignment);
    }

    Cell make_cell(const Assignment& assignment, const Scheme* scheme) const {
        Cell cell;
        cell.scheme = scheme;
        const auto scene = value(assignment, "scene");
        if (!scene)
            json_.at("axes").fail("no key \"scene\"", "\"scene\" among the axes or in fixed");
        const auto folder = std::filesystem::path(matrix_.file).parent_path();
        cell.scene = (folder / scene->string()).lexically_normal().string();
        for (const RenderOption& row : render_options()) {
            if (row.name == "reduction" && scheme == nullptr) continue;
            if (const auto given = value(assignment, std::string(row.name)))
                row.set(cell.settings, *given);
        }
        if (scheme == nullptr) return cell;
        for (const SchemeOption& row : scheme_options()) {
            if (!scheme->reads(row.name)) continue;
            if (const auto given = value(assignment, std::string(row.name)))
                row.set(cell.parameters, *given);
        }
        if (const auto budget = value(assignment, "budget"))
            cell.budget = value_of(kBudgets, *budget);
        spend_budget(cell);
        return cell;
    }

    static void spend_budget(Cell& cell) {
        const auto full = static_cast<double>(cell.settings.size.area());
        const auto low =
            static_cast<double>(reduced(cell.settings.size, cell.settings.reduction).area());
        const double spp = cell.settings.spp;
        if (cell.budget == Budget::equal_samples) {
            cell.settings.spp = static_cast<int>(std::lround(spp * full / low));
        }
        cell.samples_ratio = static_cast<double>(cell.settings.spp) * low / (spp * full);
    }

    void set_name(Cell& cell, const Assignment& assignment) const {
        std::string name = stem(cell.scene) + "." + cell.method();
        const auto append = [&name](const std::string& part) { name += "." + part; };
        if (cell.scheme != nullptr) {
            append("f" + std::to_string(cell.settings.reduction));
            for (const SchemeOption& row : scheme_options()) {
                if (!cell.scheme->reads(row.name)) continue;
                if (row.name == "window" || assignment.contains(std::string(row.name))) {
                    append(row.slug(cell.parameters));
                }
            }
            if (cell.budget != Budget::same_spp) append(name_of(kBudgets, cell.budget));
        }
        // spp is named as it was asked for, not as a budget turned it out
        for (const RenderOption& row : render_options()) {
            if (row.name == "reduction" || row.name == "seed") continue;
            const auto given = assignment.find(std::string(row.name));
            if (given == assignment.end()) continue;
            RenderSettings asked;
            row.set(asked, given->second);
            append(row.slug(asked));
        }
        cell.group = name;
        cell.name = name + ".s" + std::to_string(cell.settings.seed);
    }

    void push(Cell cell, const Assignment& assignment) {
        set_name(cell, assignment);
        scene_order_.try_emplace(cell.scene, scene_order_.size());
        const auto [same, is_new] = by_name_.try_emplace(cell.name, cell.parameters_json());
        if (is_new) {
            cells_.push_back(std::move(cell));
        } else if (same->second != cell.parameters_json()) {
            throw Error(ExitCode::usage,
                        matrix_.file + ": /axes: found two different cells named " + cell.name +
                            ", allowed: scene files of different names");
        }
    }

    const Matrix& matrix_;
    JsonValue json_;
    Assignment fixed_;
    std::vector<Cell> cells_;
    std::map<std::string, nlohmann::json> by_name_;
    std::map<std::string, std::size_t> scene_order_;
};

RenderSettings read_reference(const JsonValue& json) {
    constexpr std::string_view kKeys[] = {"spp", "light_sampling", "sampler", "seed"};
    json.require_keys(kKeys);
    RenderSettings settings;
    for (const RenderOption& row : render_options()) {
        const bool known = std::ranges::find(kKeys, row.name) != std::end(kKeys);
        if (known && json.has(row.name)) row.set(settings, json.at(row.name));
    }
    return settings;
}

void check_fixed(const JsonValue& json) {
    json.require_keys(cell_keys());
    for (const auto& [key, value] : json.members()) require_value(key, value);
}

}  // namespace

std::string stem(const std::string& path) {
    return std::filesystem::path(path).stem().string();
}

std::string Cell::method() const {
    return scheme == nullptr ? "path" : std::string(scheme->name);
}

nlohmann::json Cell::parameters_json() const {
    nlohmann::json json{{"scene", scene}, {"method", method()}};
    for (const RenderOption& row : render_options())
        json[std::string(row.name)] = row.get(settings);
    if (scheme == nullptr) return json;
    json["budget"] = name_of(kBudgets, budget);
    for (const SchemeOption& row : scheme_options()) {
        if (scheme->reads(row.name)) json[std::string(row.name)] = row.slug(parameters);
    }
    if (scheme->reads("window")) json["window"] = parameters.window;
    return json;
}

Matrix load_matrix(const std::string& path) {
    Matrix matrix;
    matrix.file = path;
    matrix.document = parse_json_file(path);
    const JsonValue json(matrix.document, path);
    json.require_keys({"name", "axes", "exclude", "include", "fixed", "reference", "measure"});
    matrix.name = json.at("name").string();
    if (json.has("fixed")) check_fixed(json.at("fixed"));
    matrix.reference = read_reference(json.at("reference"));
    if (json.has("measure")) {
        json.at("measure").require_keys({"repeat"});
        if (json.at("measure").has("repeat"))
            matrix.repeat = json.at("measure").at("repeat").integer(1, 1000);
    }
    (void)read_axes(json.at("axes"));
    return matrix;
}

std::vector<Cell> expand(const Matrix& matrix) {
    return Expansion(matrix).run();
}

RenderSettings reference_settings(const Matrix& matrix, const Cell& cell) {
    RenderSettings settings = matrix.reference;
    settings.size = cell.settings.size;
    settings.max_depth = cell.settings.max_depth;
    settings.reduction = 1;
    return settings;
}

}  // namespace vecino
