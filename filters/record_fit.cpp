// SPDX-License-Identifier: Apache-2.0
//
// Light around each record: a polynomial of second order in the tangent plane, by weighted least
// squares over the records of the same surface nearby.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/parallel.h"
#include "filters/records.h"

namespace vecino {
namespace {

constexpr int kReach = 2;  ///< the window, in cells to each side
// Of terms with fewer records behind them than this, there is no telling.
constexpr int kLeastForSecondOrder = 12;
constexpr int kLeastForFirstOrder = 6;

using Terms = std::array<double, kFitTerms>;
constexpr std::array<std::size_t, 3> kTermsOfOrder = {1, 3, 6};

/// Sums of weighted least squares.
struct NormalEquations {
    std::array<Terms, kFitTerms> matrix{};
    std::array<Terms, kRecordChannels> right{};
    int records = 0;
    RecordValue least, most;
};

void set_tangents(Record& record) {
    const glm::vec3 n = record.normal_world;
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    const float scale = 1.0f / std::max(record.footprint_world, 1e-30f);
    record.u_axis = glm::vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x) * scale;
    record.v_axis = glm::vec3(b, sign + n.y * n.y * a, -n.y) * scale;
}

Terms terms_of(double u, double v) {
    return {1.0, u, v, u * u, u * v, v * v};
}

/// Cholesky's lower triangle in place of the first n rows; false if they are not definite.
bool factor(std::array<Terms, kFitTerms>& m, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = m[i][j];
            for (std::size_t k = 0; k < j; ++k) sum -= m[i][k] * m[j][k];
            if (i > j) {
                m[i][j] = sum / m[j][j];
                continue;
            }
            if (!(sum > 0)) return false;
            m[i][i] = std::sqrt(sum);
        }
    }
    return true;
}

/// By that triangle, in place of a right side.
void substitute(const std::array<Terms, kFitTerms>& m, std::size_t n, Terms& x) {
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < i; ++k) x[i] -= m[i][k] * x[k];
        x[i] /= m[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) x[i] -= m[k][i] * x[k];
        x[i] /= m[i][i];
    }
}

/// Solves the first n equations, all right sides at once; false if they are not definite.
bool solve(NormalEquations& e, std::size_t n, std::size_t channels) {
    if (!factor(e.matrix, n)) return false;
    for (std::size_t c = 0; c < channels; ++c) substitute(e.matrix, n, e.right[c]);
    return true;
}

/// A record right beside something else says little of what is farther off than that (Ward's
/// harmonic mean distance): one of a few such in a cell would darken all of it.
double trust(const Record& record, float distance2_world, float footprint_world) {
    constexpr float kHarmonicMeans = 1.4f,
                    kOwn = 0.35f;  // of a cell: it speaks for that much itself
    const float own = kOwn * footprint_world;
    const float off2 = (distance2_world + own * own) * record.nearness * record.nearness *
                       (1 / (kHarmonicMeans * kHarmonicMeans));
    return 1.0 / (1.0 + static_cast<double>(off2 * off2));
}

class RecordFitter {
  public:
    RecordFitter(const RecordMap& map, const SurfaceRecordsPlan& plan)
        : map_(map),
          per_sigma2_(0.5 / (plan.fit_sigma * plan.fit_sigma)),
          most_order_(plan.fit_order) {}

    void fit(std::size_t level, int column, int row, Record& record) const {
        set_tangents(record);
        NormalEquations equations;
        equations.least = equations.most = record.light;
        for (int dy = -kReach; dy <= kReach; ++dy) {
            for (int dx = -kReach; dx <= kReach; ++dx)
                add_cell(level, {column + dx, row + dy, 1.0}, record, equations);
        }
        set_fit(equations, record);
        set_limits(equations, record);
    }

  private:
    struct Cell {
        int column, row;
        double weight;
    };

    /// The records of a cell or, where it is not active, of the one that it is a part of.
    void add_cell(std::size_t level, Cell cell, const Record& record,
                  NormalEquations& equations) const {
        const double size = map_.levels[level].cell();
        for (;; --level) {
            const RecordLevel& cells = map_.levels[level];
            if (!cells.is_inside(cell.column, cell.row)) return;
            if (cells.is_active(cell.column, cell.row)) {
                for (const Record& other : cells.at(cell.column, cell.row))
                    add_record(other, record, {size, cell.weight}, equations);
                return;
            }
            if (level == 0) return;
            cell = {cell.column / 2, cell.row / 2, cell.weight * 0.25};
        }
    }

