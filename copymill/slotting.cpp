#include "copymill/slotting.h"

#include <algorithm>
#include <cmath>

namespace camber::copymill {
namespace {

constexpr double kFullWidth_rad =
    150 * kPi / 180;                 ///< part of the leading half circumference in material that makes a full cut
constexpr double kStands_mm = 0.02;  ///< thinner material is not met
constexpr int kAround = 48;          ///< directions in which a circle is looked at
constexpr double kWithin = 0.99, kWithin_mm = 0.005;  ///< between two of these a wall may stand out
constexpr double kGrowth = 0.15;                      ///< growth of a circle's radius over its advance
constexpr double kEven_mm = 0.02;                     ///< difference of radii below which they count as equal
constexpr double kAlready = 0.3;  ///< fraction of a circle's radius: places so near its centre are done
constexpr double kHeld =
    1 / LoadBand{}.lowest_depth;  ///< multiple of the target: more exceeds it at the lowest depths too

bool counter_clockwise(const machine::CopyOperation& operation) {
  // Climb milling has the material on its right: outside.
  return operation.sense != machine::MillingSense::conventional;
}

Vec2 spoke(int k) { return {std::cos(2 * kPi * k / kAround), std::sin(2 * kPi * k / kAround)}; }

/// A place on a chain of points, by the way along it.
class Guide {
 public:
  explicit Guide(const std::vector<Vec2>& points) : points_(points), along_(points.size(), 0) {
    for (std::size_t k = 1; k < points.size(); ++k) along_[k] = along_[k - 1] + (points[k] - points[k - 1]).norm();
  }
  double length_mm() const { return along_.back(); }
  Vec2 at(double mm) const {
    const auto next = std::ranges::upper_bound(along_, mm);
    if (next == along_.begin()) return points_.front();
    if (next == along_.end()) return points_.back();
    const auto k = static_cast<std::size_t>(next - along_.begin());
    return points_[k - 1] + (mm - along_[k - 1]) / (along_[k] - along_[k - 1]) * (points_[k] - points_[k - 1]);
  }
  Vec2 direction(double mm) const {
    const auto next = std::ranges::upper_bound(along_, mm);
    const auto k = std::clamp<std::ptrdiff_t>(next - along_.begin(), 1, std::ssize(points_) - 1);
    return (points_[static_cast<std::size_t>(k)] - points_[static_cast<std::size_t>(k - 1)]).normalized();
  }

 private:
  const std::vector<Vec2>& points_;
  std::vector<double> along_;
};

}  // namespace

double Slotting::limit_rad() const {
  return engagement_angle_rad(place_.cut.shape.radius_mm, place_.runner.radial_mm());
}

bool Slotting::wanted() const {
  const machine::CopyOperation& o = place_.cut.operation;
  if (o.slotting == machine::Slotting::full_width || limit_rad() >= kFullWidth_rad) return false;
  return o.slotting == machine::Slotting::trochoidal || o.force_N;
}

bool Slotting::full_at(const Standing& standing, const Vec3& tip, const Vec2& direction) const {
  return standing.engaged_rad(place_.cut.shape, tip, direction, kStands_mm) >= kFullWidth_rad;
}

/// Gaps of half a radius are joined. A stretch begins a radius early where the pass does, so that the first circle can
/// lie in what has been cleared.
std::vector<Slotting::Stretch> Slotting::full_stretches(const Pass& pass) const {
  const double step = std::min(place_.standing.cell_mm(), 0.1 * place_.cut.shape.radius_mm);
  std::vector<Vec3> points = dense(pass, step);
  if (points.size() < 2) return {};
  if (pass.closed) points.push_back(points.front());
  const auto gap = static_cast<std::size_t>(0.5 * place_.cut.shape.radius_mm / step) + 1;
  const auto lead = static_cast<std::size_t>(place_.cut.shape.radius_mm / step) + 1;
  std::vector<Stretch> out;
  std::size_t last = 0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Vec2 way = (points[k + 1] - points[k]).head<2>();
    if (way.norm() <= 0 || !full_at(place_.standing, points[k], way.normalized())) continue;
    const bool begins = out.empty() || k > last + gap;
    if (begins) out.push_back({{}, points[k].z()});
    for (std::size_t i = begins ? k - std::min(k, lead) : last + 1; i <= k + 1; ++i)
      out.back().guide.emplace_back(points[i].head<2>());
    last = k + 1;
  }
  return out;
}

