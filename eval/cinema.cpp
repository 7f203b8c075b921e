// SPDX-License-Identifier: Apache-2.0
#include "eval/cinema.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "core/error.h"
#include "core/files.h"
#include "eval/cell_vti.h"
#include "eval/csv.h"
#include "eval/report_facts.h"
#include "eval/report_pictures.h"
#include "eval/run_directory.h"

namespace vecino {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Rows = std::vector<const Json*>;

/// A value per row; null: none. Non-finite numbers are NaN.
struct Column {
    std::string name;
    std::vector<Json> values;
};

/// Viewers use the names in CSS selectors and SQL.
std::string identifier(std::string name) {
    std::ranges::replace_if(
        name, [](unsigned char c) { return c >= 0x80 || std::isalnum(c) == 0; }, '_');
    return name;
}

std::string joined(const Json& array) {
    std::string text;
    for (const Json& each : array) text += (text.empty() ? "" : "x") + text_of(each);
    return text;
}

/// As a reader of the whole column takes it: a number with a point is a float wherever it stands.
std::string float_text(double value) {
    if (std::isnan(value)) return "NaN";
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    const bool is_float = std::string_view(text).find_first_of(".e") != std::string_view::npos;
    return is_float ? text : std::string(text) + ".0";
}

std::vector<std::string> field_texts(const Column& column) {
    const auto all = [&](auto holds) {
        return std::ranges::all_of(column.values,
                                   [&](const Json& v) { return v.is_null() || holds(v); });
    };
    const bool is_integer = all([](const Json& v) { return v.is_number_integer(); });
    const bool is_float = all([](const Json& v) { return v.is_number(); });
    std::vector<std::string> texts;
    for (const Json& value : column.values) {
        if (value.is_null()) {
            texts.emplace_back();
        } else if (is_integer) {
            texts.push_back(value.dump());
        } else if (is_float) {
            texts.push_back(float_text(value.get<double>()));
        } else if (value.is_array()) {
            texts.push_back(joined(value));
        } else {
            // A number among texts would be of another type.
            texts.push_back((value.is_number() ? column.name + " " : "") + text_of(value));
        }
    }
    return texts;
}

class Table {
  public:
    explicit Table(const Rows& rows) : rows_(rows) {}

    template <class ValueOf>
    void add(const std::string& name, const ValueOf& value_of) {
        Column column{identifier(name), {}};
        for (const Json* row : rows_) column.values.push_back(value_of(*row));
        const auto is_null = [](const Json& value) { return value.is_null(); };
        if (!std::ranges::all_of(column.values, is_null)) columns_.push_back(std::move(column));
    }

    [[nodiscard]] std::string text() const {
        std::vector<std::string> names;
        std::vector<std::vector<std::string>> fields;
        for (const Column& column : columns_) {
            names.push_back(column.name);
            fields.push_back(field_texts(column));
        }
        std::string text = csv_line(names);
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            std::vector<std::string> line;
            for (const auto& column : fields) line.push_back(column[i]);
            text += csv_line(line);
        }
        return text;
    }

  private:
    const Rows& rows_;
    std::vector<Column> columns_;
};

void add_parameters(const Rows& rows, Table& table) {
    std::map<std::string, std::set<Json>> values;
    for (const Json* row : rows) {
        for (const auto& [name, value] : row->at("params").items()) values[name].insert(value);
    }
    const std::set<std::string> apart{"scene", "method", "seed", "spp_asked"};
    table.add("scene", [](const Json& row) { return row["scene"]; });
    table.add("method", [](const Json& row) { return row["method"]; });
    for (const auto& [name, found] : values) {
        if (found.size() < 2 || apart.contains(name)) continue;
        table.add(name,
                  [name = name](const Json& row) { return row["params"].value(name, Json()); });
    }
    table.add("seed", [](const Json& row) { return row.value("seed", Json()); });
}

/// NaN where a cell failed: it has no metrics, and must not look like one that nobody measured.
Json metric_of(const Json& row, const Json::json_pointer& at) {
    if (row["status"] != "ok") return std::numeric_limits<double>::quiet_NaN();
    const Json metrics = row.value("metrics", Json::object());
    if (!metrics.contains(at) || !metrics[at].is_number()) return nullptr;
    return metrics[at];
}

void add_metrics(const Rows& rows, Table& table) {
    std::set<std::string> names;
    for (const Json* row : rows) {
        const Json metrics = row->value("metrics", Json::object());
        for (const auto& [name, value] : metrics.items()) {
            if (value.is_number()) names.insert(name);
        }
    }
    const auto add = [&](const std::string& name, const std::string& pointer) {
        table.add(name,
                  [&](const Json& row) { return metric_of(row, Json::json_pointer(pointer)); });
    };
    for (const std::string& name : names) add(name, "/" + name);
    for (const RegionInfo& region : kRegions) {
        const std::string name(region.name);
        add("psnr_float_db_" + name, "/regions/" + name + "/psnr_float_db");
    }
}

