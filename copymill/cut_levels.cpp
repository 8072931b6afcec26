// Level by level: loops at equal distances from the walls, or rows and the outline.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "base/stage.h"
#include "copymill/levels.h"
#include "copymill/operation.h"
#include "copymill/slotting.h"

namespace camber::copymill {
namespace {

constexpr double kMaterial_mm = 0.02;  ///< thinner material above a level is not cut again
constexpr double kMaxGridPoints = 4e6;

/// Fine enough for the smallest way between walls that counts: a twentieth of the tool.
double grid_step_mm(const Workplace& place) {
  const machine::CopyOperation& o = place.cut.operation;
  const Vec2 size = place.region.max_mm() - place.region.min_mm();
  const double fine = std::clamp(std::min(place.cut.shape.radius_mm / 20, o.radial_depth_mm / 3), 0.05, 1.0);
  return std::max(fine, std::sqrt((size.x() + 2) * (size.y() + 2) / kMaxGridPoints));
}

BoxLevels levels_of(const Workplace& place, const SampledTips& tips) {
  const machine::CopyOperation& o = place.cut.operation;
  const Vec2 reach = Vec2::Constant(place.cut.shape.radius_mm);
  double top = place.standing.highest_mm(place.region.min_mm() - reach, place.region.max_mm() + reach);
  double bottom = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < tips.lowest_mm.size(); ++k)
    if (tips.in_region[k]) bottom = std::min(bottom, tips.lowest_mm[k]);
  bottom = std::max(bottom, place.stock_bottom_mm);
  if (o.region.z_mm) bottom = std::max(bottom, (*o.region.z_mm)[0]), top = std::min(top, (*o.region.z_mm)[1]);
  const double least_mm2 = place.cut.shape.radius_mm * place.cut.shape.radius_mm;
  std::vector<double> floors = level_floors(place.part, place.region, least_mm2);
  if (place.region.depends_on_level()) return box_levels(top, bottom, std::move(floors), place.region, o.allowance_mm);
  for (double& f : floors) f += o.allowance_mm;
  return {Levels(top, bottom, std::move(floors)), {}};
}

/// Loops of a component from the inside out where walls bound it; from the outside in where nothing does.
std::vector<double> loop_distances(const LevelRegion& region, int component, double radial_mm) {
  std::vector<double> out;
  const double depth = region.depth_mm(component);
  const double innermost = depth - std::min(0.5 * radial_mm, 0.25 * depth);
  const int n = std::max(0, static_cast<int>(std::ceil(innermost / radial_mm - 1e-6)));
  for (int k = n; k >= 0; --k) out.push_back(n > 0 ? innermost * k / n : 0);
  if (!region.walled()) std::ranges::reverse(out);
  return out;
}

/// Returns whether material that is not the part stands in the region, looked at on a coarse grid.
bool stands_over_part(const Workplace& place, double bottom_mm) {
  constexpr int kAcross = 100;
  constexpr double kNeedle_mm = 0.01, kStands_mm = 0.05;
  const TipField needle(place.part, {kNeedle_mm, 0, false, {}}, 0);
  for (int j = 0; j <= kAcross; ++j)
    for (int i = 0; i <= kAcross; ++i) {
      const Vec2 size = place.region.max_mm() - place.region.min_mm();
      const Vec2 p = place.region.min_mm() + Vec2(size.x() * i / kAcross, size.y() * j / kAcross);
      if (place.region.contains(p) &&
          place.standing.at(p) > std::max(needle.lowest_mm(p), bottom_mm) + place.field.allowance_mm() + kStands_mm)
        return true;
    }
  return false;
}

class LevelCutter {
 public:
  LevelCutter(const Workplace& place, Approach& approach)
      : place_(place), approach_(approach), slotting_(place, approach) {}

  Runner::Ended cut(const LevelRegion& region) {
    if (walls_.empty()) approach_.forget();
    for (int c = 0; c < region.components(); ++c) {
      const bool loops = place_.cut.operation.mode == machine::CopyMode::contour_line;
      const Runner::Ended ended = loops ? cut_loops(region, c) : cut_rows(region, c);
      if (ended != Runner::Ended::done) return ended;
    }
    return Runner::Ended::done;
  }

 private:
  Runner::Ended cut_loops(const LevelRegion& region, int component) {
    const double radial = place_.runner.radial_mm();
    if (!slotting_.wanted()) return cut_in_order(region, component, loop_distances(region, component, radial));
    // As far inside as loops can be had from the grid.
    double before = 0.97 * region.depth_mm(component);
    for (const double d : loop_distances(region, component, radial)) {
      if (region.walled() && clear_slots(region, component, before, d) != Runner::Ended::done)
        return place_.runner.ended();
      if (cut_at(region, component, d) != Runner::Ended::done) return place_.runner.ended();
      before = d;
    }
    return Runner::Ended::done;
  }

