// SPDX-License-Identifier: Apache-2.0
#include "eval/unbiased_compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/accumulate.h"
#include "core/channel_file.h"
#include "core/error.h"
#include "core/image_io.h"
#include "eval/metrics_json.h"
#include "eval/render_metadata.h"

namespace vecino {
namespace {

bool all_finite(const Image& image) {
    return std::ranges::all_of(image.values(), [](const glm::vec3& value) {
        return std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z);
    });
}

struct RenderFile {
    std::string file;
    Frame frame;
    int streams = 0;

    explicit RenderFile(const std::string& path) : file(path), frame(load_frame(path)) {
        for (const auto& [plane, is_there] : {std::pair("variance", !frame.variance.empty()),
                                              std::pair("count", !frame.sample_count.empty())}) {
            if (is_there) continue;
            throw Error(ExitCode::mismatch, path + ": found no plane " + plane +
                                                ", allowed: an .exr with the planes variance and "
                                                "count (vecino render --planes all)");
        }
        if (!all_finite(frame.radiance) || !all_finite(frame.variance))
            throw Error(ExitCode::non_finite, path +
                                                  ": found values that are not finite in its "
                                                  "radiance or variance, allowed: none");
        // Sobol points are not independent: their variance comes from a few scramblings that are.
        if (attribute_text(load_header(path).metadata, "sampler") == "sobol")
            streams = static_cast<int>(kStreams);
    }

    [[nodiscard]] NoisyImage noisy() const {
        return {frame.radiance, frame.variance, frame.sample_count, streams};
    }
};

const char* const kChannels[] = {"R", "G", "B"};

}  // namespace

std::vector<UnbiasedRule> compare_unbiased(const std::string& test, const std::string& reference) {
    const RenderFile a(test);
    const RenderFile b(reference);
    if (a.frame.size() != b.frame.size())
        throw Error(ExitCode::mismatch,
                    size_mismatch_text(test, a.frame.size(), reference, b.frame.size()));
    return test_unbiased(a.noisy(), b.noisy());
}

nlohmann::json unbiased_json(const std::vector<UnbiasedRule>& rules) {
    nlohmann::json json{{"holds", std::ranges::all_of(rules, &UnbiasedRule::holds)},
                        {"rules", nlohmann::json::array()}};
    for (const UnbiasedRule& rule : rules) {
        json["rules"].push_back({{"rule", rule.name},
                                 {"holds", rule.holds()},
                                 {"tests", rule.tests},
                                 {"least_p", rule.least_p},
                                 {"limit_p", rule.limit_p},
                                 {"at", {rule.where.x, rule.where.y, rule.channel}},
                                 {"difference", rule.difference},
                                 {"standard_error", rule.standard_error}});
    }
    return json;
}

std::string unbiased_text(const std::vector<UnbiasedRule>& rules) {
    std::string text;
    for (const UnbiasedRule& rule : rules) {
        char line[256];
        std::snprintf(
            line, sizeof line,
            "unbiased, %-5s  %s: least p %.2g of %zu tests, limit %.2g; at (%d, %d) %s the "
            "means differ by %.4g +- %.2g\n",
            std::string(rule.name).c_str(), rule.holds() ? "holds" : "fails", rule.least_p,
            rule.tests, rule.limit_p, rule.where.x, rule.where.y, kChannels[rule.channel],
            rule.difference, rule.standard_error);
        text += line;
    }
    return text;
}

}  // namespace vecino
