// SPDX-License-Identifier: Apache-2.0
//
// The clock of surface_records: while a frame is made, what is still open of its plan is chosen by
// what the machine has shown so far, so that the frame is done in time. What comes out is a plan
// like any other: a frame depends on it alone, and not on how it was found.
#pragma once

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "core/timing.h"
#include "filters/auto_plan.h"
#include "filters/band_survey.h"
#include "filters/record_check.h"
#include "filters/records.h"

namespace vecino {

/// Work done on a few places of a frame to see how long it takes, and thrown away. Takes the number
/// of the trial, for other places each time; trials may run side by side. Returns seconds of one
/// thread for one unit of work: a thread's own time, since what other programs take of so short a
/// while says nothing.
using Trial = std::function<double(int)>;
constexpr std::size_t kMostTrials = 4;

/// What is known once first samples are there, and a few more were tried.
struct PaceFindings {
    double needy_pixels = 0;
    double records_at_16 = 0;  ///< with cells of 16 pixels
    double record_noise = 0;   ///< as of RecordErrors
    bool has_record_light = true;
    double path_s = 0;    ///< one path of a record, on one thread
    double sample_s = 0;  ///< one further sample of a needy pixel, on one thread
    double surfaces = 1;  ///< of a cell of 16 pixels that has any
    /// By the number of first samples: those that there are, and more.
    std::vector<std::pair<int, EdgeCurve>> edges = {};
};

/// What is known of errors once records are there.
struct ErrorFindings {
    double samples = 0;        ///< sum over needy pixels, of what their samples leave
    double shared_pixels = 0;  ///< several surfaces may share so many
    RecordCheck at_shared, elsewhere;
};

/// What first samples of a pixel take, on one thread.
struct PilotCost {
    double one_s = 0, four_s = 0;

    [[nodiscard]] double of(int spp) const {
        return one_s + (spp - 1) * std::max((four_s - one_s) / 3, 0.1 * one_s);
    }
};

class Pace {
  public:
    /// seconds: from begin() until the frame is done, by so many threads. found: what is known of
    /// errors, and the size.
    Pace(double seconds, int threads, const PilotFindings& found);

    static constexpr int kMostPilotSpp = 32;

    /// What a paced frame begins with; all of it but refine_tau may change.
    static SurfaceRecordsPlan first_plan() { return {1, 16, 16, 0, 64, 64, 1.0, 0.15}; }

    /// The clock starts.
    void begin() { watch_ = {}; }

    /// Where there are several bands: the plan is chosen in the first, by what the survey says of
    /// the others. That with most needy pixels takes its place.
    void choose_first(std::vector<BandRows>& bands, const std::vector<BandSurvey>& surveys);

    /// The middle of a few trials: places differ, and some may be disturbed. Of fewer where time is
    /// short.
    [[nodiscard]] double typical(const Trial& trial) const;

    /// What the machine makes of its threads: first samples, so much work by a trial, took so long.
    /// look_s: to find needy pixels by them.
    void take_pilot(double work_s, double seconds, double look_s);

    void choose_pilot(const PilotCost& cost, SurfaceRecordsPlan& plan);
    /// All that can be told. If pilot_spp changes, first samples are to be traced again.
    void choose_structure(const PaceFindings& here, SurfaceRecordsPlan& plan);
    /// Paths for the records of a level, now that they are counted and some of them timed.
    void choose_paths(const RecordCount& level, SurfaceRecordsPlan& plan);
    /// The last that is open. cost: units of work that edge samples, so many on average, take;
    /// unit_s: one of these, on one thread.
    void choose_edges(const std::function<double(int)>& cost, double unit_s,
                      SurfaceRecordsPlan& plan);

    /// How large a check of records may be, that is a small part of what time is left.
    [[nodiscard]] RecordCheckSize check_size(const SurfaceRecordsPlan& plan) const;
    /// Whether whole paths are better at edges than records, at the price of having fewer samples.
    /// has_lamps: there is light that clusters know better than paths do.
    [[nodiscard]] bool wants_paths(const ErrorFindings& here, const SurfaceRecordsPlan& plan,
                                   bool has_lamps) const;
    /// Of the frame: a mean square in sRGB.
    [[nodiscard]] double expected_error(const ErrorFindings& here,
                                        const SurfaceRecordsPlan& plan) const;

  private:
    void take_records(const PaceFindings& here);
    [[nodiscard]] double pilot_again_s(int from_spp, int to_spp) const;
    [[nodiscard]] Schedule best_schedule(const PaceFindings& here, int pilot_spp);
    /// Of the frame, for a second of one thread's work.
    [[nodiscard]] double per_work_s() const { return slowness_ / threads_; }
    [[nodiscard]] double left_s() const { return until_s_ - watch_.seconds(); }

    Stopwatch watch_;
    double seconds_;
    int threads_;
    double slowness_ = 1;  ///< of threads that run side by side, and with other programs
    PilotFindings found_;
    CostRates rates_{};
    double until_s_;
    PilotCost pilot_cost_;
    double pilot_s_ = 0, look_s_ = 0;
    double records_until_s_ = 0;
    double records_from_s_ = 0;
    // Of the first band: its share of these, held against its share of the time.
    double needy_density_ = 1, record_density_ = 1;
};

}  // namespace vecino