  /// Cuts loops from boss to boss and corner to corner, not from distance to distance.
  Runner::Ended cut_in_order(const LevelRegion& region, int component, const std::vector<double>& distances) {
    LoopOrder order;
    // Along walls as asked for; "both" turns what lies farther inside.
    const bool turns = place_.cut.operation.sense == machine::MillingSense::both;
    for (std::size_t k = 0; k < distances.size(); ++k)
      order.add(passes_at(region, component, distances[k]),
                k > 0 ? std::abs(distances[k] - distances[k - 1]) : place_.runner.radial_mm(),
                turns && distances[k] > 0);
    while (const std::optional<Pass> pass = order.next(place_.runner.at()))
      if (approach_.follow(*pass) != Runner::Ended::done) return place_.runner.ended();
    return Runner::Ended::done;
  }

  /// Trochoids where the region is so narrow that the loop at a distance, or one between it and the loop before, would
  /// be a full cut; around the loops farthest from the walls, where the largest circles fit.
  Runner::Ended clear_slots(const LevelRegion& region, int component, double before, double distance) {
    if (!slotting_.wanted()) return Runner::Ended::done;
    constexpr int kBetween = 4;
    for (int k = kBetween; k >= 0; --k) {
      const double d = distance + (before - distance) * k / kBetween;
      if (k > 0 && d < slotting_.smallest_mm()) continue;
      std::vector<Pass> passes = passes_at(region, component, d);
      for (Pass& pass : passes) {
        if (place_.runner.at()) start_near(pass, *place_.runner.at());
        if (slotting_.clear(pass, k == 0) != Runner::Ended::done) return place_.runner.ended();
      }
    }
    return Runner::Ended::done;
  }

  /// The loops at one distance, the nearest first.
  Runner::Ended cut_at(const LevelRegion& region, int component, double distance) {
    return cut_nearest_first(passes_at(region, component, distance), false);
  }

  std::vector<Pass> passes_at(const LevelRegion& region, int component, double distance) const {
    std::vector<Pass> passes;
    const bool climb = place_.cut.operation.sense != machine::MillingSense::conventional;
    for (FlatPass& loop : region.loops(distance)) {
      if (region.component_of(loop.points.front()) != component) continue;
      // The region is on a loop's left; climb milling has what is still to be cut on its right.
      const bool turn = region.walled() != climb;
      passes.push_back(at_height(turn ? reversed(std::move(loop)) : std::move(loop), region.z_mm()));
    }
    return passes;
  }

  Runner::Ended cut_nearest_first(std::vector<Pass> passes, bool may_turn) {
    while (!passes.empty()) {
      std::size_t best = 0;
      bool turned = false;
      double nearest = std::numeric_limits<double>::infinity();
      const Vec3 here = place_.runner.at().value_or(passes.front().points.front());
      for (std::size_t k = 0; k < passes.size(); ++k) {
        Pass& p = passes[k];
        start_near(p, here);
        const double front = (p.points.front() - here).norm(), back = (p.points.back() - here).norm();
        if (front < nearest) nearest = front, best = k, turned = false;
        if (may_turn && !p.closed && back < nearest) nearest = back, best = k, turned = true;
      }
      Pass pass = std::move(passes[best]);
      passes.erase(passes.begin() + static_cast<std::ptrdiff_t>(best));
      if (approach_.follow(turned ? reversed(std::move(pass)) : pass) != Runner::Ended::done)
        return place_.runner.ended();
    }
    return Runner::Ended::done;
  }

