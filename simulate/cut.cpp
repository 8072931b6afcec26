#include "simulate/cut.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include "base/cancel.h"
#include "deflection/beam.h"
#include "deflection/static_cut.h"
#include "deflection/tooth_marks.h"
#include "removal/engagement.h"
#include "removal/known_run.h"
#include "simulate/path_stretch.h"
#include "simulate/pieces.h"
#include "simulate/tooth_loads.h"

namespace camber::simulate {

using deflection::kFine;
using deflection::RunOutOffsets;
using deflection::StaticCut;
using deflection::Teeth;
using deflection::ToothMarks;
using deflection::ToothPass;
using deflection::ToothPassModel;
using removal::DeflectionTable;
using removal::EnvelopeGrid;
using removal::Stamp;
using removal::Stock;

namespace {

/// As engaged_top_mm of the stamp below which the stock rises most.
double engaged_top_mm(const Stock& stock, const machine::Tool& tool, std::span<const Stamp> stamps,
                      const removal::KnownRun* known) {
  double rise = 0;
  if (known) return simulate::engaged_top_mm(stock, tool, std::max(rise, stock.max_mm().z() - known->min_mm.z()));
  for (const auto& s : stamps) {
    // The corner of the stock's box that lies farthest up the tool.
    const Vec3 corner = (s.pose.axis.array() > 0).select(stock.max_mm(), stock.min_mm());
    rise = std::max(
        rise, s.pose.upright() ? stock.max_mm().z() - s.pose.tip_mm.z() : (corner - s.pose.tip_mm).dot(s.pose.axis));
  }
  return simulate::engaged_top_mm(stock, tool, rise);
}

Vec3 deflection_at(const EnvelopeGrid& envelope, const DeflectionTable& deflections, const float* row,
                   const Contact& c) {
  const double step = deflections.step_at(c.angle_rad, c.height_mm, envelope.lag_per_mm, envelope.flutes);
  return deflections.at(row, c.height_mm, step);
}

/// The load of a tooth passing between two others.
StampLoad between(const StampLoad& a, const StampLoad& b, double way) {
  const auto mix = [&](const auto& of_a, const auto& of_b) { return (1 - way) * of_a + way * of_b; };
  StampLoad load;
  load.force_max_N = mix(a.force_max_N, b.force_max_N);
  load.lateral_max_N = mix(a.lateral_max_N, b.lateral_max_N);
  load.axial_max_N = mix(a.axial_max_N, b.axial_max_N);
  load.force_mean_N = mix(a.force_mean_N, b.force_mean_N);
  load.chip_mm3 = mix(a.chip_mm3, b.chip_mm3);
  load.torque_max_Nmm = mix(a.torque_max_Nmm, b.torque_max_Nmm);
  load.torque_mean_Nmm = mix(a.torque_mean_Nmm, b.torque_mean_Nmm);
  load.work_Nmm = mix(a.work_Nmm, b.work_Nmm);
  load.chip_max_mm = mix(a.chip_max_mm, b.chip_max_mm);
  load.chip_area_mm2 = mix(a.chip_area_mm2, b.chip_area_mm2);
  load.arc = mix(a.arc, b.arc);
  return load;
}

/// One tool on one stock; cuts stretch after stretch.
class Cutter {
 public:
  Cutter(Stock& stock, const machine::Tool& tool, const machine::Material& material, std::span<const Stamp> stamps,
         const CutOptions& options)
      : stock_(stock),
        options_(options),
        rigid_(options.coupling == machine::Coupling::rigid),
        diameter_mm_(tool.diameter_mm),
        edges_end_mm_(tool.flute_length_mm.value_or(std::numeric_limits<double>::infinity())),
        top_mm_(engaged_top_mm(stock, tool, stamps, options.known)),
        envelope_(sampled_envelope(stock, tool, top_mm_, options)),
        model_(envelope_, material, deflection::beam_of(tool),
               deflection::node_heights(top_mm_,
                                        std::min(tool.overhang_mm, tool.flute_length_mm.value_or(tool.overhang_mm))),
               rigid_ ? 0.0 : options.edge_ramp_mm, teeth_in_model(Teeth(tool), rigid_),
               options.axis_compliance_mm_per_N, options.drilling ? nullptr : options.part) {
    if (!options.blank) own_blank_.emplace(stock);
    blank_ = options.blank ? options.blank : &*own_blank_;
    const Teeth teeth(tool), modelled = teeth_in_model(teeth, rigid_);
    if (!teeth.even()) different_teeth_ = static_cast<std::size_t>(teeth.count());
    if (!modelled.even() && !options.drilling) tooth_marks_.emplace(envelope_, modelled);
    if (!rigid_ && teeth.evenly_spaced()) run_out_ = RunOutOffsets(teeth, model_.steps());
    if (!rigid_) removal::make_patches(envelope_, 0.6 * stock.band_mm());
  }

