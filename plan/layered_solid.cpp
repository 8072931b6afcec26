#include "plan/part_of_stock.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace camber::plan {
namespace {

struct Point {
  std::int64_t x = 0, y = 0;
  bool operator==(const Point&) const = default;
};

struct Corner {
  Point at;
  std::size_t number = 0;
};
using Ring = std::vector<Corner>;

/// Twice the area of a triangle; more than 0 where c is on the left of the way from a to b.
std::int64_t cross(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double area_of(const Ring& ring) {
  double sum = 0;
  for (std::size_t k = 1; k + 1 < ring.size(); ++k)
    sum += static_cast<double>(cross(ring[0].at, ring[k].at, ring[k + 1].at));
  return sum / 2;
}

bool holds(const Ring& ring, const Point& p) {
  bool in = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Point &a = ring[k].at, &b = ring[(k + 1) % ring.size()].at;
    if ((a.y > p.y) == (b.y > p.y)) continue;
    in = in != ((cross(a, b, p) > 0) == (b.y > a.y));
  }
  return in;
}

bool in_triangle(const Point& a, const Point& b, const Point& c, const Point& p) {
  return cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0;
}

std::size_t rightmost(const Ring& ring) {
  return static_cast<std::size_t>(std::ranges::max_element(ring, {}, [](const Corner& c) { return c.at.x; }) -
                                  ring.begin());
}

/// A corner of the outer ring that is seen from m, to its right (Eberly, Triangulation by Ear Clipping, 2002).
std::size_t seen_from(const Ring& outer, const Point& m) {
  double nearest = 1e300;
  std::size_t best = 0;
  for (std::size_t k = 0; k < outer.size(); ++k) {
    const std::size_t next = (k + 1) % outer.size();
    const Point &a = outer[k].at, &b = outer[next].at;
    if (a.y > m.y || b.y < m.y || a.y == b.y) continue;  // the region is on the left of sides that go up
    const double x = static_cast<double>(a.x) +
                     static_cast<double>(b.x - a.x) * static_cast<double>(m.y - a.y) / static_cast<double>(b.y - a.y);
    if (x < static_cast<double>(m.x) || x >= nearest) continue;
    nearest = x;
    best = a.x > b.x ? k : next;
    if (a.y == m.y) best = k;
    if (b.y == m.y) best = next;
  }
  const Point p = outer[best].at, i{static_cast<std::int64_t>(std::llround(nearest)), m.y};
  if (p == i) return best;
  // What else is in the triangle of m, the place on the side, and the corner may hide that: the one of least slope.
  double least = 1e300;
  std::size_t out = best;
  for (std::size_t k = 0; k < outer.size(); ++k) {
    const Point& q = outer[k].at;
    if (q == p || q.x < m.x || !(p.y > m.y ? in_triangle(m, i, p, q) : in_triangle(m, p, i, q))) continue;
    const double dx = static_cast<double>(q.x - m.x), dy = std::abs(static_cast<double>(q.y - m.y));
    const double slope = dx > 0 ? dy / dx : 1e299;
    if (slope < least) least = slope, out = k;
  }
  return out;
}

void join_hole(Ring& outer, const Ring& hole) {
  const std::size_t from = rightmost(hole), to = seen_from(outer, hole[from].at);
  Ring joined(outer.begin(), outer.begin() + static_cast<std::ptrdiff_t>(to) + 1);
  for (std::size_t k = 0; k <= hole.size(); ++k) joined.push_back(hole[(from + k) % hole.size()]);
  joined.insert(joined.end(), outer.begin() + static_cast<std::ptrdiff_t>(to), outer.end());
  outer = std::move(joined);
}

class EarCutter {
 public:
  EarCutter(Ring ring, std::vector<std::array<std::size_t, 3>>& out) : ring_(std::move(ring)), out_(out) {}

  void cut() {
    while (ring_.size() > 3) {
      std::size_t ear = find(1);
      if (ear == ring_.size()) ear = find(0);   // three points in a line
      if (ear == ring_.size()) ear = convex();  // loops that cross each other
      take(ear);
    }
    if (ring_.size() == 3) take(1);
  }

 private:
  const Corner& before(std::size_t k) const { return ring_[(k + ring_.size() - 1) % ring_.size()]; }
  const Corner& after(std::size_t k) const { return ring_[(k + 1) % ring_.size()]; }
  std::int64_t turn(std::size_t k) const { return cross(before(k).at, ring_[k].at, after(k).at); }

