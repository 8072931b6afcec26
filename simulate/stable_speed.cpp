#include "simulate/stable_speed.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/cancel.h"
#include "dynamics/tool_modes.h"
#include "simulate/passage_cut.h"

namespace camber::simulate {
namespace {

struct SevereCut {
  PassageCut passage;
  bool upright = true;
  double severity() const { return passage.depth_mm * passage.cut.kt_MPa * passage.cut.arc_rad; }
};

/// The deepest tooth passing of each kind of cut, the most severe first.
std::vector<SevereCut> severe_cuts(const machine::Job& job, const SimulatedProgram& program,
                                   std::span<const StampLoad> loads, int tool, double speed_rpm) {
  constexpr double kArcs = 12, kCentres = 16, kRatios = 5;  // kinds of a root of 1 rad, of half a turn, of 1
  std::map<std::tuple<int, int, int, bool>, SevereCut> kinds;
  const auto& stamps = program.path.stamps;
  for (const removal::ToolRun& run : program.path.runs) {
    if (run.kind != removal::RunKind::milling || run.tool != tool) continue;
    for (std::size_t k = run.from; k < run.from + run.count && k < loads.size(); ++k) {
      if (!cuts(loads[k])) continue;
      if (program.moves_in_part().state_of(program.moves_in_part().moves[stamps[k].move]).spindle_speed_rpm !=
          speed_rpm)
        continue;
      const SevereCut cut{passage_cut(loads[k], job.material), stamps[k].pose.upright()};
      const dynamics::ArcCut& c = cut.passage.cut;
      SevereCut& worst = kinds[{static_cast<int>(kArcs * std::sqrt(c.arc_rad)),
                                static_cast<int>(std::floor(c.centre_rad / kPi * kCentres)),
                                static_cast<int>(std::floor(c.kr_MPa / c.kt_MPa * kRatios)), cut.upright}];
      if (cut.severity() > worst.severity()) worst = cut;
    }
  }
  std::vector<SevereCut> out;
  for (const auto& [kind, cut] : kinds) out.push_back(cut);
  std::ranges::stable_sort(out, std::greater{}, &SevereCut::severity);
  if (out.size() > kSevereCuts) out.resize(kSevereCuts);
  return out;
}

class SpeedSearch {
 public:
  SpeedSearch(const machine::Job& job, int tool, std::vector<SevereCut> cuts, double margin)
      : job_(job),
        tool_(job.tools.at(tool)),
        modes_(dynamics::modes_of(tool_)),
        cuts_(std::move(cuts)),
        margin_(margin) {}

  StableSpeed run(double programmed_rpm, const SpeedBounds& bounds) {
    if (cuts_.empty()) return {};
    set_speeds(bounds);
    margins_.assign(speeds_.size(), 0.0);
    count_in(worst_at(programmed_rpm).second);
    for (int tried = 0; tried < kTries; ++tried) {
      const auto i = nearest(programmed_rpm);
      if (!i) break;
      const auto [margin, cut] = worst_at(speeds_[*i]);
      if (margin <= margin_) return out(*i);
      // The method of the margins has the last word.
      if (std::ranges::find(limiting_, cut) != limiting_.end())
        margins_[*i] = margin;
      else
        count_in(cut);
    }
    return out({});
  }

 private:
  static constexpr int kSpeeds = 150, kTries = 24;

  void set_speeds(const SpeedBounds& bounds) {
    for (int i = 0; i < kSpeeds; ++i) {
      const double rpm = bounds.lowest_rpm + (bounds.highest_rpm - bounds.lowest_rpm) * i / (kSpeeds - 1);
      const double round = std::max(10.0, 10 * std::floor(rpm / 10));
      if (round >= std::min(bounds.lowest_rpm, bounds.highest_rpm - 10) && (speeds_.empty() || speeds_.back() != round))
        speeds_.push_back(round);
    }
  }

  dynamics::StabilityTable table(double rpm, bool upright) const {
    return stability_table(job_, tool_, modes_, rpm, upright);
  }

  using MarginOfCut = std::pair<double, std::size_t>;  ///< and its index

  /// The greatest margin at a speed: of those that have the greatest ones of zero order.
  MarginOfCut worst_at(double rpm) const {
    constexpr std::size_t kExact = 4;
    std::vector<MarginOfCut> all;
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      cancellation_point();
      const PassageCut& p = cuts_[i].passage;
      all.emplace_back(p.depth_mm / table(rpm, cuts_[i].upright).zero_order_at(p.cut).depth_mm, i);
    }
    std::ranges::sort(all, std::greater{});
    MarginOfCut out{-1, 0};
    for (std::size_t k = 0; k < std::min(kExact, all.size()); ++k) {
      const std::size_t i = all[k].second;
      const PassageCut& p = cuts_[i].passage;
      out = std::max(out, {p.depth_mm / table(rpm, cuts_[i].upright).exactly_at(p.cut).depth_mm, i});
    }
    return out;
  }

  /// The cut bounds the speeds from now on.
  void count_in(std::size_t cut) {
    limiting_.push_back(cut);
    const SevereCut& c = cuts_[cut];
    const auto depths = table(speeds_.front(), c.upright).at_speeds(c.passage.cut, speeds_);
    for (std::size_t i = 0; i < speeds_.size(); ++i)
      margins_[i] = std::max(margins_[i], c.passage.depth_mm / depths[i].depth_mm);
  }

  std::optional<std::size_t> nearest(double rpm) const {
    std::optional<std::size_t> out;
    for (std::size_t i = 0; i < speeds_.size(); ++i)
      if (margins_[i] <= margin_ && (!out || std::abs(speeds_[i] - rpm) < std::abs(speeds_[*out] - rpm))) out = i;
    return out;
  }

  StableSpeed out(std::optional<std::size_t> stable) const {
    const auto best = static_cast<std::size_t>(std::ranges::min_element(margins_) - margins_.begin());
    return {stable ? speeds_[*stable] : 0, speeds_[best], margins_[best]};
  }

  const machine::Job& job_;
  const machine::Tool& tool_;
  std::vector<machine::Mode> modes_;
  std::vector<SevereCut> cuts_;
  double margin_;
  std::vector<double> speeds_, margins_;  ///< margins of the limiting cuts
  std::vector<std::size_t> limiting_;
};

}  // namespace

SpeedBounds usual_speeds(const machine::Job& job, double rpm) {
  return {rpm / 2, std::max(rpm, std::min(job.machine.spindle.max_rpm, 2 * rpm))};
}

StableSpeed find_stable_speed(const machine::Job& job, const SimulatedProgram& program,
                              std::span<const StampLoad> loads, int tool, double speed_rpm, const SpeedBounds& bounds,
                              double margin) {
  return SpeedSearch(job, tool, severe_cuts(job, program, loads, tool, speed_rpm), margin).run(speed_rpm, bounds);
}

}  // namespace camber::simulate