  /// Cuts stamps from ... from + count - 1 of all.
  void cut(std::span<const Stamp> all, std::size_t from, std::size_t count, std::span<const Contact> contacts,
           std::int32_t first_id, CutResult& result) {
    const std::span<const Stamp> stamps = all.subspan(from, count);
    // Rigid: every row is written anew, and a hole's are not read.
    if (!rigid_ || deflections_.stamps != stamps.size())
      deflections_ = DeflectionTable(stamps.size(), (rigid_ ? kFine : 1) * model_.steps(), model_.node_height_mm(),
                                     model_.axial(), model_.part() != nullptr);
    if (model_.part()) deflections_.edges_end_mm = edges_end_mm_;
    DeflectionTable& deflections = deflections_;
    if (last_rows_.size() >= deflections.row_size())
      std::copy_n(last_rows_.end() - static_cast<std::ptrdiff_t>(deflections.row_size()), deflections.row_size(),
                  deflections.row(-1));
    std::vector<StampLoad> loads(stamps.size());
    if (rigid_)
      engage(all, from, deflections, loads, first_id, result);
    else
      settle(all, from, deflections, loads, first_id, result);
    if (!options_.drilling) watch_range(stamps, deflections, loads, result);
    const auto id = first_id + static_cast<std::int32_t>(from);
    if (tooth_marks_) {
      leave_uneven(stamps, from, deflections, contacts, id, loads);
    } else {
      if (options_.surface) mark(*options_.surface, stamps, deflections, id);
      tell_contacts(envelope_, stamps, run_out_.none() ? deflections : without_run_out(deflections, from), contacts,
                    loads);
    }
    if (options_.tool_surface) mark_tool_alone(stamps, from, deflections, id);
    for (const StampLoad& load : loads) result.chip_mm3 += load.chip_mm3;
    result.loads.insert(result.loads.end(), loads.begin(), loads.end());
    keep_last_rows(deflections);
  }

  /// The stamps before the first one were cut elsewhere.
  void begin_after(const BendBefore& before) {
    last_rows_ = before.rows;
    largest_bend_mm_ = before.largest_mm;
  }

  /// Leaves the stock as cut.
  void finish(CutResult& result) {
    if (engager_) result.stock_mm3 += engager_->commit();
    if (!static_cut_) return;
    result.stock_mm3 += static_cut_->commit();
    result.bend = {std::move(last_rows_), largest_bend_mm_};
  }

 private:
  /// In static coupling the run-out of equally spaced teeth displaces the tool (StaticCut): to the chips they are even.
  static Teeth teeth_in_model(const Teeth& teeth, bool rigid) {
    return !rigid && teeth.evenly_spaced() ? teeth.without_run_out() : teeth;
  }

  void keep_last_rows(const DeflectionTable& deflections) {
    const std::size_t most = rigid_ ? 1 : BendBefore::kRows, kept = std::min(most, deflections.stamps);
    const auto count = static_cast<std::ptrdiff_t>(deflections.stamps);
    const std::size_t old = std::min(last_rows_.size(), (most - kept) * deflections.row_size());
    last_rows_.erase(last_rows_.begin(), last_rows_.end() - static_cast<std::ptrdiff_t>(old));
    const float* from = deflections.row(count - static_cast<std::ptrdiff_t>(kept));
    last_rows_.insert(last_rows_.end(), from, from + kept * deflections.row_size());
    for (std::ptrdiff_t k = 0; k < count && !rigid_; ++k)
      largest_bend_mm_ = std::max(largest_bend_mm_, deflections.largest_mm(k));
  }