  bool is_ear(std::size_t k) const {
    const Point &a = before(k).at, &b = ring_[k].at, &c = after(k).at;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Point& p = ring_[i].at;
      if (p == a || p == b || p == c || turn(i) > 0) continue;
      if (in_triangle(a, b, c, p)) return false;
    }
    return true;
  }

  /// Returns the ear of at least this turn with the shortest side across: slender triangles are slow to use.
  std::size_t find(std::int64_t least_turn) const {
    std::size_t best = ring_.size();
    double shortest = 1e300;
    for (std::size_t k = 0; k < ring_.size(); ++k) {
      if (turn(k) < least_turn) continue;
      const double across = std::hypot(static_cast<double>(after(k).at.x - before(k).at.x),
                                       static_cast<double>(after(k).at.y - before(k).at.y));
      if (across < shortest && is_ear(k)) shortest = across, best = k;
    }
    return best;
  }

  std::size_t convex() const {
    for (std::size_t k = 0; k < ring_.size(); ++k)
      if (turn(k) > 0) return k;
    return 0;
  }

  void take(std::size_t k) {
    out_.push_back({before(k).number, ring_[k].number, after(k).number});
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(k));
  }

  Ring ring_;
  std::vector<std::array<std::size_t, 3>>& out_;
};

}  // namespace

std::vector<std::array<std::size_t, 3>> triangles_of(const std::vector<std::vector<Vec2>>& loops) {
  constexpr double kPerMm = 1e6;
  std::vector<Ring> outers, holes;
  std::size_t number = 0;
  for (const auto& loop : loops) {
    Ring ring;
    for (const Vec2& p : loop) ring.push_back({{std::llround(kPerMm * p.x()), std::llround(kPerMm * p.y())}, number++});
    if (ring.size() < 3) continue;
    (area_of(ring) > 0 ? outers : holes).push_back(std::move(ring));
  }
  // The smallest outer loop round a hole is its own; the hole farthest to the right is joined first.
  std::ranges::sort(outers, {}, area_of);
  std::ranges::sort(holes, std::ranges::greater{}, [](const Ring& h) { return h[rightmost(h)].at.x; });
  std::vector<Ring> joined = outers;
  for (const Ring& hole : holes)
    for (std::size_t k = 0; k < outers.size(); ++k)
      if (holds(outers[k], hole[rightmost(hole)].at)) {
        join_hole(joined[k], hole);
        break;
      }
  std::vector<std::array<std::size_t, 3>> out;
  for (Ring& ring : joined) EarCutter(std::move(ring), out).cut();
  return out;
}

namespace {

using Loops = std::vector<std::vector<Vec2>>;

class Layer {
 public:
  explicit Layer(TriangleSolid& out) : out_(out) {}

  void walls(const std::vector<Vec2>& loop, double from, double to) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
      out_.triangles.push_back({point(a, from), point(b, from), point(b, to)});
      out_.triangles.push_back({point(a, from), point(b, to), point(a, to)});
    }
  }

  void level(const Loops& loops, double z, bool up) {
    std::vector<Vec2> all;
    for (const auto& loop : loops) all.insert(all.end(), loop.begin(), loop.end());
    for (const auto& [a, b, c] : triangles_of(loops))
      out_.triangles.push_back({point(all[a], z), point(all[up ? b : c], z), point(all[up ? c : b], z)});
  }

 private:
  std::uint32_t point(const Vec2& p, double z) {
    const auto [it, fresh] = index_.try_emplace({p.x(), p.y(), z}, static_cast<std::uint32_t>(out_.points.size()));
    if (fresh) out_.points.emplace_back(p.x(), p.y(), z);
    return it->second;
  }

  TriangleSolid& out_;
  std::map<std::array<double, 3>, std::uint32_t> index_;
};

}  // namespace

void add_layer(TriangleSolid& out, const Loops& loops, double from_mm, double to_mm, const std::vector<Well>& wells) {
  Layer layer(out);
  for (const auto& loop : loops) layer.walls(loop, from_mm, to_mm);
  Loops top = loops, bottom = loops;
  for (const Well& w : wells) {
    const bool through = w.bottom_mm <= from_mm;
    const double low = std::max(w.bottom_mm, from_mm);
    top.push_back(w.ring);
    layer.walls(w.ring, low, to_mm);
    if (through)
      bottom.push_back(w.ring);
    else
      layer.level({{w.ring.rbegin(), w.ring.rend()}}, low, true);
  }
  layer.level(top, to_mm, true);
  layer.level(bottom, from_mm, false);
}

}  // namespace camber::plan