bool Slotting::full_width(const Pass& pass) const { return !full_stretches(pass).empty(); }

/// Returns the greatest load of a full cut along a stretch, as a share of the target.
double Slotting::greatest_share(const Stretch& s) const {
  constexpr std::size_t kLooks = 12;
  double out = 0;
  const std::size_t apart = std::max<std::size_t>(1, s.guide.size() / kLooks);
  for (std::size_t k = 0; k + 1 < s.guide.size(); k += apart) {
    const Vec2 way = (s.guide[k + 1] - s.guide[k]).normalized();
    const auto share = place_.runner.share_at_lowest_feed({s.guide[k].x(), s.guide[k].y(), s.z_mm}, way);
    out = std::max(out, share.value_or(0));
  }
  return out;
}

bool Slotting::inside(const Vec2& p, double z) const { return place_.region.contains(p, z) && place_.field.free(p, z); }

/// Returns the radius of the largest circle about a place that the tool may run.
double Slotting::room_mm(const Vec2& centre, double z) const {
  const auto free = [&](double radius) {
    for (int k = 0; k < kAround; ++k)
      if (!inside(centre + radius * spoke(k), z)) return false;
    return true;
  };
  const double most = (largest_mm() + kWithin_mm) / kWithin;
  double fits = most;
  if (!free(most)) {
    fits = 0;
    double exceeds = most;
    while (exceeds - fits > 0.005) {
      const double r = 0.5 * (fits + exceeds);
      (free(r) ? fits : exceeds) = r;
    }
  }
  return std::max(0.0, kWithin * fits - kWithin_mm);
}

/// Returns whether the line from one circle to the next stays within.
bool Slotting::joined(const Circle& a, const Circle& b, double z) const {
  const bool ccw = counter_clockwise(place_.cut.operation);
  const Vec2 from = start_of({a, b}, ccw),
             to = from + (b.centre - a.centre) + (b.radius_mm - a.radius_mm) * (from - a.centre) / a.radius_mm;
  constexpr int kPlaces = 8;
  for (int k = 0; k <= kPlaces; ++k)
    if (!inside(from + static_cast<double>(k) / kPlaces * (to - from), z)) return false;
  return true;
}

bool Slotting::meets(const Standing& standing, const Circle& circle, double z) const {
  for (int k = 0; k < kAround; k += 2) {
    const Vec2 p = circle.centre + circle.radius_mm * spoke(k);
    if (standing.meets(place_.cut.shape, {p.x(), p.y(), z}, kStands_mm)) return true;
  }
  return false;
}

/// Circles are left out where they meet nothing, and where the pass close in front has been run around: what thin rests
/// there are is the passes' own. The first of a row may lie in air.
std::vector<Slotting::Row> Slotting::rows(const Stretch& stretch) const {
  const double R = place_.cut.shape.radius_mm, limit = limit_rad(), z = stretch.z_mm;
  const Guide guide(stretch.guide);
  Standing standing = place_.standing;
  std::vector<Circle> run;
  const auto cut = [&](const Circle& circle) {
    run.push_back(circle);
    Vec2 from = circle.centre + circle.radius_mm * spoke(0);
    for (int k = 1; k <= kAround; ++k) {
      const Vec2 to = circle.centre + circle.radius_mm * spoke(k);
      standing.cut(place_.cut.shape, {from.x(), from.y(), z}, {to.x(), to.y(), z});
      from = to;
    }
  };
  const auto run_around = [&](const Vec2& p) {
    return std::ranges::any_of(run, [&](const Circle& c) { return (p - c.centre).norm() <= kAlready * c.radius_mm; });
  };
  const auto needed = [&](const Circle& circle, double at) {
    for (const double ahead : {0.0, 0.25, 0.5})
      if (!run_around(guide.at(at + ahead * circle.radius_mm))) return meets(standing, circle, z);
    return false;
  };
  std::vector<Row> out;
  double s = 0;
  std::optional<Circle> before;
  bool going = false;
  Row idle;  ///< since the last one that was needed; run all the same where another is needed soon
  double needed_at = 0;
  while (s <= guide.length_mm()) {
    if (!before) {  // the first circle, or the first one after a place that is too narrow
      const Vec2 centre = guide.at(s);
      const double room = room_mm(centre, z);
      if (room < smallest_mm()) {
        s += 0.1 * R;
        continue;
      }
      // In air where that can be; else the tool comes down there.
      Circle first{centre, room};
      for (double r = room; r >= smallest_mm() && meets(standing, first, z); r *= 0.8) first.radius_mm = r;
      if (meets(standing, first, z)) first.radius_mm = room;
      before = first;
      going = needed(first, s);
      if (going) out.push_back({first}), cut(first), idle.clear(), needed_at = s;
      continue;
    }
    double advance = trochoid_step_mm(R, before->radius_mm, limit);
    std::optional<Circle> next;
    constexpr double kShortest_mm = 0.005;
    for (; advance > kShortest_mm && !next; advance *= 0.7) {
      const double to = std::min(s + advance, guide.length_mm());
      const Vec2 centre = guide.at(to);
      const double room = room_mm(centre, z), even = std::min(room, before->radius_mm);
      const bool grows = room > before->radius_mm + kEven_mm;
      const Circle candidate{centre, grows ? std::min(room, even + kGrowth * (to - s)) : even};
      if (candidate.radius_mm < smallest_mm()) continue;
      if (greatest_engagement_rad(R, *before, candidate) + outward_rad(*before, candidate) <= limit + 1e-9 &&
          joined(*before, candidate, z))
        next = candidate, s = to;
    }
    if (!next) {
      before.reset();
      s += 0.1 * R;
      continue;
    }
    if (needed(*next, s)) {
      if (!going) out.push_back({*before}), idle.clear();
      idle.push_back(*next);
      for (const Circle& circle : idle) out.back().push_back(circle), cut(circle);
      idle.clear();
      going = true, needed_at = s;
    } else if (going) {
      idle.push_back(*next);
      if (s > needed_at + R) going = false;
    }
    before = next;
    if (s >= guide.length_mm()) break;
  }
  return out;
}

