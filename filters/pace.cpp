// SPDX-License-Identifier: Apache-2.0
#include "filters/pace.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace vecino {
namespace {

// Of a frame's time: more first samples than this leave too little for what they find.
constexpr double kPilotShare = 0.2;
// Of what is left, for more of them where they are seen to pay.
constexpr double kMostPilotShare = 0.6;

// Of what is left, kept back: clocks and other programs are not exact.
constexpr double kReserve = 0.01;

// Of a pixel at the very end, and of a needy one to find out how needy, on one thread.
constexpr double kResolve_s = 80e-9, kNeed_s = 180e-9;

// As few paths of a record do; the least may take somewhat longer than there is time.
constexpr int kLeastPaths = 64;
constexpr double kGraceShare = 0.08, kGrace_s = 0.02;

constexpr int kMostPaths = 1 << 20, kMostEdgeSpp = 65536;

/// Paths in whole packets.
int whole_packets(double paths) {
    constexpr double kPacket = 16;
    return static_cast<int>(
        std::clamp(std::floor(paths / kPacket) * kPacket, double{kLeastPaths}, double{kMostPaths}));
}

int geometric_mean(int low, int high) {
    return static_cast<int>(std::sqrt(double{1} * low * high));
}

/// Of a part, where its whole may be nothing.
double share_of(double part, double whole, double usual) {
    return whole > 0 ? part / whole : usual;
}

/// Of a pixel that gets paths of its own.
double path_noise(const RecordCheck& check, const SurfaceRecordsPlan& plan) {
    return check.path_noise * std::pow(std::max(plan.edge_spp, 1), -kRecordSlope);
}

}  // namespace

Pace::Pace(double seconds, int threads, const PilotFindings& found)
    : seconds_(seconds),
      threads_(threads),
      found_(found),
      rates_(nominal_rates(1)),
      until_s_((1 - kReserve) * seconds) {}

void Pace::choose_first(std::vector<BandRows>& bands, const std::vector<BandSurvey>& surveys) {
    BandSurvey whole;
    std::size_t first = 0;
    for (std::size_t i = 0; i < surveys.size(); ++i) {
        whole.needy_pixels += surveys[i].needy_pixels;
        whole.records += surveys[i].records;
        whole.pilot_s += surveys[i].pilot_s;
        if (surveys[i].needy_pixels > surveys[first].needy_pixels) first = i;
    }
    std::swap(bands.front(), bands[first]);
    const BandSurvey& own = surveys[first];
    const double share = own.pilot_s / whole.pilot_s;
    needy_density_ = share_of(own.needy_pixels, whole.needy_pixels, share) / share;
    record_density_ = share_of(own.records, whole.records, share) / share;
    found_.pixels = own.pixels;
    const double spent_s = watch_.seconds();
    until_s_ = spent_s + share * (until_s_ - spent_s);
}

double Pace::typical(const Trial& trial) const {
    constexpr double kShort_s = 0.15;
    const std::size_t trials = seconds_ < kShort_s ? 2 : kMostTrials;
    double seconds[kMostTrials] = {};
    for_each_block(trials, 1, threads_, [&](BlockRange block) {
        seconds[block.begin] = trial(static_cast<int>(block.begin));
    });
    std::sort(seconds, seconds + trials);
    // Without the least and the most of four.
    return 0.5 * (seconds[trials / 2 - 1] + seconds[trials / 2]);
}

void Pace::take_pilot(double work_s, double seconds, double look_s) {
    pilot_s_ = seconds;
    look_s_ = look_s;
    constexpr double kMost = 16;
    // What starts a stage is much of a short one.
    constexpr double kShort_s = 0.03, kMostOfShort = 1.25;
    const double most = seconds < kShort_s ? kMostOfShort : kMost;
    if (work_s > 0) slowness_ = std::clamp(seconds * threads_ / work_s, 0.5, most);
}

void Pace::choose_pilot(const PilotCost& cost, SurfaceRecordsPlan& plan) {
    pilot_cost_ = cost;
    const auto frame_s = [&](int spp) { return found_.pixels * cost.of(spp) * per_work_s(); };
    plan.pilot_spp = 1;
    while (plan.pilot_spp < kMostPilotSpp && frame_s(2 * plan.pilot_spp) <= kPilotShare * left_s())
        plan.pilot_spp *= 2;
}

