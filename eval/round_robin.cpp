// SPDX-License-Identifier: Apache-2.0
#include "eval/round_robin.h"

#include <algorithm>

#include "core/error.h"
#include "core/timing.h"

namespace vecino {
namespace {

Measured measured(const std::vector<double>& values) {
    const auto [least, most] = std::ranges::minmax(values);
    const double middle = median(values);
    return {middle, 0.5 * (most - least) / middle};
}

template <class Watch>
double time_runs(const std::function<void()>& work) {
    constexpr double kLeast_s = 0.01;
    const Watch watch;
    int runs = 0;
    do {
        work();
        ++runs;
    } while (watch.seconds() < kLeast_s);
    return watch.seconds() / runs;
}

}  // namespace

double seconds_per_run(const std::function<void()>& work) {
    return time_runs<Stopwatch>(work);
}

double thread_seconds_per_run(const std::function<void()>& work) {
    return time_runs<ThreadStopwatch>(work);
}

std::size_t RoundRobin::add(std::function<double()> measure) {
    measures_.push_back(std::move(measure));
    seconds_.emplace_back();
    return measures_.size() - 1;
}

void RoundRobin::run(int rounds, const Progress& progress) {
    const auto total = static_cast<double>((rounds + 1)) * static_cast<double>(measures_.size());
    double done = 0;
    for (int round = 0; round <= rounds; ++round) {
        for (std::size_t unit = 0; unit < measures_.size(); ++unit) {
            const double seconds = measures_[unit]();
            if (round > 0) seconds_[unit].push_back(seconds);
            if (progress && !progress(++done / total)) {
                throw Error(ExitCode::interrupted, "interrupted");
            }
        }
    }
}

Measured RoundRobin::time(std::size_t unit) const {
    return measured(seconds_[unit]);
}

Measured RoundRobin::rate(std::size_t unit, double work) const {
    std::vector<double> rates;
    for (const double seconds : seconds_[unit]) rates.push_back(work / seconds);
    return measured(rates);
}

Measured RoundRobin::ratio(std::size_t unit, std::size_t over) const {
    std::vector<double> ratios;
    for (std::size_t round = 0; round < seconds_[unit].size(); ++round) {
        ratios.push_back(seconds_[unit][round] / seconds_[over][round]);
    }
    return measured(ratios);
}

}  // namespace vecino
