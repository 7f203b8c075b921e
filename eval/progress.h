// SPDX-License-Identifier: Apache-2.0
//
// Progress on stderr: one bar with an ETA on a terminal, a plain line now and then elsewhere. Stops
// work on SIGINT and SIGTERM by answering false, so that state is kept.
#pragma once

#include <chrono>
#include <string>

namespace vecino {

/// From here on SIGINT and SIGTERM set a flag instead of ending the program; a second one ends it.
void catch_interrupts();
bool interrupted();

class ProgressBar {
  public:
    explicit ProgressBar(std::string label);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// done in [0, 1]; returns false when the work should stop.
    bool update(double done);
    void label(const std::string& text) { label_ = text; }

  private:
    using Clock = std::chrono::steady_clock;
    void draw(double done, double elapsed_s) const;

    std::string label_;
    bool terminal_;
    bool drawn_ = false;
    Clock::time_point start_ = Clock::now();
    Clock::time_point last_ = start_;
};

/// "1 h 02 min", "3 min 20 s", "12 s"
std::string duration_text(double seconds);

}  // namespace vecino