  /// Rows across a component, to and fro or one way, then its outline, which takes what the rows' ends leave.
  Runner::Ended cut_rows(const LevelRegion& region, int component) {
    const machine::CopyOperation& o = place_.cut.operation;
    const Vec2 along(std::cos(o.angle_rad), std::sin(o.angle_rad)), across(-along.y(), along.x());
    double u0 = 1e300, u1 = -1e300, v0 = 1e300, v1 = -1e300;
    for (const Outline& loop : region.outline())
      for (const Vec2& p : loop) {
        if (region.component_of(p) != component) continue;
        u0 = std::min(u0, p.dot(along)), u1 = std::max(u1, p.dot(along));
        v0 = std::min(v0, p.dot(across)), v1 = std::max(v1, p.dot(across));
      }
    if (u1 < u0) return Runner::Ended::done;
    if (region.walled())
      for (const Pass& wall : passes_at(region, component, 0))
        for (Pass& piece : approach_.in_material(wall)) walls_.push_back(std::move(piece));
    constexpr double kInside_mm = 0.001;  // rows on the outline itself are the outline's
    const int n =
        std::max(1, static_cast<int>(std::ceil((v1 - v0 - 2 * kInside_mm) / place_.runner.radial_mm() - 1e-6)));
    for (int k = 0; k <= n; ++k) {
      const double v = v0 + kInside_mm + (v1 - v0 - 2 * kInside_mm) * k / n;
      const auto row_at = [&](double at) {
        std::vector<FlatPass> row = region.stretches(u0 * along + at * across, u1 * along + at * across);
        std::erase_if(row, [&](const FlatPass& s) { return region.component_of(s.points.front()) != component; });
        // Up milling goes along, as what is still to be cut is on the left.
        std::vector<Pass> passes;
        for (FlatPass& s : row)
          passes.push_back(at_height(o.sense == machine::MillingSense::climb ? reversed(std::move(s)) : std::move(s),
                                     region.z_mm()));
        return passes;
      };
      std::vector<Pass> passes = row_at(v);
      if (slotting_.wanted() && std::ranges::any_of(passes, [&](const Pass& p) { return slotting_.full_width(p); })) {
        // Circles as large as they may be, from the row on.
        for (const Pass& pass : row_at(v + std::min(slotting_.largest_mm(), 0.5 * (v1 - v))))
          if (slotting_.clear(pass, false) != Runner::Ended::done) return place_.runner.ended();
        for (const Pass& pass : passes)
          if (slotting_.clear(pass, true) != Runner::Ended::done) return place_.runner.ended();
      }
      if (cut_nearest_first(std::move(passes), o.sense == machine::MillingSense::both) != Runner::Ended::done)
        return place_.runner.ended();
    }
    return finish_walls(region.z_mm());
  }

  /// Cuts the levels down to a height; lower ones wait where passes have been planned anew above them.
  Runner::Ended finish_walls(double z) {
    std::vector<Pass> now;
    const auto waits = std::ranges::partition(walls_, [&](const Pass& p) { return p.points.front().z() < z; });
    std::ranges::move(waits, std::back_inserter(now));
    walls_.erase(waits.begin(), waits.end());
    while (!now.empty()) {
      const Vec3 here = place_.runner.at().value_or(now.front().points.front());
      for (Pass& p : now) start_near(p, here);
      const auto nearest =
          std::ranges::min_element(now, {}, [&](const Pass& p) { return (p.points.front() - here).norm(); });
      const Pass pass = std::move(*nearest);
      now.erase(nearest);
      if (approach_.finish(pass) == Runner::Ended::done) continue;
      walls_.push_back(pass);
      std::ranges::move(now, std::back_inserter(walls_));
      return place_.runner.ended();
    }
    return Runner::Ended::done;
  }

  const Workplace& place_;
  Approach& approach_;
  Slotting slotting_;
  /// Stretches of outlines that had material beside them before the rows of their level. What rows leave along walls
  /// may be narrower than a cell of what is seen to stand, so they are followed all along.
  std::vector<Pass> walls_;
};

}  // namespace

bool cut_levels(const Workplace& place) {
  const machine::CopyOperation& o = place.cut.operation;
  const SampledTips tips(place.field, place.region, grid_step_mm(place));
  const BoxLevels all = levels_of(place, tips);
  const Levels& levels = all.even;
  place.runner.begin(place.cut, place.standing, place.safe_z_mm, &place.depth, levels.bottom_mm());
  Approach approach(place.cut, place.field, place.standing, place.runner,
                    {.more_than_mm = kMaterial_mm,
                     .link_mm = 2.1 * o.radial_depth_mm,
                     .remembers = o.mode == machine::CopyMode::scanning_line});
  LevelCutter cutter(place, approach);
  bool placed = false, any_level = false;
  constexpr double kShares = 1000;  // of the depth, for progress
  Stage stage("copying by levels", static_cast<std::size_t>(kShares));
  double level = 0;
  for (double above = levels.top_mm(); levels.next(above, place.runner.axial_mm(), level);) {
    any_level = true;
    // The level first, then, from the side, what is left on the floors above it.
    Runner::Ended ended = Runner::Ended::done;
    std::vector<double> floors = all.floors_between(above, level);
    floors.push_back(level);
    while (!floors.empty() && ended == Runner::Ended::done) {
      const LevelRegion region(tips, floors.back());
      placed = placed || !region.empty();
      ++place.runner.summary().levels;
      ended = cutter.cut(region);
      floors.pop_back();
    }
    if (ended == Runner::Ended::stopped) return true;
    if (ended == Runner::Ended::replan) {
      // With the axial depth that is now: a level in between, or this one again with other loops or rows.
      place.runner.replanned();
      continue;
    }
    stage.advance(static_cast<std::size_t>(kShares * (above - level) / (levels.top_mm() - levels.bottom_mm())));
    above = level;
  }
  // Nothing was cut: either nothing is left, or the tool fits nowhere.
  const double bottom = o.region.z_mm ? (*o.region.z_mm)[0] : place.stock_bottom_mm;
  return place.runner.summary().passes > 0 || (placed && any_level) || !stands_over_part(place, bottom);
}

}  // namespace camber::copymill
