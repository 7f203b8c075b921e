// SPDX-License-Identifier: Apache-2.0
#include "eval/accept.h"

#include <algorithm>
#include <cstdio>

#include "core/error.h"
#include "eval/commands.h"
#include "eval/gate.h"
#include "eval/gate_time.h"
#include "eval/name_pattern.h"

namespace vecino {
namespace {

std::string short_number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.5g", value);
    return text;
}

std::string spread_text(const MetricSpread& spread) {
    return short_number(spread.mean) + " +- " + short_number(spread.deviation);
}

struct Line {
    char mark;  ///< ' ' same, '~' other numbers, '!' the old baseline's gate fails, '+' new, '-'
                ///< gone
    std::string group, metric, old_text, new_text, note;
};

class Plan {
  public:
    Plan(const GateRun& run, const std::optional<Baseline>& old, const std::string& only)
        : run_(run), old_(old), only_(only) {
        if (!old || old->matrix == run.matrix) return;
        throw Error(ExitCode::usage, "baseline: found one of the matrix \"" + old->matrix +
                                         "\", allowed: of \"" + run.matrix + "\", or a new file");
    }

    AcceptPlan make() {
        plan_.baseline.matrix = run_.matrix;
        if (old_) plan_.baseline.groups = old_->groups;
        bool any = false;
        for (const RunGroup& group : run_.groups) {
            if (!only_.matches(group.name)) continue;
            any = true;
            accept(group);
        }
        remove_gone();
        if (!any) only_.fail_without_match();
        plan_.table = table();
        return std::move(plan_);
    }

  private:
    const BaselineGroup* old_group(const std::string& name) const {
        if (!old_) return nullptr;
        const auto found = old_->groups.find(name);
        return found == old_->groups.end() ? nullptr : &found->second;
    }

    void accept(const RunGroup& group) {
        if (!group.faults.empty()) {
            plan_.faults.insert(plan_.faults.end(), group.faults.begin(), group.faults.end());
            return;
        }
        if (group.is_refused()) return;
        const GateClass& gate = class_of(run_.classes, group.params);
        const BaselineGroup now = baseline_of(group, gate);
        const BaselineGroup* const then = old_group(group.name);
        const std::string new_time = then == nullptr ? "" : why_new_time(group, gate, *then);
        if (then == nullptr || !(*then == now) || !new_time.empty()) {
            ++plan_.changed;
            plan_.baseline.groups[group.name] = now;
        }
        if (!new_time.empty())
            lines_.push_back({'~', group.name, "time_s", short_number(then->time_s.mean),
                              short_number(now.time_s.mean), new_time});
        for (const auto& [metric, tolerance] : gate.tolerance_db)
            add_line(group, gate, metric, now);
    }

    /// Times differ from run to run: new ones are kept where the old ones stand in the way.
    static std::string why_new_time(const RunGroup& group, const GateClass& gate,
                                    const BaselineGroup& then) {
        if (then.host != group.host()) return "another host";
        const auto verdict = judge_time(group, gate, then);
        return verdict && verdict->outcome == GateOutcome::fail ? "time: " + verdict->text : "";
    }

    void add_line(const RunGroup& group, const GateClass& gate, const GateMetric& metric,
                  const BaselineGroup& now) {
        const auto value = now.metrics.find(metric.name);
        if (value == now.metrics.end()) return;
        Line line{'+', group.name, metric.name, "-", spread_text(value->second), ""};
        const BaselineGroup* const then = old_group(group.name);
        if (then != nullptr && then->metrics.contains(metric.name)) {
            line.old_text = spread_text(then->metrics.at(metric.name));
            compare(group, gate, metric, line);
        }
        lines_.push_back(line);
    }

    void compare(const RunGroup& group, const GateClass& gate, const GateMetric& metric,
                 Line& line) {
        const BaselineGroup& then = *old_group(group.name);
        line.mark = line.old_text == line.new_text ? ' ' : '~';
        if (!same_question(then.question, group.question)) {
            line.mark = '~';
            line.note = "another question";
            return;
        }
        for (const Verdict& verdict : judge_quality(group, gate, then)) {
            if (verdict.metric != metric.name || verdict.outcome != GateOutcome::fail) continue;
            line.mark = '!';
            line.note += (line.note.empty() ? "" : "; ") + verdict.rule + ": " + verdict.text;
        }
    }

    void remove_gone() {
        std::erase_if(plan_.baseline.groups, [&](const auto& entry) {
            const RunGroup* const group = run_.find(entry.first);
            const bool gone =
                (group == nullptr || group->is_refused()) && only_.matches(entry.first);
            if (gone) {
                ++plan_.changed;
                lines_.push_back({'-', entry.first, "", "", "",
                                  group == nullptr ? "no longer in the matrix" : "refused"});
            }
            return gone;
        });
    }

    std::string table() const {
        std::size_t widths[4] = {5, 6, 3, 3};
        for (const Line& line : lines_) {
            const std::string* const texts[] = {&line.group, &line.metric, &line.old_text,
                                                &line.new_text};
            for (int i = 0; i < 4; ++i) widths[i] = std::max(widths[i], texts[i]->size());
        }
        std::string text;
        const auto add = [&](const Line& line) {
            const auto padded = [&](std::string part, int column) {
                part.resize(widths[column] + 2, ' ');
                return part;
            };
            text += std::string(1, line.mark) + " " + padded(line.group, 0) +
                    padded(line.metric, 1) + padded(line.old_text, 2) + padded(line.new_text, 3) +
                    line.note;
            text.erase(text.find_last_not_of(' ') + 1);
            text += "\n";
        };
        add({' ', "group", "metric", "old", "new", "+- standard deviation over seeds"});
        for (const Line& line : lines_) add(line);
        return text;
    }

    const GateRun& run_;
    const std::optional<Baseline>& old_;
    NamePattern only_;
    AcceptPlan plan_;
    std::vector<Line> lines_;
};

}  // namespace

AcceptPlan plan_accept(const GateRun& run, const std::optional<Baseline>& old,
                       const std::string& only) {
    return Plan(run, old, only).make();
}

}  // namespace vecino
