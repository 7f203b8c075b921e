// SPDX-License-Identifier: Apache-2.0
#include "eval/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace vecino {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;

void on_signal(int signal) {
    if (g_interrupted != 0) std::signal(signal, SIG_DFL);
    g_interrupted = 1;
}

constexpr double kTerminalInterval_s = 0.1;
constexpr double kPlainInterval_s = 10.0;

}  // namespace

void catch_interrupts() {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
}

bool interrupted() {
    return g_interrupted != 0;
}

std::string duration_text(double seconds) {
    const auto total = std::llround(seconds);
    char text[64];
    if (total >= 3600) {
        std::snprintf(text, sizeof text, "%lld h %02lld min", total / 3600, total / 60 % 60);
    } else if (total >= 60) {
        std::snprintf(text, sizeof text, "%lld min %02lld s", total / 60, total % 60);
    } else {
        std::snprintf(text, sizeof text, "%lld s", total);
    }
    return text;
}

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
    if (terminal_ && drawn_) std::fprintf(stderr, "\r\033[K");
}

bool ProgressBar::update(double done) {
    const auto now = Clock::now();
    const double since_last_s = std::chrono::duration<double>(now - last_).count();
    if (since_last_s >= (terminal_ ? kTerminalInterval_s : kPlainInterval_s)) {
        last_ = now;
        drawn_ = true;
        draw(std::clamp(done, 0.0, 1.0), std::chrono::duration<double>(now - start_).count());
    }
    return !interrupted();
}

void ProgressBar::draw(double done, double elapsed_s) const {
    const std::string left =
        done > 0.005 ? duration_text(elapsed_s / done * (1.0 - done)) + " left" : "estimating";
    if (!terminal_) {
        std::fprintf(stderr, "%s: %.0f %%, %s\n", label_.c_str(), 100.0 * done, left.c_str());
        return;
    }
    constexpr int kCells = 30;
    const int full = static_cast<int>(done * kCells);
    std::string bar;
    for (int i = 0; i < kCells; ++i) bar += i < full ? "█" : "░";
    std::fprintf(stderr, "\r\033[K%s %5.1f %%  %s  %s", bar.c_str(), 100.0 * done, left.c_str(),
                 label_.c_str());
    std::fflush(stderr);
}

}  // namespace vecino
