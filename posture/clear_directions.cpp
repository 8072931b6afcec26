#include "posture/choose.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/stage.h"

namespace camber::posture {
namespace {

constexpr double kAirCap_mm = 10;  ///< room beyond this is not measured

/// Holds both pieces, and what is between them.
ToolShape::Piece hull_of(const ToolShape::Piece& longer, const ToolShape::Piece& shorter) {
  std::vector<checks::TurnedSolid::Circle> circles = shorter.solid.circles();
  circles.insert(circles.end(), longer.solid.circles().begin(), longer.solid.circles().end());
  std::ranges::stable_sort(circles, {}, &checks::TurnedSolid::Circle::height_mm);
  checks::TurnedSolid solid(longer.solid.part());
  for (const auto& circle : circles) solid.add(circle.radius_mm, circle.height_mm);
  return {solid, longer.need_mm, solid.radius_mm(), solid.bottom_mm(), solid.top_mm()};
}

/// The cylinder that is in both pieces, and in all between them.
std::optional<ToolShape::Piece> core_of(const ToolShape::Piece& longer, const ToolShape::Piece& shorter) {
  const double bottom = std::max(longer.bottom_mm, shorter.bottom_mm), top = std::min(longer.top_mm, shorter.top_mm);
  double radius = longer.radius_mm;
  for (const auto* piece : {&longer, &shorter})
    for (const auto& circle : piece->solid.circles()) radius = std::min(radius, circle.radius_mm);
  if (top <= bottom || radius <= 0) return std::nullopt;
  checks::TurnedSolid solid(longer.solid.part());
  solid.add(radius, bottom);
  solid.add(radius, top);
  return ToolShape::Piece{solid, longer.need_mm, radius, bottom, top};
}

/// A range of lengths: what all of them together need, what each of them needs at least, and its two halves.
struct Range {
  std::size_t first = 0, end = 0;
  bool alike = true;  ///< the tools have the same pieces
  ToolShape whole, core;
  std::size_t halves = 0;  ///< index of the first of the two halves, which are neighbours in the list

  std::uint32_t bits() const { return (end == 32 ? ~0U : (1U << end) - 1U) & ~((1U << first) - 1U); }
};

void add_ranges(std::span<const ToolShape> tools, std::size_t index, std::size_t first, std::size_t end,
                std::vector<Range>& out) {
  Range now;
  now.first = first;
  now.end = end;
  const ToolShape &longer = tools[first], &shorter = tools[end - 1];
  for (const ToolShape& tool : tools.subspan(first, end - first))
    now.alike = now.alike && tool.pieces.size() == longer.pieces.size();
  if (end - first == 1) now.whole = longer;
  if (end - first > 1 && now.alike) {
    for (std::size_t i = 0; i < longer.pieces.size(); ++i) {
      now.whole.pieces.push_back(hull_of(longer.pieces[i], shorter.pieces[i]));
      if (auto core = core_of(longer.pieces[i], shorter.pieces[i])) now.core.pieces.push_back(std::move(*core));
    }
  }
  now.halves = out.size();
  const bool halved = end - first > 1;
  if (halved) out.resize(out.size() + 2);
  out[index] = now;
  if (!halved) return;
  const std::size_t middle = first + (end - first + 1) / 2;
  add_ranges(tools, now.halves, first, middle, out);
  add_ranges(tools, now.halves + 1, middle, end, out);
}

/// Checks one direction along the path.
class Along {
 public:
  Along(const Surroundings& surroundings, const std::vector<Range>& ranges, const Vec3& axis)
      : surroundings_(surroundings), ranges_(ranges), axis_(axis) {}

  /// Returns the lengths that are clear at a point. With a constant direction the tool only moves, so that the room at
  /// one point bounds the room at the next ones.
  std::uint32_t at(const PathPoint& point) {
    const Range& all = ranges_.front();
    const Vec3 tip = point.tip_mm(axis_);
    if (room_ > 0 && (tip - there_).norm() < room_) return all.bits();
    if (!all.alike) return within(0, tip);
    room_ = surroundings_.room_mm(all.whole, tip, axis_, point.contact ? 0 : kAirCap_mm);
    there_ = tip;
    return room_ >= 0 ? all.bits() : blocked(0, tip);
  }

 private:
  std::uint32_t within(std::size_t range, const Vec3& tip) const {
    const Range& now = ranges_[range];
    if (now.alike && surroundings_.room_mm(now.whole, tip, axis_, 0) >= 0) return now.bits();
    return blocked(range, tip);
  }
  /// Returns the clear lengths of a range of which not all are clear together.
  std::uint32_t blocked(std::size_t range, const Vec3& tip) const {
    const Range& now = ranges_[range];
    if (now.end - now.first == 1) return 0;
    if (now.alike && surroundings_.room_mm(now.core, tip, axis_, 0) < 0) return 0;
    return within(now.halves, tip) | within(now.halves + 1, tip);
  }

  const Surroundings& surroundings_;
  const std::vector<Range>& ranges_;
  const Vec3& axis_;
  double room_ = -1;
  Vec3 there_ = Vec3::Zero();
};

}  // namespace

ClearDirections::ClearDirections(std::span<const PathPoint> points, const Surroundings& surroundings,
                                 std::span<const ToolShape> tools, const Directions& directions, double farthest_rad)
    : directions_(directions.size()), clear_(points.size() * directions.size(), 0) {
  assert(!tools.empty() && tools.size() <= kMaxTools);
  std::vector<Range> ranges(1);
  add_ranges(tools, 0, 0, tools.size(), ranges);
  Stage stage("looking for clear directions", directions.size());
  tbb::parallel_for(std::size_t{0}, directions.size(), [&](std::size_t d) {
    const Vec3& axis = directions.axis(d);
    Along along(surroundings, ranges, axis);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!points[i].contact || angle_between(axis, points[i].normal) <= farthest_rad)
        clear_[i * directions.size() + d] = along.at(points[i]);
    stage.advance();
  });
}

}  // namespace camber::posture