    struct Scale {
        double cell, weight;
    };

    void add_record(const Record& other, const Record& record, Scale scale,
                    NormalEquations& equations) const {
        if (other.object != record.object) return;
        const float aligned = agreement(glm::dot(other.normal_world, record.normal_world));
        const double dx = static_cast<double>(other.x - record.x) / scale.cell;
        const double dy = static_cast<double>(other.y - record.y) / scale.cell;
        const glm::vec3 off = other.position_world - record.position_world;
        const double weight = scale.weight * static_cast<double>(aligned) *
                              std::exp(-(dx * dx + dy * dy) * per_sigma2_) *
                              trust(other, glm::dot(off, off), record.footprint_world);
        if (!(weight > 1e-6)) return;
        const Terms terms = terms_of(static_cast<double>(glm::dot(off, record.u_axis)),
                                     static_cast<double>(glm::dot(off, record.v_axis)));
        for (std::size_t i = 0; i < kFitTerms; ++i) {
            const double weighted = weight * terms[i];
            for (std::size_t j = 0; j <= i; ++j) equations.matrix[i][j] += weighted * terms[j];
            for (std::size_t c = 0; c < map_.channels; ++c)
                equations.right[c][i] += weighted * static_cast<double>(other.light[c]);
        }
        for (std::size_t c = 0; c < map_.channels; ++c) {
            equations.least[c] = std::min(equations.least[c], other.light[c]);
            equations.most[c] = std::max(equations.most[c], other.light[c]);
        }
        ++equations.records;
    }

    void set_fit(const NormalEquations& equations, Record& record) const {
        const int known = equations.records >= kLeastForSecondOrder  ? 2
                          : equations.records >= kLeastForFirstOrder ? 1
                                                                     : 0;
        for (int order = std::min(known, most_order_); order >= 0; --order) {
            NormalEquations ridged = equations;
            const std::size_t n = kTermsOfOrder[static_cast<std::size_t>(order)];
            for (std::size_t i = 1; i < n; ++i)
                ridged.matrix[i][i] += 1e-4 * ridged.matrix[i][i] + 1e-5 * ridged.matrix[0][0];
            if (!solve(ridged, n, map_.channels) || !is_sound(ridged)) continue;
            record.fit = {};
            for (std::size_t c = 0; c < map_.channels; ++c) {
                for (std::size_t i = 0; i < n; ++i)
                    record.fit[c][i] = static_cast<float>(ridged.right[c][i]);
            }
            return;
        }
        record.fit = {};
        for (std::size_t c = 0; c < map_.channels; ++c) record.fit[c][0] = record.light[c];
    }

    /// Whether the value at the record stays near those that it was made of.
    [[nodiscard]] bool is_sound(const NormalEquations& equations) const {
        for (std::size_t c = 0; c < map_.channels; ++c) {
            const double value = equations.right[c][0];
            if (!(value >= 0.7 * static_cast<double>(equations.least[c]) &&
                  value <= 1.3 * static_cast<double>(equations.most[c]))) {
                return false;
            }
        }
        return true;
    }

    /// Where light breaks off, as at a contact, a polynomial swings beyond all that it was made of.
    void set_limits(const NormalEquations& equations, Record& record) const {
        constexpr float kBeyond = 0.1f;  // of their range: a peak may lie between them
        for (std::size_t c = 0; c < map_.channels; ++c) {
            const float slack = kBeyond * (equations.most[c] - equations.least[c]);
            record.least[c] = std::max(equations.least[c] - slack, 0.0f);
            record.most[c] = equations.most[c] + slack;
        }
    }

    const RecordMap& map_;
    double per_sigma2_;
    int most_order_;
};

}  // namespace

void fit_records(RecordMap& map, const SurfaceRecordsPlan& plan, int threads) {
    const RecordFitter fitter(map, plan);
    for (std::size_t number = 0; number < map.levels.size(); ++number) {
        RecordLevel& level = map.levels[number];
        const RowRange rows = level.rows();
        for_each_block(
            static_cast<std::size_t>(rows.end - rows.begin), 1, threads, [&](BlockRange block) {
                const int row = rows.begin + static_cast<int>(block.begin);
                for (int column = 0; column < level.columns(); ++column) {
                    const std::size_t cell = level.index(column, row);
                    for (std::uint32_t i = level.first[cell]; i < level.first[cell + 1]; ++i)
                        fitter.fit(number, column, row, level.records[i]);
                }
            });
    }
}

}  // namespace vecino
