// SPDX-License-Identifier: Apache-2.0
#include "filters/record_check.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "core/color.h"
#include "core/parallel.h"
#include "filters/auto_plan.h"

namespace vecino {
namespace {

constexpr std::uint32_t kOtherSeed = 0x85ebca6bu;

/// Of one pixel.
struct PixelFindings {
    double error = 0, noise = 0;
};

/// What records make of a hit, and by how much paths from it differ.
struct HitFindings {
    glm::vec3 shown{0.0f};  ///< radiance
    glm::vec3 off{0.0f};
};

class PixelCheck {
  public:
    PixelCheck(const NeedInputs& inputs, std::uint32_t paths) : inputs_(inputs), paths_(paths) {
        for (std::uint32_t k = 0; k < kCheckedHits; ++k) {
            tasks_.push_back(inputs.tracer.task);
            tasks_.back().seed += kOtherSeed * (k + 1);
        }
    }

    [[nodiscard]] PixelFindings look(Pixel at) const {
        HitFindings hits[kCheckedHits];
        glm::vec3 shown(0.0f), sum(0.0f);
        for (int k = 0; k < kCheckedHits; ++k) {
            hits[k] = look_at_hit(at, tasks_[static_cast<std::size_t>(k)]);
            shown += hits[k].shown * (1.0f / kCheckedHits);
            sum += hits[k].off;
        }
        PixelFindings found;
        for (int c = 0; c < 3; ++c) {
            if (!(shown[c] < 1)) continue;  // too bright to be shown
            double squares = 0;
            for (const HitFindings& hit : hits)
                squares += static_cast<double>(hit.off[c] * hit.off[c]);
            const double weight = std::pow(static_cast<double>(srgb_slope(shown[c])), 2) / 3;
            const double square = static_cast<double>(sum[c] * sum[c]);
            // Products of two hits have no noise in their mean.
            found.error += weight * (square - squares) / (kCheckedHits * (kCheckedHits - 1));
            found.noise += weight * (squares - square / kCheckedHits) / (kCheckedHits - 1);
        }
        return found;
    }

  private:
    [[nodiscard]] HitFindings look_at_hit(Pixel at, const TraceTask& task) const {
        RecordLight light;
        (void)inputs_.tracer.kernel.gather(task, {at.x, at.y, 0, paths_}, light);
        HitFindings found;
        if (!light.hit) return found;
        const glm::vec3 position(light.position[0], light.position[1], light.position[2]);
        const glm::vec3 normal(light.normal[0], light.normal[1], light.normal[2]);
        inputs_.clusters.visit(at.x, at.y, [&](const Cluster& cluster) {
            if (cluster.object != light.object) return;
            const ClusterMeans means = means_of(cluster);
            RecordValue records;
            const SurfacePoint point{at.x, at.y, light.object, position, normal};
            if (!record_light(inputs_.records, point, records)) return;
            const glm::vec3 direct = direct_light(task, cluster);
            for (int c = 0; c < 3; ++c) {
                const auto i = static_cast<std::size_t>(c);
                const float known = records[i] + records[i + 3];
                found.off[c] = means.albedo[c] * (light.indirect[c] + light.background[c] - known);
                found.shown[c] = means.emission[c] + means.albedo[c] * (direct[c] + known);
            }
        });
        return found;
    }

    const NeedInputs& inputs_;
    std::uint32_t paths_;           ///< from each hit
    std::vector<TraceTask> tasks_;  ///< by hit: no two share their random numbers
};

}  // namespace

RecordCheck check_records(const NeedInputs& inputs, const std::vector<Pixel>& pixels,
                          const RecordCheckSize& size) {
    if (pixels.empty() || size.pixels == 0) return {};
    const std::size_t step = (pixels.size() + size.pixels - 1) / size.pixels;
    std::vector<PixelFindings> found((pixels.size() + step - 1) / step);
    for_each_block(found.size(), 8, inputs.tracer.threads, [&](BlockRange block) {
        const PixelCheck check(inputs, size.paths);
        for (std::size_t i = block.begin; i < block.end; ++i)
            found[i] = check.look(pixels[i * step]);
    });
    RecordCheck check;
    double squares = 0;
    for (const PixelFindings& pixel : found) {
        check.error += pixel.error;
        squares += pixel.error * pixel.error;
        check.path_noise += pixel.noise * std::pow(size.paths, kRecordSlope);
    }
    const auto count = static_cast<double>(found.size());
    check.error /= count;
    check.path_noise /= count;
    const double variance = std::max(squares / count - check.error * check.error, 0.0);
    check.standard_error = std::sqrt(variance / count);
    return check;
}

bool is_sure(const RecordCheck& check) {
    constexpr double kStandardErrors = 3;
    return check.error > kStandardErrors * check.standard_error;
}

std::vector<Pixel> shared_pixels(RowRange rows, const NeedyRows& needy) {
    std::vector<Pixel> out;
    for (std::size_t r = 0; r < needy.size(); ++r) {
        for (const NeedyPixel& pixel : needy[r]) {
            if ((pixel.needs & kNeedsCoverage) != 0)
                out.push_back({pixel.x, rows.begin + static_cast<int>(r)});
        }
    }
    return out;
}

std::vector<Pixel> scattered_pixels(RowRange rows, int width, std::size_t count) {
    // Additive recurrence by powers of the plastic number: no two close to each other, and in no
    // step with cells of records.
    constexpr double kAcross = 0.7548776662466927, kDown = 0.5698402909980532;
    const int height = rows.end - rows.begin;
    std::vector<Pixel> out;
    for (std::size_t i = 0; i < count; ++i) {
        const auto place = [i](double step) {
            return std::fmod(0.5 + static_cast<double>(i) * step, 1.0);
        };
        out.push_back({static_cast<int>(place(kAcross) * width),
                       rows.begin + static_cast<int>(place(kDown) * height)});
    }
    return out;
}

}  // namespace vecino
