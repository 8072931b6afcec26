// Rigid coupling: the undeflected cutter cuts, and its chips bend the tool.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>

#include <tbb/enumerable_thread_specific.h>

#include "base/cancel.h"
#include "deflection/static_cut.h"
#include "removal/engagement.h"
#include "simulate/cut_parts.h"
#include "simulate/tooth_loads.h"

namespace camber::simulate {

using deflection::ToothPass;
using removal::DeflectionTable;
using removal::Stamp;

namespace {

/// True where the motion is another one from k - 1 to k, or from k to k + 1.
bool motion_changes(std::span<const Stamp> stamps, std::size_t k) {
  constexpr double kMotionChange = 0.1;  ///< of the feed per tooth
  const auto changes = [&](std::size_t i) {
    const Vec3& now = stamps[i].feed_per_tooth_mm;
    return stamps[i].first || (now - stamps[i - 1].feed_per_tooth_mm).norm() > kMotionChange * now.norm();
  };
  return k == 0 || k + 1 == stamps.size() || changes(k) || changes(k + 1);
}

/// The deflections of stamp k as those of a and b, a < k < b, predict them.
void mix_rows(DeflectionTable& deflections, std::size_t a, std::size_t k, std::size_t b) {
  const auto way = static_cast<float>(k - a) / static_cast<float>(b - a);
  const float *from = deflections.row(static_cast<std::ptrdiff_t>(a)),
              *to = deflections.row(static_cast<std::ptrdiff_t>(b));
  float* row = deflections.row(static_cast<std::ptrdiff_t>(k));
  for (std::size_t i = 0; i < deflections.row_size(); ++i) row[i] = from[i] + way * (to[i] - from[i]);
}

/// True where deflections, chip and mean force of stamp k differ little from the line between a and b: deflections by
/// no more than what static coupling allows of an extrapolated one, over the rotation steps that cut.
bool on_line(const DeflectionTable& deflections, std::span<const StampLoad> loads, std::size_t a, std::size_t k,
             std::size_t b) {
  const deflection::SettleOptions allowed;
  const double way = static_cast<double>(k - a) / static_cast<double>(b - a);
  const StampLoad line = between(loads[a], loads[b], way);
  const auto near = [&](double is, double on_line) {
    return std::abs(is - on_line) <= allowed.follow_fraction * std::abs(is);
  };
  constexpr double kForceFraction = 0.005;  // of the mean force: a tool that hardly bends shows little of it
  if (!(loads[a].chip_mm3 > 0 && loads[b].chip_mm3 > 0) || !near(loads[k].chip_mm3, line.chip_mm3) ||
      !near(loads[k].torque_mean_Nmm, line.torque_mean_Nmm) ||
      (loads[k].force_mean_N - line.force_mean_N).norm() > kForceFraction * loads[k].force_mean_N.norm())
    return false;
  const float *from = deflections.row(static_cast<std::ptrdiff_t>(a)),
              *to = deflections.row(static_cast<std::ptrdiff_t>(b)),
              *at = deflections.row(static_cast<std::ptrdiff_t>(k));
  float error2 = 0, size2 = 0;
  std::size_t cutting = 0;
  for (std::size_t i = 0; i < deflections.row_size(); ++i) {
    const float on = from[i] + static_cast<float>(way) * (to[i] - from[i]);
    error2 += (at[i] - on) * (at[i] - on);
    size2 += at[i] * at[i];
    cutting += at[i] != 0;
  }
  const double um = 1000 / std::sqrt(std::max(1.0, static_cast<double>(cutting)));
  return std::sqrt(static_cast<double>(error2)) * um <=
         std::max(allowed.follow_um, allowed.follow_fraction * std::sqrt(static_cast<double>(size2)) * um);
}

class RigidCoupling : public Coupling {
 public:
  explicit RigidCoupling(const CutTool& tool) : tool_(tool) {}

  double commit() override { return engager_ ? engager_->commit() : 0; }