  DeflectionTable without_run_out(const DeflectionTable& rows, std::size_t from) const {
    DeflectionTable out = rows;
    for (std::size_t k = 0; k < out.stamps; ++k)
      run_out_.add(from + k, -1, out.nodes(), {out.row(static_cast<std::ptrdiff_t>(k)), out.row_size()});
    return out;
  }

  /// True where the motion is another one from k - 1 to k, or from k to k + 1.
  static bool motion_changes(std::span<const Stamp> stamps, std::size_t k) {
    constexpr double kMotionChange = 0.1;  ///< of the feed per tooth
    const auto changes = [&](std::size_t i) {
      const Vec3& now = stamps[i].feed_per_tooth_mm;
      return stamps[i].first || (now - stamps[i - 1].feed_per_tooth_mm).norm() > kMotionChange * now.norm();
    };
    return k == 0 || k + 1 == stamps.size() || changes(k) || changes(k + 1);
  }

  /// The deflections of stamp k as those of a and b, a < k < b, predict them.
  static void mix_rows(DeflectionTable& deflections, std::size_t a, std::size_t k, std::size_t b) {
    const auto way = static_cast<float>(k - a) / static_cast<float>(b - a);
    const float *from = deflections.row(static_cast<std::ptrdiff_t>(a)),
                *to = deflections.row(static_cast<std::ptrdiff_t>(b));
    float* row = deflections.row(static_cast<std::ptrdiff_t>(k));
    for (std::size_t i = 0; i < deflections.row_size(); ++i) row[i] = from[i] + way * (to[i] - from[i]);
  }