void add_measurements(Table& table) {
    for (const char* name : {"total", "trace", "reconstruct"}) {
        table.add("time_s_" + std::string(name), [&](const Json& row) {
            return row.value("time_s", Json::object()).value(name, Json());
        });
    }
    for (const char* name : {"fallback_pixels", "non_finite_pixels", "dropped_samples"}) {
        table.add(name, [&](const Json& row) {
            return row.value("counts", Json::object()).value(name, Json());
        });
    }
    table.add("status", [](const Json& row) { return row["status"]; });
}

/// A column of files, where they stand in the database, and where the run has them.
struct FileColumn {
    const char* name;
    const char* folder;
    const char* extension;
    std::string (*source)(const Json& row);  ///< in the run directory; null: not from there
};

std::string in_cell(const Json& row, const char* name) {
    return "cells/" + row["cell"].get<std::string>() + "/" + name;
}

// Some viewers take the column FILE for the picture to show.
const FileColumn kFileColumns[] = {
    {"FILE", "image", ".png", [](const Json& row) { return in_cell(row, "image.png"); }},
    {"FILE_reference", "reference", ".png",
     [](const Json& row) { return row.value("reference_file", "") + ".png"; }},
    {"FILE_error", "error", ".png", [](const Json& row) { return in_cell(row, "error.png"); }},
    {"FILE_error_signed", "error_signed", ".png",
     [](const Json& row) { return in_cell(row, "error_signed.png"); }},
    {"FILE_vti", "vti", ".vti", nullptr},
};

std::string file_in_database(const FileColumn& column, const Json& row) {
    const bool is_shared = std::string_view(column.folder) == "reference";
    const std::string name = is_shared
                                 ? fs::path(row.value("reference_file", "")).filename().string()
                                 : row["cell"].get<std::string>();
    return std::string(column.folder) + "/" + name + column.extension;
}

void make_folder(const std::string& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error)
        throw Error(ExitCode::file, path + ": cannot make the directory: " + error.message());
}

/// The same file at another place: whole or not at all.
void place(const std::string& from, const std::string& to) {
    std::error_code error;
    if (fs::equivalent(from, to, error)) return;
    const std::string link = to + ".tmp";
    fs::remove(link, error);
    fs::create_hard_link(fs::canonical(from), link, error);  // not to a link
    if (error) return write_text_file(to, read_file(from));
    fs::rename(link, to, error);
    if (error) cannot_write(to, error.message());
}

/// Error maps share a range over the run, so that all are drawn again where one is missing or
/// older than its image.
void require_error_maps(const ReportData& data, const Rows& rows) {
    const auto is_current = [&](const Json* row) {
        const std::string folder = data.directory + "/" + in_cell(*row, "");
        if (!has_images(data, *row)) return true;
        const auto drawn = [&](const char* map) {
            return fs::exists(folder + map) &&
                   fs::last_write_time(folder + map) >= fs::last_write_time(folder + "image.exr");
        };
        return drawn("error.png") && drawn("error_signed.png");
    };
    if (!std::ranges::all_of(rows, is_current)) (void)make_report_pictures(data);
}

}  // namespace

std::string cinema_csv(const Rows& rows, const std::string& database) {
    Table table(rows);
    add_parameters(rows, table);
    add_metrics(rows, table);
    add_measurements(table);
    for (const FileColumn& column : kFileColumns) {
        table.add(column.name, [&](const Json& row) -> Json {
            const std::string file = file_in_database(column, row);
            return fs::exists(database + "/" + file) ? Json(file) : Json();
        });
    }
    return table.text();
}

void write_cinema(const ReportData& data, const Rows& rows, const std::string& database,
                  bool with_vti) {
    require_error_maps(data, rows);
    for (const FileColumn& column : kFileColumns) {
        if (column.source == nullptr) continue;
        make_folder(database + "/" + column.folder);
        for (const Json* row : rows) {
            const std::string from = data.directory + "/" + column.source(*row);
            if (fs::exists(from)) place(from, database + "/" + file_in_database(column, *row));
        }
    }
    if (with_vti) {
        make_folder(database + "/vti");
        write_cell_vtis(data, rows, [&](const std::string& cell) {
            return database + "/vti/" + cell + ".vti";
        });
    }
    write_text_file(database + "/data.csv", cinema_csv(rows, database));
}

}  // namespace vecino
