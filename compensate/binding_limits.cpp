#include "compensate/binding_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "base/units.h"
#include "compensate/fit_shift.h"
#include "compensate/propose.h"
#include "compensate/state.h"

namespace camber::compensate {
namespace {

using simulate::SimulatedProgram;

constexpr double kStretch_mm = 4;  // of the path before and behind the worst place, over which an effect is judged
constexpr double kRunIn_mm = 1.5;  // more of it that is cut before and behind
constexpr double kFew = 0.005;     // of the path's points: a limit that holds back fewer explains no error
constexpr double kLess = 0.95;     // of the 95th percentile with the limit: without it less must be left

double ceil_to(double value, double step) { return std::ceil(value / step - 1e-9) * step; }

std::string place_text(const BindingLimit& limit) {
  const bool depth = limit.key == kOvercutKey || limit.key == kProfileKey;
  std::string out =
      fmt::format("{} point{} of the {}", limit.count, limit.count == 1 ? "" : "s", depth ? "surface" : "path");
  if (limit.line.given == 0) return out;
  fmt::format_to(std::back_inserter(out), ", most in line {}", limit.line.given);
  if (limit.line.emitted > 0 && limit.line.emitted != limit.line.given)
    fmt::format_to(std::back_inserter(out), " ({} as emitted)", limit.line.emitted);
  return out;
}

std::string lines_cut(const LimitEffect& effect) {
  if (effect.first_line == 0) return "";
  if (effect.first_line == effect.last_line) return fmt::format(" of line {}", effect.first_line);
  return fmt::format(" of lines {} to {}", effect.first_line, effect.last_line);
}

/// Points of a version's path, half open: of what is cut alone, and of what is judged of it.
struct Stretch {
  std::size_t from = 0, end = 0, judged_from = 0, judged_end = 0;
};

/// About a point of the path, within its chain.
Stretch stretch_about(const ShiftPath& path, std::size_t point) {
  const auto chain = std::ranges::find_if(
      path.chains(), [&](const ShiftChain& c) { return point >= c.from && point < c.from + c.count; });
  const auto& points = path.points();
  const auto first_within = [&](double mm) {
    std::size_t i = point;
    while (i > chain->from && points[point].along_mm - points[i - 1].along_mm <= mm) --i;
    return i;
  };
  const auto end_within = [&](double mm) {
    std::size_t i = point + 1;
    while (i < chain->from + chain->count && points[i].along_mm - points[point].along_mm <= mm) ++i;
    return i;
  };
  return {first_within(kStretch_mm + kRunIn_mm), end_within(kStretch_mm + kRunIn_mm), first_within(kStretch_mm),
          end_within(kStretch_mm)};
}

/// The first and the last stamp of a stretch, half open.
std::pair<std::size_t, std::size_t> stamps_of(const Version& version, const Emitted& emitted, const Stretch& stretch) {
  const auto& stamps = emitted.program.path.stamps;
  std::size_t from = stamps.size(), end = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const nc::MoveMap::MovePlace place = emitted.map.given(stamps[k].move, stamps[k].fraction);
    if (!version.path.contains(place.move)) continue;
    const std::size_t point = version.path.find(place.move, place.fraction).lower;
    if (point < stretch.from || point >= stretch.end) continue;
    from = std::min(from, k);
    end = k + 1;
  }
  return {from, end};
}

/// Stock that a rigid tool leaves before stamp `from`, about the stamps from there to `end`.
removal::Stock stock_before(const machine::Job& job, const simulate::Target& target, const removal::StampPath& path,
                            std::size_t from, std::size_t end) {
  double reach_mm = 0;  // of two cutters side by side
  const bool upright = removal::all_upright(path.stamps);
  for (const auto& [number, tool] : job.tools)
    reach_mm = std::max(reach_mm, tool.diameter_mm + (upright ? 0 : 2 * tool.overhang_mm));
  Vec3 low = path.stamps[from].pose.tip_mm, high = low;
  for (std::size_t k = from; k < end; ++k) {
    low = low.cwiseMin(path.stamps[k].pose.tip_mm);
    high = high.cwiseMax(path.stamps[k].pose.tip_mm);
  }
  low.array() -= reach_mm;
  high.array() += reach_mm;
  const auto near = [&](std::size_t k) {
    const Vec3& tip = path.stamps[k].pose.tip_mm;
    const int axes = upright ? 2 : 3;
    return k < from && (tip.head(axes).array() >= low.head(axes).array()).all() &&
           (tip.head(axes).array() <= high.head(axes).array()).all();
  };
  removal::Stock out(target.blank);
  simulate::sweep_path(out, job, removal::stamps_where(path, near), 0);
  out.clear_stamps();
  out.share();
  return out;
}

/// 95th percentile of the judged error that an emitted program leaves of a stretch. Nothing where it cuts nothing
/// there.
std::optional<double> p95_of_stretch(const Task& task, const Version& version, const Emitted& emitted,
                                     const Stretch& stretch, const Trial& best) {
  const simulate::Target& whole = *version.source.target;
  const auto [from, end] = stamps_of(version, emitted, stretch);
  if (from >= end) return std::nullopt;
  const machine::Job& job = version.source.job;
  const simulate::Target target{.blank = stock_before(job, whole, emitted.program.path, from, end),
                                .surface = whole.surface,
                                .part = std::nullopt,
                                .holes = whole.holes,
                                .contour_mm = whole.contour_mm,
                                .memory = whole.memory,
                                .region = whole.region,
                                .map = whole.map,
                                .critical_depths = whole.critical_depths};
  SimulatedProgram program = emitted.program;
  program.path = removal::stamps_where(emitted.program.path, [&](std::size_t k) { return k >= from && k < end; });
  simulate::PredictOptions options;
  options.contacts = false;
  const simulate::Prediction found = simulate::predict(job, target, program, options);
  if (found.surface.size() != best.surface.size()) return std::nullopt;
  std::vector<double> error_um, area_mm2;
  for (std::size_t i = 0; i < found.surface.size(); ++i) {
    const Observed& observed = best.observed;
    const std::size_t point = observed.points[i].place.lower;
    if (!observed.judged(i) || !observed.compensated[i] || !found.surface[i].valid) continue;
    if (point < stretch.judged_from || point >= stretch.judged_end) continue;
    error_um.push_back(1000 * judged_mm(found.surface[i], task.job.compensation.reference));
    area_mm2.push_back(found.surface[i].area_mm2);
  }
  if (error_um.empty()) return std::nullopt;
  return p95_of(error_um, area_mm2);
}

/// 1-based lines of a move of a version's program; `emitted`: 0 where it has none.
ProgramLine line_of(const Version& version, const Emitted& emitted, std::uint32_t move) {
  const std::uint32_t block = version.source.program->moves_in_part().moves[move].block;
  const auto& made = emitted.emission.block_of_line;
  const auto line = std::ranges::find(made, block);
  const std::uint32_t given = version.repeated ? version.repeated->text.block_of_line[block] : block;
  return {given + std::size_t{1},
          line == made.end() ? 0 : static_cast<std::size_t>(line - made.begin()) + std::size_t{1}};
}

/// A path with one limit removed, and the points where the limit holds the path.
struct WithoutLimit {
  ShiftPath path;
  std::shared_ptr<const Emitted> emitted{};
  std::vector<std::size_t> held{};
};

/// The best round's path, shifted once more with `options`.
ShiftPath shifted_freely(const Task& task, const State& state, bool keep_stiffness, double max_shift_mm) {
  const Version& version = *state.active;
  ShiftPath path = version.path;
  ThinPath thin(path, version.splits.kept());
  thin.take_shifts(path);
  const std::vector<RowLink> links = row_links(thin.path(), kRowReach_mm);
  const std::vector<double> stiffness =
      keep_stiffness ? thin.greatest_of(version.stiffness) : std::vector<double>(thin.path().points().size(), 1.0);
  const bool own_links = keep_stiffness && version.link_stiffness.size() == links.size();
  FitShiftOptions options = fit_options(
      task, stiffness, links, own_links ? std::span<const double>(version.link_stiffness) : std::span<const double>());
  options.max_shift_mm = max_shift_mm;
  fit_shift(thin.path(), thin.places_of(wanted_of(task, version, state.best.trial->observed, nullptr)), options);
  thin.give_shifts(path);
  return path;
}

/// Adds line and effect at the held point whose shift the limit changes most.
void find_effect(const Task& task, const State& state, const WithoutLimit& without, BindingLimit& limit) {
  const Version& version = *state.active;
  const Emitted& emitted = *state.best.trial->emitted;
  limit.count = without.held.size();
  limit.of_path = static_cast<double>(limit.count) / static_cast<double>(version.path.points().size());
  const auto change_mm = [&](std::size_t i) {
    return (without.path.points()[i].shift_mm - version.path.points()[i].shift_mm).norm();
  };
  const std::size_t worst = *std::ranges::max_element(without.held, {}, change_mm);
  limit.line = line_of(version, emitted, version.path.points()[worst].move);
  if (task.job.workpiece) return;  // its compliance is surveyed along the whole path
  const Stretch stretch = stretch_about(version.path, worst);
  const auto with = p95_of_stretch(task, version, emitted, stretch, *state.best.trial);
  const auto removed = p95_of_stretch(task, version, *without.emitted, stretch, *state.best.trial);
  if (!with || !removed) return;
  const auto given_line = [&](std::size_t point) {
    return line_of(version, emitted, version.path.points()[point].move).given;
  };
  // A point belongs to the move that ends there or behind it.
  const std::size_t first = std::min(stretch.judged_from + 1, stretch.judged_end - 1);
  limit.effect = {*with, *removed, given_line(first), given_line(stretch.judged_end - 1)};
}

std::optional<BindingLimit> shift_limit(const Task& task, const State& state) {
  const Version& version = *state.active;
  const double limit_mm = task.job.compensation.max_shift_mm;
  WithoutLimit without{shifted_freely(task, state, true, std::numeric_limits<double>::infinity())};
  for (std::size_t i = 0; i < without.path.points().size(); ++i)
    if (without.path.points()[i].shift_mm.norm() > limit_mm && !without.path.points()[i].fixed)
      without.held.push_back(i);
  if (without.held.empty()) return std::nullopt;
  BindingLimit out{kMaxShiftKey, limit_mm, ceil_to(without.path.largest_shift_mm(), 0.001)};
  without.emitted = emit(version.source, without.path, version.splits.kept(), version.compensated);
  find_effect(task, state, without, out);
  return out;
}

/// The least bound of angles between blocks that an emitted program keeps: corners have bounds of their own.
double least_bound_rad(const Task& task, const Version& version, const Emitted& emitted) {
  constexpr int kHalvings = 12;
  double low = task.job.compensation.max_angle_growth_rad, high = std::max(low, emitted.quality.angle_growth_rad);
  for (int i = 0; i < kHalvings; ++i) {
    const double bound = (low + high) / 2;
    const PathQuality quality =
        path_quality(version.source.program->moves_in_part(), version.compensated, emitted.program.moves_in_part(),
                     emitted.map, version.source.job.machine.control.block_time_s, bound);
    (quality.over.empty() ? high : low) = bound;
  }
  return high;
}

std::optional<BindingLimit> angle_limit(const Task& task, const State& state) {
  const Version& version = *state.active;
  const double limit_rad = task.job.compensation.max_angle_growth_rad;
  WithoutLimit without{shifted_freely(task, state, false, task.job.compensation.max_shift_mm)};
  without.emitted = emit(version.source, without.path, version.splits.kept(), version.compensated);
  ThinPath thin(without.path, version.splits.kept());
  thin.take_shifts(without.path);
  const std::vector<RowLink> links = row_links(thin.path(), kRowReach_mm);
  const RowTurn turn = row_turn(thin.path(), links, limit_rad);
  const PathQuality& quality = without.emitted->quality;
  const auto hold = [&](std::uint32_t move, double fraction) {
    if (without.path.contains(move)) without.held.push_back(without.path.find(move, fraction).lower + 1);
  };
  for (const auto& place : quality.over) hold(place.move, place.fraction);
  for (const std::size_t link : turn.over) {
    const ControlPoint& point = thin.path().points()[links[link].a];
    hold(point.move, point.fraction);
  }
  std::ranges::sort(without.held);
  without.held.erase(std::ranges::unique(without.held).begin(), without.held.end());
  if (without.held.empty()) return std::nullopt;
  BindingLimit out{
      kAngleGrowthKey, deg_from_rad(limit_rad),
      ceil_to(deg_from_rad(std::max(turn.max_rad, least_bound_rad(task, version, *without.emitted))), 0.1)};
  find_effect(task, state, without, out);
  return out;
}

std::optional<BindingLimit> depth_limit(const Task& task, const State& state) {
  const Round &best = state.rounds[state.best.round], &unguarded = state.rounds[state.free.round];
  if (!best.guard || unguarded.deepest_um <= task.given.depth_limit_um) return std::nullopt;
  const machine::CompensationSettings& asked = task.job.compensation;
  BindingLimit out{.key = asked.profile_um ? kProfileKey : kOvercutKey,
                   .value = task.given.depth_limit_um,
                   .binds_no_more_at = ceil_to(unguarded.deepest_um, 0.1),
                   .own = asked.depth_limit_um().has_value(),
                   .count = state.free.too_deep,
                   .effect = {best.error_um.p95, unguarded.error_um.p95}};
  if (state.free.deepest_stamp < 0) return out;
  const Emitted& emitted = *state.free.emitted;
  const removal::Stamp& stamp = emitted.program.path.stamps[static_cast<std::size_t>(state.free.deepest_stamp)];
  out.line = line_of(*state.active, emitted, emitted.map.given(stamp.move, stamp.fraction).move);
  return out;
}

/// The angles between blocks, or from row to row, have made the path stiffer.
bool was_stiffened(const Version& version) {
  const auto stiff = [](double factor) { return factor > 1; };
  return std::ranges::any_of(version.stiffness, stiff) || std::ranges::any_of(version.link_stiffness, stiff);
}

}  // namespace