Runner::Ended Slotting::cut(const Row& row, double z) {
  const bool ccw = counter_clockwise(place_.cut.operation);
  Pass ring{.points = {}, .closed = true};
  const Vec2 start = start_of(row, ccw) - row.front().centre;
  for (int k = 0; k < kAround; ++k) {
    const double a = (ccw ? 2 : -2) * kPi * k / kAround, c = std::cos(a), s = std::sin(a);
    const Vec2 p = row.front().centre + Vec2(c * start.x() - s * start.y(), s * start.x() + c * start.y());
    ring.points.emplace_back(p.x(), p.y(), z);
  }
  Runner& runner = place_.runner;
  ++runner.summary().passes;
  Pass entered = ring;
  if (approach_.enter_ring(entered) != Runner::Ended::done) return runner.ended();
  // From where the helix ended on, to where the first circle begins.
  const auto here =
      std::ranges::min_element(ring.points, {}, [&](const Vec3& p) { return (p - *runner.at()).squaredNorm(); });
  std::vector<Vec3> rest(here, ring.points.end());
  rest.push_back(ring.points.front());
  if (runner.cut(here == ring.points.begin() ? std::vector<Vec3>{ring.points.front()} : rest, false) !=
      Runner::Ended::done)
    return runner.ended();
  runner.summary().trochoid_circles += row.size();
  return runner.follow(trochoid(row, z, ccw, runner.increment_mm()));
}

Runner::Ended Slotting::clear(const Pass& pass, bool own) {
  for (const Stretch& stretch : full_stretches(pass)) {
    const double full = 2 * place_.cut.shape.radius_mm, radial = place_.runner.radial_mm();
    const bool by_load = place_.cut.operation.slotting == machine::Slotting::by_load;
    const Vec2 at = stretch.guide.front();
    const Vec3 tip(at.x(), at.y(), stretch.z_mm);
    const double share = by_load ? greatest_share(stretch) : 0;
    if (by_load && share <= kHeld) {
      if (own) place_.runner.note_slot(tip, full, full, Cause::full_cut_within_limit, share);
      continue;
    }
    const std::vector<Row> found = rows(stretch);
    if (found.empty() && own) place_.runner.note_slot(tip, full, full, Cause::slot_too_narrow, share);
    if (!found.empty())
      place_.runner.note_slot(tip, full, radial, by_load ? Cause::full_cut_over_limit : Cause::trochoids_asked_for,
                              share);
    for (const Row& row : found)
      if (cut(row, stretch.z_mm) != Runner::Ended::done) return place_.runner.ended();
  }
  return Runner::Ended::done;
}

}  // namespace camber::copymill