  /// True where deflections, chip and mean force of stamp k differ little from the line between a and b: deflections by
  /// no more than what static coupling allows of an extrapolated one, over the rotation steps that cut.
  bool on_line(const DeflectionTable& deflections, std::span<const StampLoad> loads, std::size_t a, std::size_t k,
               std::size_t b) const {
    const deflection::SettleOptions allowed;
    const double way = static_cast<double>(k - a) / static_cast<double>(b - a);
    const StampLoad line = simulate::between(loads[a], loads[b], way);
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

  /// Deflection straight from the chips.
  void engage(std::span<const Stamp> all, std::size_t from, DeflectionTable& deflections, std::vector<StampLoad>& loads,
              std::int32_t first_id, CutResult& result) {
    if (!engager_)
      engager_.emplace(stock_, *blank_, envelope_, all, first_id, tooth_marks_ ? envelope_.flutes : 1, options_.known);
    const auto& blocks = engager_->blocks();
    std::map<std::size_t, std::vector<removal::ChipSample>> turn;  // what the turn needs
    std::mutex turn_lock;
    tbb::enumerable_thread_specific<ToothPass> passes;
    std::atomic<std::size_t> read{0};
    const std::size_t before = result.loads_at_ratio.size();
    if (options_.chip_ratio > 0) result.loads_at_ratio.resize(before + loads.size());
    const std::span<StampLoad> at_other_chip = std::span(result.loads_at_ratio).subspan(before);
    const removal::ChipSink load_of = [&](std::size_t k, std::span<const removal::ChipBlock> chips) {
      cancellation_point();
      ToothPass& pass = passes.local();
      std::span<float> row(deflections.row(static_cast<std::ptrdiff_t>(k)),
                           options_.drilling ? 0 : deflections.row_size());
      model_.evaluate(blocks, chips, from + k, removal::motion_in_tool(all, from + k), pass, row);
      loads[k] = summarize(pass, all[from + k].pose);
      loads[k].chip_mm3 = removal::chip_volume_mm3(envelope_, blocks, chips);
      loads[k].arc = deflection::chip_arc(envelope_, blocks, chips);
      if (!at_other_chip.empty()) at_other_chip[k] = at_ratio(blocks, chips, all, from + k, pass);
      ++read;
      if (!in_turn(from + k)) return;
      const std::scoped_lock lock(turn_lock);
      turn[k] = removal::chips_of(blocks, chips);
    };
    if (options_.drilling || tooth_marks_ || options_.longest_gap <= 1) {
      engager_->engage(from, loads.size(), load_of);
    } else {
      const std::span<const Stamp> stamps = all.subspan(from, loads.size());
      engager_->engage(
          from, loads.size(),
          {.read = load_of,
           .must_read = [&](std::size_t k) { return in_turn(from + k) || motion_changes(stamps, k); },
           .on_line = [&](std::size_t a, std::size_t k, std::size_t b) { return on_line(deflections, loads, a, k, b); },
           .between =
               [&](std::size_t a, std::size_t k, std::size_t b) {
                 const double way = static_cast<double>(k - a) / static_cast<double>(b - a);
                 loads[k] = simulate::between(loads[a], loads[b], way);
                 if (!at_other_chip.empty())
                   at_other_chip[k] = simulate::between(at_other_chip[a], at_other_chip[b], way);
                 mix_rows(deflections, a, k, b);
               }});
    }
    result.read += read;
    for (const auto& [k, chips] : turn) keep_turn(chips, all, from + k, result);
  }

  /// The loads for chips of options_.chip_ratio to their thickness.
  StampLoad at_ratio(const removal::EnvelopeBlocks& blocks, std::span<const removal::ChipBlock> chips,
                     std::span<const Stamp> all, std::size_t passing, ToothPass& pass) const {
    const removal::ToothMotion motion = removal::motion_in_tool(all, passing);
    thread_local std::vector<removal::ChipBlock> scaled;
    scaled.assign(chips.begin(), chips.end());
    const auto ratio = static_cast<float>(options_.chip_ratio);
    for (removal::ChipBlock& block : scaled)
      for (float& h : block.thickness_mm)
        if (h > 0) h *= ratio;
    const double share = options_.chip_ratio;
    model_.evaluate(blocks, scaled, passing, {share * motion.tip_mm, share * motion.turn_rad}, pass, {});
    return summarize(pass, all[passing].pose);
  }

  /// The largest deflection that the fields and the beam describe at a stamp: the narrow band holds it with the chip,
  /// the deflected cutter is looked for within kMaxDeflection_mm, and a beam bends little against its thickness.
  double deflection_limit_mm(const Stamp& stamp) const {
    constexpr double kOfDiameter = 0.1, kAtLimit = 0.98;
    // Right after a rapid the motion is the rapid's, and no chip.
    const double chip = stamp.first ? 0 : stamp.feed_per_tooth_mm.norm();
    const double band = std::max(stock_.band_mm() / 4, stock_.band_mm() - chip);
    const double deflected = kAtLimit * removal::DeflectedEngager::kMaxDeflection_mm;
    return std::min({band, deflected, kOfDiameter * diameter_mm_});
  }

  void watch_range(std::span<const Stamp> stamps, const DeflectionTable& deflections, std::span<StampLoad> loads,
                   CutResult& result) const {
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      const double deflection = tip_deflection_mm(deflections, deflections.row(static_cast<std::ptrdiff_t>(k))),
                   limit = deflection_limit_mm(stamps[k]);
      loads[k].deflection_max_mm = deflection;
      result.deflection_max_mm = std::max(result.deflection_max_mm, deflection);
      if (deflection <= limit) continue;
      result.deflection_limit_mm = result.beyond_stamps.empty() ? limit : std::min(result.deflection_limit_mm, limit);
      result.beyond_stamps.push_back(static_cast<std::uint32_t>(result.loads.size() + k));
    }
  }

  static void tell_contacts(const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
                            const DeflectionTable& deflections, std::span<const Contact> contacts,
                            std::span<StampLoad> loads) {
    for (std::size_t k = 0; k < contacts.size(); ++k)
      loads[k].contact_deflection_mm = direction_in_part(
          stamps[k].pose,
          deflection_at(envelope, deflections, deflections.row(static_cast<std::ptrdiff_t>(k)), contacts[k]));
  }

  /// Marks and contacts of teeth that are not even, after `passings` tooth passings. Rows are as many times as long as
  /// there are teeth, and as many times fewer at once.
  void leave_uneven(std::span<const Stamp> stamps, std::size_t passings, const DeflectionTable& deflections,
                    std::span<const Contact> contacts, std::int32_t first_id, std::span<StampLoad> loads) const {
    for_uneven(stamps.size(), deflections, passings, [&](std::size_t from, std::size_t count, DeflectionTable& own) {
      if (!contacts.empty())
        tell_contacts(tooth_marks_->envelope(), stamps.subspan(from, count), own, contacts.subspan(from, count),
                      loads.subspan(from, count));
      if (!options_.surface) return;
      tooth_marks_->add_run_out(own, passings + from);
      options_.surface->mark(tooth_marks_->envelope(), stamps.subspan(from, count), own,
                             first_id + static_cast<std::int32_t>(from));
    });
  }

