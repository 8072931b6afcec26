#include "compensate/feed_lever.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "feedmodel/motion_plan.h"

namespace camber::compensate {
namespace {

constexpr std::size_t kNoUnit = static_cast<std::size_t>(-1);
constexpr double kTells_mm = 0.001;  // an error of this size tells how it goes with the feed
constexpr double kMinExponent = 0.15, kMaxExponent = 2.0;

/// Time that the tool takes for the piece that ends at each point.
std::vector<double> times_of(const ShiftPath& path, const simulate::SimulatedProgram& given) {
  std::vector<double> out(path.points().size(), 0.0);
  const auto& stamps = given.path.stamps;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i].first || !path.contains(stamps[i].move)) continue;
    out[path.find(stamps[i].move, stamps[i].fraction).lower + 1] += stamps[i].t_s - stamps[i - 1].t_s;
  }
  return out;
}

constexpr double kNear_mm = 2.0;           // of path: as far as the motion through a corner reaches
constexpr double kLowest = 0.5;            // of the least fraction elsewhere
constexpr double kStopped_mm_per_s = 0.1;  // slower is a stop
constexpr double kNone = std::numeric_limits<double>::infinity();

/// Speed at which the control passes from the move that ends at each point to the next one; infinite elsewhere.
std::vector<double> corner_speeds(const ShiftPath& path, const nc::Interpretation& program,
                                  const machine::Machine& machine) {
  std::vector<double> out(path.points().size(), kNone);
  const feedmodel::MotionPlan plan = feedmodel::plan_motion(program, machine);
  for (std::size_t i = 1; i < plan.rows.size(); ++i) {
    const feedmodel::SegmentTime &before = plan.times[i - 1], &now = plan.times[i];
    if (!before.cutting || !now.cutting || before.rest || now.rest || before.move == now.move) continue;
    const double speed = plan.rows[i].entry_speed_mm_per_s;
    if (speed < kStopped_mm_per_s || !path.contains(before.move)) continue;
    double& at_end = out[path.find(before.move, 1.0).lower + 1];
    at_end = std::min(at_end, speed);
  }
  return out;
}

/// Along a chain, each value becomes the lowest one within kNear_mm.
void spread(const ShiftPath& path, const ShiftChain& chain, std::vector<double>& speeds) {
  const auto& points = path.points();
  const std::vector<double> from(speeds.begin() + static_cast<std::ptrdiff_t>(chain.from),
                                 speeds.begin() + static_cast<std::ptrdiff_t>(chain.from + chain.count));
  for (std::size_t c = 0; c < chain.count; ++c) {
    if (from[c] == kNone) continue;
    const double at = points[chain.from + c].along_mm;
    const auto lower = [&](std::size_t i) { speeds[i] = std::min(speeds[i], from[c]); };
    for (std::size_t i = chain.from + c; i > chain.from && at - points[i].along_mm < kNear_mm; --i) lower(i);
    // A piece behind the corner begins at the point before the one that it ends at.
    for (std::size_t i = chain.from + c + 1; i < chain.from + chain.count && points[i - 1].along_mm - at < kNear_mm;
         ++i)
      lower(i);
  }
}

}  // namespace

void check_feeds(const simulate::SimulatedProgram& program, const std::vector<bool>& selected,
                 Diagnostics& diagnostics) {
  constexpr double kOther = 0.5;
  std::vector<nc::MoveEdit> edits;
  for (std::uint32_t m = 0; m < selected.size(); ++m)
    if (selected[m] && program.moves_in_part().moves[m].editable)
      edits.push_back({.move = m, .feed_mm_per_s = kOther * program.moves_in_part().moves[m].feed_mm_per_s});
  const nc::Emission emission = nc::emit_edits(program.text(), program.moves_in_program(), edits, {});
  if (edits.empty() || emission.not_made.size() < edits.size()) return;
  const nc::EditNotMade& first = emission.not_made.front();
  diagnostics.add({Severity::error,
                   {program.text().source.name(), program.moves_in_part().moves[first.move].block + 1, 1},
                   fmt::format("levers names \"feed\", but the feed of the moves to compensate cannot be changed: {}; "
                               "levers = [\"shift\"] was expected",
                               nc::to_string(first.why)),
                   "lever-unusable",
                   {}});
}

