// Static coupling: the deflected cutter cuts, each tooth passing in its equilibrium.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <tbb/task_group.h>

#include "base/cancel.h"
#include "deflection/static_cut.h"
#include "removal/engagement.h"
#include "simulate/cut_parts.h"
#include "simulate/tooth_loads.h"

namespace camber::simulate {

using deflection::StaticCut;
using deflection::ToothPass;
using removal::DeflectionTable;
using removal::Stamp;

namespace {

/// Largest of the absolute values.
float largest(std::span<const float> values) {
  float out = 0;
  for (const float v : values) out = std::max(out, std::abs(v));
  return out;
}

class StaticCoupling : public Coupling {
 public:
  explicit StaticCoupling(const CutTool& tool) : tool_(tool) {}

  double commit() override { return static_cut_ ? static_cut_->commit() : 0; }

  void cut(const CutStretch& stretch, const BendBefore& before, CutResult& result) override {
    const std::span<const Stamp> all = stretch.all;
    const std::size_t from = stretch.from;
    DeflectionTable& deflections = stretch.deflections;
    std::vector<StampLoad>& loads = stretch.loads;
    if (!static_cut_) {
      static_cut_.emplace(tool_.stock, *tool_.blank, tool_.envelope, tool_.model,
                          StaticCut::Path{all, stretch.first_id, tool_.options.known}, settle_options(), tool_.run_out,
                          tool_.different_teeth);
      static_cut_->remember(from, before.rows, deflections.row_size(), before.largest_mm);
    }
    // Loads between two readings lie between theirs; each stretch of passings ends with readings.
    static_cut_->start(from, loads.size(), deflections, [this, from, count = loads.size()](std::size_t k) {
      return tool_.in_turn(from + k) || k + tool_.different_teeth >= count;
    });
    ToothPass pass;
    std::vector<char> read(loads.size(), 1);
    tbb::task_group behind;  // the load of a tooth passing is summed up while the next one cuts
    for (std::size_t k = 0; k < loads.size(); ++k) {
      cancellation_point();
      const Stamp& stamp = all[from + k];
      const auto passing = static_cut_->cut(k);
      const auto stand = [&] {
        if (!settled_) result.unsettled_stamps.push_back(static_cast<std::uint32_t>(result.loads.size() + k));
      };
      if (passing.rounds == 0) {
        read[k] = 0;
        stand();
        continue;
      }
      ++result.read;
      if (!passing.chips.empty() || !passing.settled) ++cutting_readings_;
      behind.wait();
      behind.run([this, &loads, &pass, &deflections, &result, all, chips = passing.chips, from, k] {
        tool_.model.evaluate(chips, from + k, removal::motion_in_tool(all, from + k), pass);
        loads[k] = summarize(pass, all[from + k].pose);
        loads[k].chip_mm3 = removal::swept_chip_volume_mm3(tool_.envelope, chips, deflections,
                                                           deflections.row(static_cast<std::ptrdiff_t>(k)));
        loads[k].arc = deflection::chip_arc(tool_.envelope, chips);
        tool_.keep_turn(chips, all, from + k, result);
      });
      result.rounds_max = std::max(result.rounds_max, passing.rounds);
      if (!passing.settled) {
        if (settled_) ++result.unsettled;
        if (result.unsettled_moves.empty() || result.unsettled_moves.back() != stamp.move) {
          result.unsettled_moves.push_back(stamp.move);
          result.unsettled_reasons.push_back(passing.reason);
        }
      }
      settled_ = passing.settled;
      stand();
      if (!passing.settled) ++unsettled_readings_, unsettled_weight_ += weight_of(passing.chips.size());
      if (!passing.settled && unsettled_weight_ >= static_cast<double>(tool_.options.give_up_after) &&
          static_cast<double>(unsettled_readings_) > NoRest::kHopeless * static_cast<double>(cutting_readings_)) {
        behind.wait();
        throw NoRest{unsettled_readings_, cutting_readings_, result.unsettled_moves.front(),
                     result.unsettled_reasons.front()};
      }
    }
    behind.wait();
    fill_between(read, result.loads, loads);
    bend_between(read, deflections);
    result.extrapolation = static_cut_->extrapolation_errors();
  }

 private:
  /// A reading takes time by its chips: one of very many counts as several.
  static double weight_of(std::size_t chips) {
    constexpr double kMany = 4000;
    return std::max(1.0, static_cast<double>(chips) / kMany);
  }

  /// Loads of the passings that were not read, from the nearest of the same tooth that were. `before`: of the stretches
  /// before, which end with readings.
  void fill_between(std::span<const char> read, std::span<const StampLoad> before, std::span<StampLoad> loads) const {
    const auto period = static_cast<std::ptrdiff_t>(tool_.different_teeth),
               count = static_cast<std::ptrdiff_t>(loads.size());
    const auto is_read = [&](std::ptrdiff_t k) { return k < 0 || read[static_cast<std::size_t>(k)] != 0; };
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      if (is_read(k)) continue;
      const std::ptrdiff_t a = k - period;  // filled already
      std::ptrdiff_t b = k + period;
      while (!is_read(b)) b += period;
      const StampLoad& earlier =
          a >= 0 ? loads[static_cast<std::size_t>(a)] : before[before.size() - static_cast<std::size_t>(-a)];
      loads[static_cast<std::size_t>(k)] = between(earlier, loads[static_cast<std::size_t>(b)],
                                                   static_cast<double>(period) / static_cast<double>(b - a));
    }
  }

  /// The same of the deflections, which leave the marks: extrapolated ones carve the stock until the next reading. They
  /// stay at rotation steps at which that is another one at once: the cut has changed there, not before.
  void bend_between(std::span<const char> read, DeflectionTable& deflections) const {
    constexpr float kAtOnce = 0.1f;  // of the largest deflection
    const auto period = static_cast<std::ptrdiff_t>(tool_.different_teeth),
               count = static_cast<std::ptrdiff_t>(read.size());
    const std::size_t size = deflections.row_size();
    for (std::ptrdiff_t k = period - 1; k < count; ++k) {
      if (read[static_cast<std::size_t>(k)] != 0) continue;
      std::ptrdiff_t b = k + period;
      while (read[static_cast<std::size_t>(b)] == 0) b += period;
      const float *earlier = deflections.row(k - period), *later = deflections.row(b),
                  *foreseen = deflections.row(b - period);
      const float way = static_cast<float>(period) / static_cast<float>(b - k + period),
                  at_once = kAtOnce * std::max(largest({later, size}), largest({foreseen, size}));
      float* row = deflections.row(k);
      for (std::size_t i = 0; i < size; ++i)
        if (std::abs(later[i] - foreseen[i]) <= at_once) row[i] = earlier[i] + way * (later[i] - earlier[i]);
    }
  }

  deflection::SettleOptions settle_options() const {
    const CutOptions& options = tool_.options;
    deflection::SettleOptions out{options.max_rounds, options.settle_um, options.settle_fraction};
    out.longest_gap = options.longest_gap;
    return out;
  }

  const CutTool& tool_;
  std::optional<StaticCut> static_cut_;
  bool settled_ = true;  ///< the last tooth passing
  std::size_t cutting_readings_ = 0, unsettled_readings_ = 0;
  double unsettled_weight_ = 0;
};

}  // namespace

std::unique_ptr<Coupling> static_coupling(const CutTool& tool) { return std::make_unique<StaticCoupling>(tool); }

}  // namespace camber::simulate