void Pace::take_records(const PaceFindings& here) {
    RecordErrors& errors = *found_.records;
    // What was tried may have missed what there is.
    constexpr double kLeast = 0.01;
    errors.record_noise = std::max(here.record_noise, kLeast * kUsualErrors.record_noise);
    // Where cells hold several surfaces, each has fewer records to be fitted to.
    constexpr double kUsualExcess = 0.2, kPower = 1.4, kMostTimes = 10;
    const double excess = std::max((here.surfaces - 1) / kUsualExcess, 1.0);
    errors.bias_at_8 *= std::min(std::pow(excess, kPower), kMostTimes);
    // Light that is the same all over, as of a sky, has no noise; it is wrong where it is hidden.
    if (!here.has_record_light) errors.bias_at_8 *= kLeast;
}

double Pace::pilot_again_s(int from_spp, int to_spp) const {
    if (to_spp == from_spp) return 0;
    return look_s_ + pilot_s_ * pilot_cost_.of(to_spp) / pilot_cost_.of(from_spp);
}

Schedule Pace::best_schedule(const PaceFindings& here, int pilot_spp) {
    constexpr double kWorthwhile = 0.85;  // of the error
    const auto take_edges = [&](const EdgeCurve& edges) {
        found_.edges = edges;
        for (EdgePoint& point : found_.edges) point.error /= needy_density_;
    };
    const auto schedule = [&](const EdgeCurve& edges, double seconds) {
        take_edges(edges);
        return plan_surface_records(found_, rates_, seconds);
    };
    const EdgeCurve* best_edges = here.edges.empty() ? nullptr : &here.edges.front().second;
    Schedule best = schedule(best_edges != nullptr ? *best_edges : EdgeCurve{}, left_s());
    best.plan.pilot_spp = pilot_spp;
    for (std::size_t i = 1; i < here.edges.size(); ++i) {
        const auto& [first_samples, edges] = here.edges[i];
        const double again_s = pilot_again_s(pilot_spp, first_samples);
        const double seconds = left_s() - again_s;
        if (again_s > kMostPilotShare * left_s()) break;
        Schedule made = schedule(edges, seconds);
        made.plan.pilot_spp = first_samples;
        const bool is_better = *made.predicted_error < kWorthwhile * *best.predicted_error;
        if (!is_better || made.predicted_s > seconds) continue;
        best = made;
        best_edges = &edges;
    }
    if (best_edges != nullptr) take_edges(*best_edges);
    return best;
}

void Pace::choose_structure(const PaceFindings& here, SurfaceRecordsPlan& plan) {
    found_.needy_pixels = here.needy_pixels / needy_density_;
    found_.records_at_8 = here.records_at_16 * found_.record_growth / record_density_;
    if (!found_.records) found_.records = kUsualErrors;
    take_records(here);
    rates_.first_sample_s = 0;  // they are done
    rates_.pixel_s = (kResolve_s + kNeed_s * here.needy_pixels / found_.pixels) * per_work_s();
    rates_.record_path_s = here.path_s * per_work_s();
    rates_.edge_sample_s = here.sample_s * per_work_s();
    const int pilot_spp = plan.pilot_spp;
    plan = best_schedule(here, pilot_spp).plan;
    PilotFindings records = found_;
    records.pixels = records.needy_pixels = 0;
    const double records_s = surface_records_cost(records, rates_, plan);
    const double all_s = surface_records_cost(found_, rates_, plan);
    const double again_s = pilot_again_s(pilot_spp, plan.pilot_spp);
    records_from_s_ = watch_.seconds() + again_s;
    records_until_s_ = records_from_s_ + std::max(left_s() - again_s, 0.0) * records_s / all_s;
}