bool BindingLimit::larger_helps() const {
  return of_path >= kFew && (!effect.known() || effect.without_um <= kLess * effect.with_um);
}

std::string sentence(const BindingLimit& limit) {
  std::string out = fmt::format("{} = {:.3g}{} binds", limit.key, limit.value, limit.own ? "" : " (default)");
  if (limit.count > 0) out += " at " + place_text(limit);
  fmt::format_to(std::back_inserter(out), "; from {:.3g} on it would not", limit.binds_no_more_at);
  if (limit.effect.known())
    fmt::format_to(std::back_inserter(out), "; without it the 95th percentile{} would be {:.2f} instead of {:.2f} um",
                   lines_cut(limit.effect), limit.effect.without_um, limit.effect.with_um);
  return out;
}

std::vector<BindingLimit> binding_limits(const Task& task, const State& state) {
  std::vector<BindingLimit> out;
  const Round& best = state.rounds[state.best.round];
  const auto add = [&](std::optional<BindingLimit> limit) {
    if (limit) out.push_back(std::move(*limit));
  };
  if (state.best.trial->emitted && best.limited_points > 0) add(shift_limit(task, state));
  if (state.best.trial->emitted && was_stiffened(*state.active)) add(angle_limit(task, state));
  add(depth_limit(task, state));
  return out;
}

}  // namespace camber::compensate
