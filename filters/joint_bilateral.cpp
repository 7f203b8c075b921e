// SPDX-License-Identifier: Apache-2.0
//
// Joint bilateral upsampling: f(distance in the image) g(likeness of surfaces), with the low-res
// pixels' surfels as their side of g. Emission is known, so that only reflected light is averaged.
#include "filters/guided.h"
#include "filters/guided_input.h"

namespace vecino {
namespace {

constexpr int kNormalPower = 64;

/// How unlike two albedos are: a seam between two materials is an edge too.
float albedo_distance(const Surfel& p, const Surfel& q) {
    constexpr float kScale = 10.0f;  // 1 over the difference that counts as one e-fold
    const glm::vec3 d = p.modulation - q.modulation;
    return kScale * (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
}

class JointBilateral {
  public:
    JointBilateral(const GuidedTask& task, const GuidedInput& input)
        : input_(input),
          size_(task.request.size),
          window_(task.request.parameters.window),
          columns_(
              axis_windows(size_.width, input.low_size().width, task.request.parameters.window)),
          rows_(axis_windows(size_.height, input.low_size().height,
                             task.request.parameters.window)) {}

    glm::dvec3 operator()(const Surfel& p, int x, int y, GuidedOutcome& outcome) const {
        const AxisWindow& columns = columns_[static_cast<std::size_t>(x)];
        const AxisWindow& rows = rows_[static_cast<std::size_t>(y)];
        glm::dvec3 sum(0.0);
        double weights = 0;
        for (std::size_t j = 0; j < rows.weights.size(); ++j) {
            for (std::size_t i = 0; i < columns.weights.size(); ++i) {
                const int u = columns.begin + static_cast<int>(i);
                const int v = rows.begin + static_cast<int>(j);
                const glm::dvec3& value = input_.reflected(u, v);
                if (!is_finite(value)) continue;
                float alike = 0;
                for (const Surfel& q : input_.surfels().at(u, v))
                    alike += q.purity * likeness<kNormalPower>(q, p, albedo_distance(p, q));
                const double weight =
                    columns.weights[i] * rows.weights[j] * static_cast<double>(alike);
                sum += weight * value;
                weights += weight;
            }
        }
        const glm::dvec3 emission(p.emission);
        if (weights > kLeastWeight && is_finite(sum)) return emission + sum / weights;
        outcome.fell_back = true;
        return emission + whatever_is_near(x, y, outcome);
    }

  private:
    /// Of the corresponding pixel, or else of its neighbours, whatever surfaces they show.
    [[nodiscard]] glm::dvec3 whatever_is_near(int x, int y, GuidedOutcome& outcome) const {
        const Extent low = input_.low_size();
        const int column = corresponding(x, size_.width, low.width);
        const int row = corresponding(y, size_.height, low.height);
        const glm::dvec3& own = input_.reflected(column, row);
        if (is_finite(own)) return own;
        const auto mean = mean_around(column, row, low, window_,
                                      [&](int u, int v) { return input_.reflected(u, v); });
        if (!mean) outcome.non_finite = true;
        return mean.value_or(glm::dvec3(0.0));
    }

    const GuidedInput& input_;
    Extent size_;
    int window_;
    std::vector<AxisWindow> columns_, rows_;
};

}  // namespace

Reconstruction joint_bilateral(const GuidedTask& task) {
    const GuidedInput input(task);
    return resolve_pixels(task, input, JointBilateral(task, input));
}

}  // namespace vecino