FeedLever::FeedLever(const ShiftPath& path, const simulate::SimulatedProgram& given, bool splittable,
                     std::span<const double> least)
    : unit_of_(path.points().size(), kNoUnit) {
  const auto& points = path.points();
  const std::vector<double> times = times_of(path, given);
  for (std::size_t c = 0; c < path.chains().size(); ++c) {
    const ShiftChain& chain = path.chains()[c];
    for (std::size_t i = chain.from + 1; i < chain.from + chain.count; ++i) {
      const nc::Move& move = given.moves_in_part().moves[points[i].move];
      const bool whole = !splittable || move.kind == nc::MoveKind::arc;
      const bool same_move = i > chain.from + 1 && points[i - 1].move == points[i].move;
      if (!whole || !same_move) units_.push_back({.chain = c, .feed_mm_per_s = move.feed_mm_per_s});
      units_.back().length_mm += points[i].along_mm - points[i - 1].along_mm;
      units_.back().time_s += times[i];
      units_.back().least = std::min(units_.back().least, least[i]);
      unit_of_[i] = units_.size() - 1;
    }
  }
  // A piece that no tooth passing fell into takes the time of its feed.
  for (FeedUnit& u : units_) u.time_s = std::max(u.time_s, u.length_mm / u.feed_mm_per_s);
}

FeedChoice FeedLever::choose(ShiftPath& path, std::span<const Observation> observations,
                             std::span<const double> left_mm, double budget_s, double wanted_mm) {
  std::vector<double> now(units_.size(), 1.0);
  for (std::size_t i = 0; i < unit_of_.size(); ++i)
    if (unit_of_[i] != kNoUnit) now[unit_of_[i]] = path.points()[i].feed_fraction;
  std::vector<SpeedPoint> points;
  for (std::size_t i = 0; i < observations.size(); ++i)
    points.push_back({unit_of_[observations[i].place.lower + 1], std::abs(left_mm[i]), observations[i].area_mm2});
  FeedChoice out = choose_feeds(units_, points, now, model_, budget_s, wanted_mm);
  for (std::size_t i = 0; i < unit_of_.size(); ++i)
    if (unit_of_[i] != kNoUnit) path.points()[i].feed_fraction = out.fraction[unit_of_[i]];
  return out;
}

void FeedLever::apply_to(std::vector<Observation>& observations, const ShiftPath& path,
                         std::span<const double> before) const {
  for (Observation& o : observations) {
    const std::size_t end = o.place.lower + 1;
    const double ratio = path.points()[end].feed_fraction / before[end];
    if (ratio == 1) continue;
    const double shifted = o.normal.dot(path.shift_at(o.place));
    o.error_mm = shifted + std::pow(ratio, model_.exponent) * (o.error_mm - shifted);
  }
}

void FeedLever::learn(const ShiftPath& path, std::span<const double> fractions_before,
                      std::span<const Vec3> shifts_before, const Observed& before, const Observed& now,
                      double predicted_s, double found_s) {
  double products = 0, squares = 0;
  for (std::size_t i = 0; i < now.points.size(); ++i) {
    if (!now.compensated[i] || !before.compensated[i]) continue;
    const Observation &a = before.points[i], &b = now.points[i];
    const std::size_t end = b.place.lower + 1;
    const double ratio = path.points()[end].feed_fraction / fractions_before[end];
    if (ratio == 1 || a.place.lower + 1 != end || !a.own || !b.own) continue;
    const double v = a.place.upper_fraction;
    const Vec3 old = (1 - v) * shifts_before[a.place.lower] + v * shifts_before[a.place.lower + 1];
    const double bent = a.error_mm - a.normal.dot(old), bends = b.error_mm - b.normal.dot(path.shift_at(b.place));
    if (std::abs(bent) < kTells_mm || bends / bent < 0.02) continue;
    const double x = std::log(ratio);
    products += b.area_mm2 * x * std::log(bends / bent);
    squares += b.area_mm2 * x * x;
  }
  if (squares > 0) model_.exponent = std::clamp(products / squares, kMinExponent, kMaxExponent);
  if (predicted_s > 0 && found_s > 0)
    model_.time_scale = std::clamp(model_.time_scale * found_s / predicted_s, 0.5, 3.0);
}

std::vector<double> FeedLever::fractions(const ShiftPath& path) {
  std::vector<double> out;
  for (const ControlPoint& p : path.points()) out.push_back(p.feed_fraction);
  return out;
}

void FeedLever::set_fractions(ShiftPath& path, std::span<const double> fractions) {
  for (std::size_t i = 0; i < fractions.size(); ++i) path.points()[i].feed_fraction = fractions[i];
}

std::vector<double> least_feeds(const ShiftPath& path, const nc::Interpretation& program,
                                const machine::Machine& machine, double least) {
  std::vector<double> out = corner_speeds(path, program, machine);
  for (const ShiftChain& chain : path.chains()) spread(path, chain, out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double feed = program.moves[path.points()[i].move].feed_mm_per_s;
    out[i] = feed > 0 ? std::clamp(out[i] / feed, kLowest * least, least) : least;
  }
  return out;
}

}  // namespace camber::compensate
