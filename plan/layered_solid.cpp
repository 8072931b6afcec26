#include "plan/layered_solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace camber::plan {
namespace {

using Micron = long long;

/// An edge of a loop that is not along x, by its lower end.
struct Side {
  Micron x0, y0, x1, y1;
  double x(double y) const {
    return static_cast<double>(x0) +
           static_cast<double>(x1 - x0) * (y - static_cast<double>(y0)) / static_cast<double>(y1 - y0);
  }
  Micron at(Micron y) const { return y == y0 ? x0 : y == y1 ? x1 : std::llround(x(static_cast<double>(y))); }
};

/// Material between two sides, from one y of a corner to the next.
struct Trapezoid {
  Micron left0, right0, left1, right1;  ///< at the lower and the upper y
};

/// The region in slabs between the y of its corners. Pieces of neighbouring slabs share all points of the line between
/// them, so that the triangles of the caps and of the walls fit each other.
class Prism {
 public:
  Prism(Solid& out, const std::vector<std::vector<Vec2>>& loops, double from, double to) : out_(out), z_{from, to} {
    const auto micron = [](double mm) { return std::llround(1000 * mm); };
    for (const auto& loop : loops)
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
        const Micron ax = micron(a.x()), ay = micron(a.y()), bx = micron(b.x()), by = micron(b.y());
        if (ay < by) sides_.push_back({ax, ay, bx, by});
        if (ay > by) sides_.push_back({bx, by, ax, ay});
      }
    std::set<Micron> y;
    for (const Side& s : sides_) y.insert(s.y0), y.insert(s.y1);
    y_.assign(y.begin(), y.end());
  }

  void add() {
    if (y_.size() < 2) return;
    find_slabs();
    for (std::size_t k = 0; k + 1 < y_.size(); ++k)
      for (const Trapezoid& t : slabs_[k]) {
        caps(t, k);
        wall(t.right0, y_[k], t.right1, y_[k + 1]);
        wall(t.left1, y_[k + 1], t.left0, y_[k]);
      }
    for (std::size_t k = 0; k < y_.size(); ++k) walls_along_x(k);
  }

 private:
  void find_slabs() {
    slabs_.resize(y_.size() - 1);
    points_.resize(y_.size());
    std::ranges::sort(sides_, {}, &Side::y0);
    for (std::size_t k = 0; k + 1 < y_.size(); ++k) {
      const double middle = 0.5 * static_cast<double>(y_[k] + y_[k + 1]);
      std::vector<const Side*> here;
      for (const Side& s : sides_) {
        if (s.y0 > y_[k]) break;
        if (s.y1 >= y_[k + 1]) here.push_back(&s);
      }
      std::ranges::sort(here, {}, [&](const Side* s) { return s->x(middle); });
      for (std::size_t i = 0; i + 1 < here.size(); i += 2) {
        const Side &l = *here[i], &r = *here[i + 1];
        Trapezoid t{l.at(y_[k]), r.at(y_[k]), l.at(y_[k + 1]), r.at(y_[k + 1])};
        t.right0 = std::max(t.left0, t.right0), t.right1 = std::max(t.left1, t.right1);
        points_[k].insert(t.left0), points_[k].insert(t.right0);
        points_[k + 1].insert(t.left1), points_[k + 1].insert(t.right1);
        slabs_[k].push_back(t);
      }
    }
  }

  std::vector<Micron> between(std::size_t k, Micron from, Micron to) const {
    return {points_[k].lower_bound(from), points_[k].upper_bound(to)};
  }

  void caps(const Trapezoid& t, std::size_t k) {
    const std::vector<Micron> low = between(k, t.left0, t.right0), high = between(k + 1, t.left1, t.right1);
    std::size_t i = 0, j = 0;
    while (i + 1 < low.size() || j + 1 < high.size()) {
      const bool below = j + 1 == high.size() || (i + 1 < low.size() && low[i + 1] <= high[j + 1]);
      const Vec3 a = place(low[i], y_[k]), c = place(high[j], y_[k + 1]);
      level(a, below ? place(low[i + 1], y_[k]) : place(high[j + 1], y_[k + 1]), c);
      ++(below ? i : j);
    }
  }

  /// Between the two slabs that meet at a y, where one has material and the other has not.
  void walls_along_x(std::size_t k) {
    const std::vector<Micron> x(points_[k].begin(), points_[k].end());
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      const bool above = k < slabs_.size() && std::ranges::any_of(slabs_[k], [&](const Trapezoid& t) {
                           return t.left0 <= x[i] && x[i + 1] <= t.right0;
                         });
      const bool below = k > 0 && std::ranges::any_of(slabs_[k - 1], [&](const Trapezoid& t) {
                           return t.left1 <= x[i] && x[i + 1] <= t.right1;
                         });
      if (above && !below) wall(x[i], y_[k], x[i + 1], y_[k]);
      if (below && !above) wall(x[i + 1], y_[k], x[i], y_[k]);
    }
  }

  /// From p to q with the material on the left.
  void wall(Micron px, Micron py, Micron qx, Micron qy) {
    if (px == qx && py == qy) return;
    const Vec3 p = place(px, py), q = place(qx, qy);
    triangle(at(p, 0), at(q, 0), at(q, 1));
    triangle(at(p, 0), at(q, 1), at(p, 1));
  }

  void level(const Vec3& a, const Vec3& b, const Vec3& c) {
    triangle(at(a, 1), at(b, 1), at(c, 1));
    triangle(at(a, 0), at(c, 0), at(b, 0));
  }

  static Vec3 place(Micron x, Micron y) { return {static_cast<double>(x) / 1000, static_cast<double>(y) / 1000, 0}; }
  Vec3 at(const Vec3& p, std::size_t end) const { return {p.x(), p.y(), z_[end]}; }

  void triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    out_.triangles.push_back({point(a), point(b), point(c)});
  }

  std::uint32_t point(const Vec3& p) {
    const auto [it, fresh] = index_.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(out_.points.size()));
    if (fresh) out_.points.push_back(p);
    return it->second;
  }

  Solid& out_;
  std::array<double, 2> z_;
  std::vector<Side> sides_;
  std::vector<Micron> y_;
  std::vector<std::vector<Trapezoid>> slabs_;
  std::vector<std::set<Micron>> points_;  ///< x of the points at each y
  std::map<std::array<double, 3>, std::uint32_t> index_;
};

}  // namespace

void add_layer(Solid& out, const std::vector<std::vector<Vec2>>& loops, double from_mm, double to_mm) {
  Prism(out, loops, from_mm, to_mm).add();
}

}  // namespace camber::plan
