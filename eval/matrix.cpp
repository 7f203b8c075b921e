// SPDX-License-Identifier: Apache-2.0
#include "eval/matrix.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/files.h"
#include "eval/axes.h"
#include "eval/failure_needs.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

/// Values chosen for a cell, by key. Keys that stand here show in the cell's name.
using Assignment = std::map<std::string, JsonValue>;

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

/// Before any is made: more would take days to run, and fill the memory before.
void require_few_cells(const Axes& axes, const JsonValue& json) {
    constexpr double kMostCells = 100000;
    double count = 1;
    for (const auto& [key, values] : axes) count *= static_cast<double>(values.size());
    if (count <= kMostCells) return;
    char text[64];
    std::snprintf(text, sizeof text, "%.10g cells", count);
    json.fail(text, "at most 100000");
}

/// Cells have folders of their names.
void require_folder_name(const std::string& name, const std::string& file) {
    constexpr std::size_t kLongest = 200;
    const bool is_long = name.size() > kLongest;
    if (!is_long && name == one_line(name)) return;
    throw Error(ExitCode::usage,
                one_line(file + ": /axes: found the cell name " +
                         (is_long ? name.substr(0, 60) + "... of " + std::to_string(name.size()) +
                                        " bytes, allowed: at most 200"
                                  : name + ", allowed: names without control characters")));
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
        : matrix_(matrix), json_(matrix.document, matrix.file), needs_(json_, matrix.failures) {}

    std::vector<Cell> run() {
        if (json_.has("fixed")) {
            for (const auto& [key, value] : json_.at("fixed").members())
                fixed_.insert_or_assign(key, value);
        }
        Axes axes = read_axes(json_.at("axes"));
        const bool names_scenes = axes.contains("scene") || fixed_.contains("scene");
        if (!names_scenes && !needs_.scenes().empty()) axes["scene"] = needs_.scenes();
        add_axes(axes);
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
    /// Scene by scene, with what each needs.
    void for_each_needed(const Axes& axes, const std::function<void(const Assignment&)>& visit) {
        needed_.clear();
        if (!axes.contains("scene")) return for_each_assignment(axes, visit);
        for (const JsonValue& scene : axes.at("scene"))
            for_each_assignment(needs_.apply(axes, scene, needed_), visit);
    }

    void add_axes(const Axes& axes) {
        require_few_cells(axes, json_.at("axes"));
        std::vector<Axes> excluded;
        if (json_.has("exclude")) {
            for (const JsonValue& pattern : json_.at("exclude").elements()) {
                excluded.push_back(read_axes(pattern));
            }
        }
        for_each_needed(axes, [&](const Assignment& assignment) {
            const auto fits = [&](const Axes& pattern) { return matches(assignment, pattern); };
            if (std::ranges::none_of(excluded, fits)) add(assignment);
        });
    }

    /// What an include does not name, it takes from the axes.
    void add_include(Axes axes, const JsonValue& extra) {
        const Axes own = read_axes(extra);
        const bool is_image = own.contains("image");
        if (own.contains("method") || is_image) {
            std::erase_if(axes, [&](const auto& axis) {
                return is_scheme_key(axis.first) && !(is_image && axis.first == "reduction");
            });
        }
        if (own.contains("scheme") || is_image) {
            std::erase_if(axes, [](const auto& axis) {
                return axis.first == "method" || is_method_key(axis.first);
            });
        }
        if (own.contains("scheme") || own.contains("method")) axes.erase("image");
        for (const auto& [key, values] : own) axes.insert_or_assign(key, values);
        require_few_cells(axes, extra);
        for_each_needed(axes, [&](const Assignment& assignment) { add(assignment); });
    }

    std::optional<JsonValue> value(const Assignment& assignment, const std::string& key) const {
        if (const auto found = assignment.find(key); found != assignment.end())
            return found->second;
        if (const auto found = needed_.find(key); found != needed_.end()) return found->second;
        if (const auto found = fixed_.find(key); found != fixed_.end()) return found->second;
        return std::nullopt;
    }

    void add(const Assignment& assignment) {
        if (const auto image = value(assignment, "image")) return add_image(assignment, *image);
        Cell path = make_cell(assignment, CellKind::path);
        set_name(path, assignment);
        path.against = path.group;
        const std::string against = path.group;
        push(std::move(path));
        const auto scheme =
            assignment.contains("method") ? std::nullopt : value(assignment, "scheme");
        const auto method = value(assignment, "method");
        if (!scheme && method)
            return add_method(assignment, find_method(method->string()), against);
        if (!scheme)
            json_.at("axes").fail("no key \"scheme\"", "\"scheme\" among the axes or in fixed");
        push_ceiling(assignment);
        Cell cell = make_cell(assignment, CellKind::scheme);
        cell.scheme = &find_scheme(scheme->string());
        cell.parameters = cell.scheme->defaults;
        read_scheme_options(cell, assignment);
        set_name(cell, assignment);
        cell.against = against;
        push(std::move(cell));
    }

    void add_method(const Assignment& assignment, const Method& method,
                    const std::string& against) {
        if (&method == &all_methods().front()) return;  // path tracing is there already
        Cell cell = make_cell(assignment, CellKind::method);
        cell.render_method = &method;
        for (const MethodOption& row : method_options()) {
            if (!method.reads(row.name)) continue;
            if (const auto given = value(assignment, std::string(row.name)))
                row.set(cell.method_parameters, *given);
        }
        set_name(cell, assignment);
        cell.against = against;
        push(std::move(cell));
    }

    void add_image(const Assignment& assignment, const JsonValue& name) {
        Cell cell = make_cell(assignment, CellKind::image);
        cell.image = matrix_.images.at(name.string());
        cell.is_against_render = matrix_.reference_source == nullptr;
        Assignment read = assignment;
        std::erase_if(read, [&](const auto& entry) { return !reads(cell, entry.first); });
        if (!reads(cell, "seed")) cell.settings.seed = RenderSettings{}.seed;
        cell.group = stem(cell.scene) + "." + cell.method();
        if (read.contains("reduction")) append_render_slugs(cell.group, read, {"reduction"});
        append_render_slugs(cell.group, read);
        cell.name = cell.group + ".s" + std::to_string(cell.settings.seed);
        push(std::move(cell));
    }

    void push_ceiling(const Assignment& assignment) {
        Cell ceiling = make_cell(assignment, CellKind::blocky_ceiling);
        ceiling.group = stem(ceiling.scene) + "." + ceiling.method();
        ceiling.group += ".f" + std::to_string(ceiling.settings.reduction);
        append_render_slugs(ceiling.group, assignment, {"size", "max_depth", "camera_shift"});
        ceiling.name = ceiling.group;
        push(std::move(ceiling));
    }

    Cell make_cell(const Assignment& assignment, CellKind kind) const {
        Cell cell;
        cell.kind = kind;
        const auto scene = value(assignment, "scene");
        if (!scene)
            json_.at("axes").fail("no key \"scene\"", "\"scene\" among the axes or in fixed");
        cell.scene = (std::filesystem::path(folder_of(matrix_)) / scene->string())
                         .lexically_normal()
                         .string();
        if (kind == CellKind::scheme) cell.inject = needs_.injections(scene->string());
        for (const RenderOption& row : render_options()) {
            const bool is_whole = kind == CellKind::path || kind == CellKind::method;
            if (row.name == "reduction" && is_whole) continue;
            if (const auto given = value(assignment, std::string(row.name)))
                row.set(cell.settings, *given);
        }
        cell.spp_asked = cell.settings.spp;
        return cell;
    }

    void read_scheme_options(Cell& cell, const Assignment& assignment) const {
        for (const SchemeOption& row : scheme_options()) {
            if (!cell.scheme->reads(row.name)) continue;
            if (const auto given = value(assignment, std::string(row.name)))
                row.set(cell.parameters, *given);
        }
        if (const auto budget = value(assignment, "budget")) cell.budget = budget_of(*budget);
        cell.settings.spp = budgeted_spp(
            cell.budget, cell.spp_asked,
            {cell.settings.size, reduced(cell.settings.size, cell.settings.reduction)});
    }

    /// Appends what the assignment gives for the named options; for all but reduction and seed when
    /// none is named.
    static void append_render_slugs(std::string& name, const Assignment& assignment,
                                    std::initializer_list<std::string_view> options = {}) {
        for (const RenderOption& row : render_options()) {
            const bool wanted = options.size() == 0
                                    ? row.name != "reduction" && row.name != "seed"
                                    : std::ranges::find(options, row.name) != options.end();
            const auto given = assignment.find(std::string(row.name));
            if (!wanted || given == assignment.end()) continue;
            RenderSettings
                asked;  // spp is named as it was asked for, not as a budget turned it out
            row.set(asked, given->second);
            name += "." + row.slug(asked);
        }
    }

    static void set_name(Cell& cell, const Assignment& assignment) {
        std::string name = stem(cell.scene) + "." + cell.method();
        if (cell.scheme != nullptr) {
            name += ".f" + std::to_string(cell.settings.reduction);
            for (const SchemeOption& row : scheme_options()) {
                if (!cell.scheme->reads(row.name)) continue;
                if (row.name == "window" || assignment.contains(std::string(row.name)))
                    name += "." + row.slug(cell.parameters);
            }
            if (cell.budget != Budget::same_spp) name += "." + budget_name(cell.budget);
        }
        for (const MethodOption& row : method_options()) {
            if (cell.render_method == nullptr || !cell.render_method->reads(row.name)) continue;
            if (assignment.contains(std::string(row.name)))
                name += "." + row.slug(cell.method_parameters);
        }
        append_render_slugs(name, assignment);
        cell.group = name;
        cell.name = name + ".s" + std::to_string(cell.settings.seed);
    }

    void push(Cell cell) {
        require_folder_name(cell.name, matrix_.file);
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
    FailureNeeds needs_;
    Assignment needed_;  ///< by the scene at hand
    std::vector<Cell> cells_;
    std::map<std::string, nlohmann::json> by_name_;
    std::map<std::string, std::size_t> scene_order_;
};

}  // namespace

std::string stem(const std::string& path) {
    return std::filesystem::path(path).stem().string();
}

std::vector<Cell> expand(const Matrix& matrix) {
    return Expansion(matrix).run();
}

bool traces_scene(const Matrix& matrix, const Cell& cell) {
    return cell.kind != CellKind::image || matrix.reference_source == nullptr ||
           cell.image->reads_frame();
}

std::string folder_of(const Matrix& matrix) {
    return std::filesystem::path(matrix.file).parent_path().string();
}

std::string sourced_path(const Matrix& matrix, const std::string& file,
                         const Placeholders& values) {
    return (std::filesystem::path(folder_of(matrix)) / fill_template(file, values))
        .lexically_normal()
        .string();
}

RenderSettings reference_settings(const Matrix& matrix, const Cell& cell) {
    RenderSettings settings = matrix.reference;
    settings.size = cell.settings.size;
    settings.max_depth = cell.settings.max_depth;
    settings.camera_shift = cell.settings.camera_shift;
    settings.reduction = 1;
    return settings;
}

}  // namespace vecino