  void cut(const CutStretch& stretch, const BendBefore&, CutResult& result) override {
    const std::span<const Stamp> all = stretch.all;
    const std::size_t from = stretch.from;
    DeflectionTable& deflections = stretch.deflections;
    std::vector<StampLoad>& loads = stretch.loads;
    if (!engager_)
      engager_.emplace(tool_.stock, *tool_.blank, tool_.envelope, all, stretch.first_id,
                       tool_.tooth_marks ? tool_.envelope.flutes : 1, tool_.options.known);
    const auto& blocks = engager_->blocks();
    std::map<std::size_t, std::vector<removal::ChipSample>> turn;  // what the turn needs
    std::mutex turn_lock;
    tbb::enumerable_thread_specific<ToothPass> passes;
    std::atomic<std::size_t> read{0};
    const std::size_t before = result.loads_at_ratio.size();
    if (tool_.options.chip_ratio > 0) result.loads_at_ratio.resize(before + loads.size());
    const std::span<StampLoad> at_other_chip = std::span(result.loads_at_ratio).subspan(before);
    const removal::ChipSink load_of = [&](std::size_t k, std::span<const removal::ChipBlock> chips) {
      cancellation_point();
      ToothPass& pass = passes.local();
      std::span<float> row(deflections.row(static_cast<std::ptrdiff_t>(k)),
                           tool_.options.drilling ? 0 : deflections.row_size());
      tool_.model.evaluate(blocks, chips, from + k, removal::motion_in_tool(all, from + k), pass, row);
      loads[k] = summarize(pass, all[from + k].pose);
      loads[k].chip_mm3 = removal::chip_volume_mm3(tool_.envelope, blocks, chips);
      loads[k].arc = deflection::chip_arc(tool_.envelope, blocks, chips);
      if (!at_other_chip.empty()) at_other_chip[k] = at_ratio(blocks, chips, all, from + k, pass);
      ++read;
      if (!tool_.in_turn(from + k)) return;
      const std::scoped_lock lock(turn_lock);
      turn[k] = removal::chips_of(blocks, chips);
    };
    if (tool_.options.drilling || tool_.tooth_marks || tool_.options.longest_gap <= 1) {
      engager_->engage(from, loads.size(), load_of);
    } else {
      const std::span<const Stamp> stamps = all.subspan(from, loads.size());
      engager_->engage(
          from, loads.size(),
          {.read = load_of,
           .must_read = [&](std::size_t k) { return tool_.in_turn(from + k) || motion_changes(stamps, k); },
           .on_line = [&](std::size_t a, std::size_t k, std::size_t b) { return on_line(deflections, loads, a, k, b); },
           .between =
               [&](std::size_t a, std::size_t k, std::size_t b) {
                 const double way = static_cast<double>(k - a) / static_cast<double>(b - a);
                 loads[k] = between(loads[a], loads[b], way);
                 if (!at_other_chip.empty()) at_other_chip[k] = between(at_other_chip[a], at_other_chip[b], way);
                 mix_rows(deflections, a, k, b);
               }});
    }
    result.read += read;
    for (const auto& [k, chips] : turn) tool_.keep_turn(chips, all, from + k, result);
  }

 private:
  /// The loads for chips of tool_.options.chip_ratio to their thickness.
  StampLoad at_ratio(const removal::EnvelopeBlocks& blocks, std::span<const removal::ChipBlock> chips,
                     std::span<const Stamp> all, std::size_t passing, ToothPass& pass) const {
    const removal::ToothMotion motion = removal::motion_in_tool(all, passing);
    thread_local std::vector<removal::ChipBlock> scaled;
    scaled.assign(chips.begin(), chips.end());
    const auto ratio = static_cast<float>(tool_.options.chip_ratio);
    for (removal::ChipBlock& block : scaled)
      for (float& h : block.thickness_mm)
        if (h > 0) h *= ratio;
    const double share = tool_.options.chip_ratio;
    tool_.model.evaluate(blocks, scaled, passing, {share * motion.tip_mm, share * motion.turn_rad}, pass, {});
    return summarize(pass, all[passing].pose);
  }

  const CutTool& tool_;
  std::optional<removal::RigidEngager> engager_;
};

}  // namespace

std::unique_ptr<Coupling> rigid_coupling(const CutTool& tool) { return std::make_unique<RigidCoupling>(tool); }

}  // namespace camber::simulate