void Pace::choose_paths(const RecordCount& level, SurfaceRecordsPlan& plan) {
    if (level.records == 0 || level.level > 1) return;  // all halved cells have as many paths
    // What was timed is much of a short stage, and may have been disturbed.
    const double path_s =
        std::clamp(level.path_s, 0.7 * rates_.record_path_s, 1.6 * rates_.record_path_s);
    // Each level to come has about twice the records of the one before; the first halved one half
    // of those that there are.
    const double finer = level.level == 0 ? refined_share(plan, found_.record_growth) *
                                                plan.refined_record_paths / plan.record_paths
                                          : std::exp2(plan.levels - level.level + 1) - 2;
    const double all_s = static_cast<double>(level.records) * (1 + finer) * path_s;
    const double until_s = records_from_s_ + record_density_ * (records_until_s_ - records_from_s_);
    const double paths = (until_s - watch_.seconds()) / all_s - kRecordStart;
    int& chosen = level.level == 0 ? plan.record_paths : plan.refined_record_paths;
    const int planned = chosen;
    chosen = whole_packets(std::clamp(paths, planned / 4.0, planned * 4.0));
    if (level.level == 0) {
        plan.refined_record_paths =
            whole_packets(static_cast<double>(chosen) * plan.refined_record_paths / planned);
    }
}

RecordCheckSize Pace::check_size(const SurfaceRecordsPlan& plan) const {
    constexpr double kShare = 0.02;
    constexpr int kMostPixels = 256, kFewestPixels = 32;  // fewer tell nothing
    // Pixels differ more than paths of each are noisy.
    const int paths = std::clamp(plan.record_paths / 64, 16, 64);
    const double pixel_s = kCheckedHits * (paths + kRecordStart) * rates_.record_path_s;
    const double pixels = std::min(kShare * left_s() / pixel_s, double{kMostPixels});
    return {pixels < kFewestPixels ? 0 : static_cast<std::size_t>(pixels),
            static_cast<std::uint32_t>(paths)};
}

bool Pace::wants_paths(const ErrorFindings& here, const SurfaceRecordsPlan& plan,
                       bool has_lamps) const {
    // Paths are noisy by lamps, too, which this does not count.
    constexpr double kOfLamps = 2;
    SurfaceRecordsPlan fewer = plan;
    fewer.edge_spp = static_cast<int>(plan.edge_spp / kPathWork);
    fewer.edge_light = EdgeLight::paths;
    if (fewer.edge_spp < kOwnPacketSpp) return false;
    ErrorFindings then = here;
    then.samples *= edge_noise_share(fewer) / edge_noise_share(plan);
    const double lost = then.samples - here.samples;
    const double wrong = here.at_shared.error - here.at_shared.standard_error;
    if ((wrong - path_noise(here.at_shared, fewer)) * here.shared_pixels <= lost) return false;
    if (!has_lamps) return true;
    return is_sure(here.at_shared) &&
           expected_error(here, plan) > kOfLamps * expected_error(then, fewer);
}

double Pace::expected_error(const ErrorFindings& here, const SurfaceRecordsPlan& plan) const {
    SurfaceRecordsPlan records = plan;
    records.edge_spp = kMostEdgeSpp;
    const double as_a_rule = surface_records_error(found_, records);
    const double elsewhere = is_sure(here.elsewhere) ? here.elsewhere.error : as_a_rule;
    const double at_shared = plan.edge_light == EdgeLight::paths
                                 ? path_noise(here.at_shared, plan)
                                 : std::max(here.at_shared.error, as_a_rule);
    return (here.samples + here.shared_pixels * at_shared +
            (found_.pixels - here.shared_pixels) * elsewhere) /
           found_.pixels;
}

void Pace::choose_edges(const std::function<double(int)>& cost, double unit_s,
                        SurfaceRecordsPlan& plan) {
    const double per_unit_s = unit_s * per_work_s();
    // Records that the rest has fewer of do not take as long there.
    until_s_ += (watch_.seconds() - records_from_s_) * (1 - 1 / record_density_);
    const double left = needy_density_ * (left_s() - found_.pixels * kResolve_s * per_work_s());
    const double grace = needy_density_ * std::max(kGraceShare * until_s_, kGrace_s);
    const auto most_in = [&](double seconds) {
        int low = 1, high = kMostEdgeSpp;
        while (high - low > 1 + low / 64) {
            const int middle = std::clamp(geometric_mean(low, high), low + 1, high - 1);
            (cost(middle) * per_unit_s <= seconds ? low : high) = middle;
        }
        return low;
    };
    constexpr int kWorthwhile = 8;
    // Records may have taken longer than was thought: then it pays to be a little late.
    const int due = std::max(plan.edge_spp / 2, kWorthwhile);
    const double late_s = std::max(left + grace, 0.5 * grace);
    plan.edge_spp = std::max(most_in(left), std::min(most_in(late_s), due));
}

}  // namespace vecino