  /// Calls f(from, count, deflections of each tooth) for parts of a stretch of teeth that are not even.
  template <class Function>
  void for_uneven(std::size_t stamps, const DeflectionTable& deflections, std::size_t passings, Function f) const {
    const std::size_t part = stamps / static_cast<std::size_t>(envelope_.flutes) + 1;
    for (std::size_t from = 0; from < stamps; from += part) {
      const std::size_t count = std::min(part, stamps - from);
      DeflectionTable own = tooth_marks_->bending(deflections, from, count, passings + from);
      f(from, count, own);
    }
  }

  /// The marks as the same cut would leave them on a part that does not yield.
  void mark_tool_alone(std::span<const Stamp> stamps, std::size_t passings, const DeflectionTable& deflections,
                       std::int32_t first_id) const {
    const DeflectionTable tool = deflections.parts ? deflections.of_tool_alone() : deflections;
    if (!tooth_marks_) return mark(*options_.tool_surface, stamps, tool, first_id);
    for_uneven(stamps.size(), tool, passings, [&](std::size_t from, std::size_t count, DeflectionTable& own) {
      tooth_marks_->add_run_out(own, passings + from);
      options_.tool_surface->mark(tooth_marks_->envelope(), stamps.subspan(from, count), own,
                                  first_id + static_cast<std::int32_t>(from));
    });
  }

  /// Of a hole its deepest stamp says all.
  void mark(removal::SurfaceMap& surface, std::span<const Stamp> stamps, const DeflectionTable& deflections,
            std::int32_t first_id) const {
    if (!options_.drilling) return surface.mark(envelope_, stamps, deflections, first_id);
    const DeflectionTable straight(1, model_.steps(), model_.node_height_mm());
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      const bool deeper = k + 1 < stamps.size() &&
                          stamps[k + 1].pose.tip_mm.head<2>() == stamps[k].pose.tip_mm.head<2>() &&
                          stamps[k + 1].move >= stamps[k].move;
      if (!deeper) surface.mark(envelope_, stamps.subspan(k, 1), straight, first_id + static_cast<std::int32_t>(k));
    }
  }

