// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>

#include "eval/commands.h"
#include "eval/matrix.h"
#include "eval/metrics.h"
#include "filters/methods.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

/// Rows of {"name":, "summary":, ...}.
nlohmann::json scheme_rows() {
    nlohmann::json rows = nlohmann::json::array();
    for (const Scheme& scheme : all_schemes()) {
        nlohmann::json row{{"name", scheme.name}, {"summary", scheme.summary}};
        row["options"] = std::vector<std::string>(scheme.options.begin(), scheme.options.end());
        row["needs"] = nlohmann::json::array({"radiance"});
        for (const PlaneInfo& plane : all_planes()) {
            if (scheme.needs.has(plane.plane)) row["needs"].push_back(plane.name);
        }
        for (const PlaneInfo& plane : all_planes()) {
            if (scheme.guide_reads.has(plane.plane)) row["guide"].push_back(plane.name);
        }
        rows.push_back(row);
    }
    return rows;
}

nlohmann::json method_rows() {
    nlohmann::json rows = nlohmann::json::array();
    for (const Method& method : all_methods()) {
        nlohmann::json row{{"name", method.name}, {"summary", method.summary}};
        row["options"] = std::vector<std::string>(method.options.begin(), method.options.end());
        rows.push_back(row);
    }
    return rows;
}

nlohmann::json metric_rows() {
    nlohmann::json rows = nlohmann::json::array();
    for (const MetricInfo& metric : all_metrics()) {
        rows.push_back({{"name", metric.name},
                        {"summary", metric.formula},
                        {"better", metric.higher_is_better ? "higher" : "lower"}});
    }
    return rows;
}

nlohmann::json cell_rows(const std::string& config) {
    nlohmann::json rows = nlohmann::json::array();
    for (const Cell& cell : expand(load_matrix(config))) {
        rows.push_back({{"name", cell.name}, {"summary", ""}, {"params", cell.parameters_json()}});
    }
    return rows;
}

nlohmann::json rows_of(const std::string& what, const std::string& config) {
    if (what == "cells" && config.empty()) {
        throw Error(ExitCode::usage,
                    "list cells: found no CONFIG, allowed: vecino list cells CONFIG");
    }
    if (what != "cells" && !config.empty()) {
        throw Error(ExitCode::usage,
                    "list " + what + ": found CONFIG \"" + config + "\", allowed: with cells only");
    }
    if (what == "schemes") return scheme_rows();
    if (what == "methods") return method_rows();
    if (what == "metrics") return metric_rows();
    return cell_rows(config);
}

ExitCode run_list(const std::string& what, const std::string& config, bool json) {
    const nlohmann::json rows = rows_of(what, config);
    if (json) {
        std::printf("%s\n", rows.dump(2).c_str());
        return ExitCode::ok;
    }
    for (const nlohmann::json& row : rows) {
        const auto name = row["name"].get<std::string>();
        const auto summary = row["summary"].get<std::string>();
        if (summary.empty()) {
            std::printf("%s\n", name.c_str());
        } else {
            std::printf("%-20s %s\n", name.c_str(), summary.c_str());
        }
    }
    return ExitCode::ok;
}

}  // namespace

void add_list_command(CLI::App& app, Action& chosen) {
    struct Arguments {
        std::string what, config;
        bool json = false;
    };
    auto arguments = std::make_shared<Arguments>();
    CLI::App* const command = app.add_subcommand("list", "what there is");
    command->add_option("WHAT", arguments->what, "schemes, methods, metrics, cells")
        ->required()
        ->check(CLI::IsMember({"schemes", "methods", "metrics", "cells"}));
    command->add_option("CONFIG", arguments->config, "a matrix, for cells");
    command->add_flag("--json", arguments->json);
    command->callback([arguments, &chosen] {
        chosen = [arguments] {
            return run_list(arguments->what, arguments->config, arguments->json);
        };
    });
}

}  // namespace vecino