  void settle(std::span<const Stamp> all, std::size_t from, DeflectionTable& deflections, std::vector<StampLoad>& loads,
              std::int32_t first_id, CutResult& result) {
    if (!static_cut_) {
      static_cut_.emplace(stock_, *blank_, envelope_, model_, all, first_id, settle_options(), run_out_,
                          different_teeth_, options_.known);
      static_cut_->remember(from, last_rows_, deflections.row_size(), largest_bend_mm_);
    }
    // Loads between two readings lie between theirs; each stretch of passings ends with readings.
    static_cut_->start(from, loads.size(), deflections, [this, from, count = loads.size()](std::size_t k) {
      return in_turn(from + k) || k + different_teeth_ >= count;
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
      behind.wait();
      behind.run([this, &loads, &pass, &deflections, &result, all, chips = passing.chips, from, k] {
        model_.evaluate(chips, from + k, removal::motion_in_tool(all, from + k), pass);
        loads[k] = summarize(pass, all[from + k].pose);
        loads[k].chip_mm3 = removal::swept_chip_volume_mm3(envelope_, chips, deflections,
                                                           deflections.row(static_cast<std::ptrdiff_t>(k)));
        loads[k].arc = deflection::chip_arc(envelope_, chips);
        keep_turn(chips, all, from + k, result);
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
      if (!passing.settled && ++unsettled_readings_ >= options_.give_up_after &&
          static_cast<double>(unsettled_readings_) > NoRest::kHopeless * static_cast<double>(result.read)) {
        behind.wait();
        throw NoRest{unsettled_readings_, result.read, result.unsettled_moves.front(),
                     result.unsettled_reasons.front()};
      }
    }
    behind.wait();
    fill_between(read, result.loads, loads);
    result.extrapolation = static_cut_->extrapolation_errors();
  }

  /// Loads of the passings that were not read, from the nearest of the same tooth that were. `before`: of the stretches
  /// before, which end with readings.
  void fill_between(std::span<const char> read, std::span<const StampLoad> before, std::span<StampLoad> loads) const {
    const auto period = static_cast<std::ptrdiff_t>(different_teeth_),
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

  deflection::SettleOptions settle_options() const {
    deflection::SettleOptions out{options_.max_rounds, options_.settle_um, options_.settle_fraction};
    out.longest_gap = options_.longest_gap;
    return out;
  }

  bool in_turn(std::size_t k) const {
    return options_.turn_from && k >= *options_.turn_from &&
           k < *options_.turn_from + static_cast<std::size_t>(envelope_.flutes);
  }
  void keep_turn(std::span<const removal::ChipSample> chips, std::span<const Stamp> all, std::size_t k,
                 CutResult& result) const {
    if (in_turn(k)) model_.add_to_turn(chips, k - *options_.turn_from, k, removal::motion_in_tool(all, k), result.turn);
  }

  Stock& stock_;
  std::optional<Stock> own_blank_;
  const Stock* blank_ = nullptr;  ///< before the first stamp
  const CutOptions& options_;
  bool rigid_;
  double diameter_mm_, edges_end_mm_;
  double top_mm_;
  EnvelopeGrid envelope_;
  ToothPassModel model_;
  std::optional<ToothMarks> tooth_marks_;         ///< of teeth that are not even
  RunOutOffsets run_out_;                         ///< static: of equally spaced teeth
  std::size_t different_teeth_ = 1;               ///< of which each takes another chip
  std::optional<removal::RigidEngager> engager_;  ///< rigid
  std::optional<StaticCut> static_cut_;
  bool settled_ = true;  ///< the last tooth passing
  std::size_t unsettled_readings_ = 0;
  DeflectionTable deflections_;   ///< of the stretch
  std::vector<float> last_rows_;  ///< of the deflection tables before, BendBefore::kRows at most
  double largest_bend_mm_ = 0;    ///< so far
};

}  // namespace

CutResult cut(Stock& stock, const machine::Tool& tool, const machine::Material& material, std::span<const Stamp> stamps,
              std::span<const Contact> contacts, std::int32_t first_id, const CutOptions& options) {
  return cut_range(stock, tool, material, stamps, 0, stamps.size(), contacts, first_id, options);
}

CutResult cut_range(Stock& stock, const machine::Tool& tool, const machine::Material& material,
                    std::span<const Stamp> stamps, std::size_t first, std::size_t count,
                    std::span<const Contact> contacts, std::int32_t first_id, const CutOptions& options,
                    const BendBefore* before) {
  CutResult result;
  result.loads.reserve(count);
  Cutter cutter(stock, tool, material, stamps, options);
  if (before) cutter.begin_after(*before);
  // Which stamps are read depends on where stretches begin: in rigid coupling they are the pieces of sections.
  const bool rigid = options.coupling == machine::Coupling::rigid;
  const std::size_t most = rigid ? std::min(options.rigid_stretch_stamps, kPieceStamps) : options.stretch_stamps,
                    stretches = (count + most - 1) / most;
  for (std::size_t i = 0; i < stretches; ++i) {
    cancellation_point();
    const std::size_t done = rigid ? count * i / stretches : most * i,
                      n = (rigid ? count * (i + 1) / stretches : std::min(most * (i + 1), count)) - done;
    cutter.cut(stamps, first + done, n, contacts.empty() ? contacts : contacts.subspan(done, n), first_id, result);
    if (options.progress) options.progress(static_cast<double>(done + n) / static_cast<double>(count));
  }
  cutter.finish(result);
  return result;
}

double sweep(Stock& stock, const machine::Tool& tool, std::span<const Stamp> stamps, std::int32_t first_id,
             double shrink_mm) {
  return removal::sweep(stock, removal::shape_of(tool), stamps, {.shrink_mm = shrink_mm, .first_id = first_id});
}

std::vector<Contact> find_contacts(const Stock& target, const machine::Tool& tool, std::span<const Stamp> stamps) {
  const removal::CutterShape shape = removal::shape_of(tool);
  const double top = std::max(shape.corner_radius_mm, target.voxel_mm());
  const double length = shape.profile.length_to_height_mm(top);
  constexpr int kRings = 100;
  constexpr double kDepthBand_mm = 0.001, kOut = -1e9;
  struct Ring {
    double radius, height;
    double slope;  ///< tangent of the normal's angle; 0: the normal points down
  };
  std::array<Ring, kRings> rings;
  for (int r = 0; r < kRings; ++r) {
    const auto p = shape.profile.at((r + 0.5) * length / kRings);
    rings[static_cast<std::size_t>(r)] = {p.radius_mm, p.height_mm,
                                          p.normal_angle_rad > 0 ? std::tan(p.normal_angle_rad) : 0.0};
  }
  struct Candidate {
    double depth;
    Vec3 place;
  };
  std::vector<Contact> out(stamps.size());
  struct Buffers {
    Stock::Probe probe;
    std::vector<Candidate> candidates;
  };
  tbb::enumerable_thread_specific<Buffers> buffers([&] { return Buffers{Stock::Probe(target), {}}; });
  tbb::parallel_for(std::size_t{0}, stamps.size(), [&](std::size_t k) {
    cancellation_point();
    const removal::ToothMotion motion = removal::motion_in_tool(stamps, k);
    const Mat3 frame = tool_frame(stamps[k].pose);
    auto& [probe, candidates] = buffers.local();  // depth: of the nearest voxel
    candidates.clear();
    for (const Ring& ring : rings) {
      const Vec3 f = motion.at({0, 0, ring.height});
      const double horizontal = f.head<2>().norm();
      const Vec2 along = horizontal > 0 ? Vec2(f.head<2>() / horizontal) : Vec2::UnitX(), aside(-along.y(), along.x());
      // The cosine of the angle from the motion at which the normal stands across it.
      const double cosine = ring.slope == 0 ? 0.0 : horizontal > 0 ? f.z() / (horizontal * ring.slope) : 2.0;
      if (std::abs(cosine) > 1) continue;
      const Vec2 ahead = ring.radius * cosine * along, beside = ring.radius * std::sqrt(1 - cosine * cosine) * aside;
      for (const double side : {-1.0, 1.0}) {
        const Vec2 flat = ahead + side * beside;
        candidates.push_back({0, Vec3(flat.x(), flat.y(), ring.height)});
      }
    }
    const auto nearest = [&](const Candidate& c) {
      return -static_cast<double>(probe.nearest(stamps[k].pose.tip_mm + frame * c.place));
    };
    const auto trilinear = [&](const Candidate& c) {
      return -probe.distance_mm(stamps[k].pose.tip_mm + frame * c.place);
    };
    // A trilinear value differs from the nearest voxel's by no more than the mean distance of its corners from it, and
    // voxels from each other by no more than they are apart.
    const double blur = std::sqrt(1.5) * target.voxel_mm(), apart = std::sqrt(3.0) * target.voxel_mm();
    // A few of each side first: where they are far from the deepest, those around are as well.
    constexpr std::size_t kSides = 2, kEvery = 4 * kSides;
    std::size_t top = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      if (c % kEvery >= kSides) continue;
      candidates[c].depth = nearest(candidates[c]);
      if (candidates[c].depth > candidates[top].depth) top = c;
    }
    const double known = candidates.empty() ? kOut : trilinear(candidates[top]);
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      if (c % kEvery < kSides) continue;
      const Candidate& before = candidates[c / kEvery * kEvery + c % kSides];
      const double most = before.depth + (candidates[c].place - before.place).norm() + apart;
      candidates[c].depth = most + blur < known - kDepthBand_mm ? kOut : nearest(candidates[c]);
    }
    double deepest = kOut;
    const auto read = [&](Candidate& c) {
      c.depth = trilinear(c);
      deepest = std::max(deepest, c.depth);
    };
    const auto first = std::ranges::max_element(candidates, {}, &Candidate::depth);
    if (first != candidates.end()) std::swap(*first, candidates.front()), read(candidates.front());
    for (std::size_t c = 1; c < candidates.size(); ++c) {
      if (candidates[c].depth + blur >= deepest - kDepthBand_mm)
        read(candidates[c]);
      else
        candidates[c].depth = kOut;
    }
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for (const auto& c : candidates)
      if (c.depth >= deepest - kDepthBand_mm) {
        sum += c.place;
        ++count;
      }
    if (count > 0) out[k] = {sum.z() / count, std::atan2(sum.y(), sum.x())};
  });
  return out;
}

}  // namespace camber::simulate
