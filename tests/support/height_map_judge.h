#pragma once
// What a three-axis program leaves of a block, as a height map, and whether that is the part: a second opinion on
// Camber's programs. Exact cutter profiles on the exact swept path; no code is Camber's.
//
// Heights stand at points of a square grid. Depth into the part and material left over it are measured along the
// normal, as distances from the part's triangles, so that a wall between two points of the grid does not count as deep.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <vector>

#include "tests/support/judge_mesh.h"
#include "tests/support/judge_program.h"

namespace judge {

/// An upright body above the cutter: a cylinder of this radius from a height over the tip on.
struct Body {
  double radius = 0, above_tip = 0;
};

struct Cutter {
  double diameter = 0, corner_radius = 0;  ///< flat 0, ball half the diameter
  double point_angle = 0;                  ///< drill, rad between opposite sides; 0: none
  double flutes = 1e9;                     ///< length; above it the shank, as wide as the cutter, must not cut
  std::vector<Body> bodies{};              ///< wider shank, holder

  double radius() const { return diameter / 2; }
  /// Height of the lower side over the tip, at a distance from the axis of at most the radius.
  double height(double r) const {
    if (point_angle > 0) return r / std::tan(point_angle / 2);
    const double in = r - (radius() - corner_radius);
    return in <= 0 ? 0 : corner_radius - std::sqrt(std::max(0.0, corner_radius * corner_radius - in * in));
  }
};

/// A depth and where it is.
struct Worst {
  double depth = 0;
  Point place{};
  int line = 0;  ///< line of the program, where it is known
  void take(double d, const Point& p, int l) {
    if (d > depth) depth = d, place = p, line = l;
  }
};

struct Verdict {
  Worst gouge;               ///< into the part, along the normal
  Worst left;                ///< over the part, along the normal
  Worst left_reachable;      ///< of it what the cutter that is asked for could have reached
  Worst rapid, shank, body;  ///< material above the lower side of what must not cut there, vertical
  double left_area = 0;      ///< mm2 with more left than asked about
  double removed = 0;        ///< mm3
};

class HeightMap {
 public:
  HeightMap(const Point& lo, const Point& hi, double cell)
      : lo_(lo), cell_(cell), nx_(count(hi.x - lo.x)), ny_(count(hi.y - lo.y)) {
    height_.assign(static_cast<std::size_t>(nx_ * ny_), hi.z);
    cut_by_.assign(height_.size(), 0);
  }

  void cut(const Piece& piece, const Cutter& cutter, Verdict& verdict) {
    constexpr double kTouch = 1e-6;
    over(piece, cutter.radius(), [&](std::size_t at, const Point& p) {
      const double z = std::max(lo_.z, lowest(piece, cutter, p));
      const double before = height_[at];
      if (z >= before - kTouch) return;
      if (piece.rapid) verdict.rapid.take(before - z, {p.x, p.y, z}, piece.line);
      const double tip = std::min(piece.from.z, piece.to.z);
      if (before > tip + cutter.flutes + kTouch)
        verdict.shank.take(before - tip - cutter.flutes, {p.x, p.y, before}, piece.line);
      verdict.removed += (before - z) * cell_ * cell_;
      height_[at] = z;
      cut_by_[at] = piece.line;
    });
    for (const Body& body : cutter.bodies) {
      const Cutter rod{2 * body.radius, 0};
      over(piece, body.radius, [&](std::size_t at, const Point& p) {
        if (height_[at] <= std::min(piece.from.z, piece.to.z) + body.above_tip + kTouch) return;
        const double z = lowest(piece, rod, p) + body.above_tip;
        if (height_[at] > z + kTouch) verdict.body.take(height_[at] - z, {p.x, p.y, z}, piece.line);
      });
    }
  }

  /// Of the points of the part within a box. `of_interest`: less left over than this is not looked at, mm. `grown`: of
  /// the cutter's radius, where its places are looked for; as far as a wall may be beyond the last point before it.
  void compare(const PartMesh& part, const Point& from, const Point& to, double allowance, double of_interest,
               const Cutter& reaching, Verdict& verdict, double grown = 0) const {
    std::vector<double> tops(height_.size());
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < ny_; ++j) tops[at(i, j)] = part.top(x(i), y(j));
    std::vector<double> reachable;
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < ny_; ++j) {
        const double z = height_[at(i, j)], top = tops[at(i, j)];
        if (top == PartMesh::kNone || x(i) < from.x || x(i) > to.x || y(j) < from.y || y(j) > to.y) continue;
        if (top < from.z || top > to.z) continue;
        if (z < top) verdict.gouge.take(deepest(part, {x(i), y(j), z}, top), {x(i), y(j), z}, cut_by_[at(i, j)]);
        if (z <= top + allowance + of_interest) continue;
        const double left = deepest(part, {x(i), y(j), top}, z);
        verdict.left.take(left, {x(i), y(j), z}, cut_by_[at(i, j)]);
        if (left <= allowance + of_interest) continue;
        verdict.left_area += cell_ * cell_;
        if (reachable.empty()) reachable = reach(tops, reaching, grown, to.z);
        const double above = z - std::max(top, reachable[at(i, j)]);
        if (above > allowance + of_interest)
          verdict.left_reachable.take(std::min(left, above), {x(i), y(j), z}, cut_by_[at(i, j)]);
      }
  }

  double height_at(double px, double py) const {
    return height_[at(static_cast<int>(std::lround((px - lo_.x) / cell_)),
                      static_cast<int>(std::lround((py - lo_.y) / cell_)))];
  }

 private:
  int count(double mm) const { return static_cast<int>(std::floor(mm / cell_ + 1e-9)) + 1; }
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(ny_) + static_cast<std::size_t>(j);
  }
  double x(int i) const { return lo_.x + i * cell_; }
  double y(int j) const { return lo_.y + j * cell_; }

  /// Calls f(index, place) for the points that a disc on the piece comes over.
  template <class Function>
  void over(const Piece& piece, double radius, Function f) const {
    const Point &a = piece.from, &b = piece.to;
    const double dx = b.x - a.x, dy = b.y - a.y, d2 = dx * dx + dy * dy;
    const auto from = [&](double lo, double v) {
      return std::max(0, static_cast<int>(std::ceil((v - radius - lo) / cell_)));
    };
    const auto to = [&](double lo, double v, int n) {
      return std::min(n - 1, static_cast<int>(std::floor((v + radius - lo) / cell_)));
    };
    for (int i = from(lo_.x, std::min(a.x, b.x)); i <= to(lo_.x, std::max(a.x, b.x), nx_); ++i)
      for (int j = from(lo_.y, std::min(a.y, b.y)); j <= to(lo_.y, std::max(a.y, b.y), ny_); ++j) {
        const double px = x(i), py = y(j);
        const double t = d2 > 0 ? std::clamp(((px - a.x) * dx + (py - a.y) * dy) / d2, 0.0, 1.0) : 0;
        const double ex = px - a.x - t * dx, ey = py - a.y - t * dy;
        if (ex * ex + ey * ey <= radius * radius) f(at(i, j), Point{px, py, 0});
      }
  }

  /// Lowest that the cutter's lower side comes over a place: least of z(t) + h(r(t)) where r(t) is within the radius.
  /// It is convex in t.
  static double lowest(const Piece& piece, const Cutter& cutter, const Point& p) {
    const Point &a = piece.from, d = piece.to - piece.from;
    const double d2 = d.x * d.x + d.y * d.y, r = cutter.radius();
    const double ax = p.x - a.x, ay = p.y - a.y;
    const auto value = [&](double t) {
      return a.z + t * d.z + cutter.height(std::min(r, std::hypot(ax - t * d.x, ay - t * d.y)));
    };
    if (d2 == 0) return value(d.z < 0 ? 1 : 0);
    const double middle = (ax * d.x + ay * d.y) / d2;
    if (d.z == 0) return value(std::clamp(middle, 0.0, 1.0));
    const double off2 = std::max(0.0, ax * ax + ay * ay - middle * middle * d2);
    const double half = std::sqrt(std::max(0.0, r * r - off2) / d2);
    double lo = std::clamp(middle - half, 0.0, 1.0), hi = std::clamp(middle + half, 0.0, 1.0);
    constexpr double kGolden = 0.6180339887498949;
    constexpr int kSteps = 40;
    double u = hi - kGolden * (hi - lo), v = lo + kGolden * (hi - lo), at_u = value(u), at_v = value(v);
    const double ends = std::min(value(lo), value(hi));
    for (int k = 0; k < kSteps && hi - lo > 1e-9; ++k) {
      if (at_u < at_v)
        hi = v, v = u, at_v = at_u, u = hi - kGolden * (hi - lo), at_u = value(u);
      else
        lo = u, u = v, at_u = at_v, v = lo + kGolden * (hi - lo), at_v = value(v);
    }
    return std::min({at_u, at_v, ends});
  }

  /// Greatest distance from the part's surface on the vertical line from a place up to `to_z`.
  static double deepest(const PartMesh& part, const Point& from, double to_z) {
    constexpr int kPlaces = 8;
    double deepest = 0;
    for (int k = 0; k <= kPlaces; ++k) {
      const double z = from.z + (to_z - from.z) * k / kPlaces;
      deepest = std::max(deepest, part.distance({from.x, from.y, z}, to_z - from.z));
    }
    return deepest;
  }

  /// Surface of a cutter that goes as deep as the part allows everywhere, with its tip no higher than `highest`.
  std::vector<double> reach(const std::vector<double>& tops, const Cutter& cutter, double grown, double highest) const {
    const auto disc_of = [&](double radius) {
      const int n = static_cast<int>(std::floor(radius / cell_));
      std::vector<std::pair<std::pair<int, int>, double>> disc;
      for (int i = -n; i <= n; ++i)
        for (int j = -n; j <= n; ++j)
          if (const double r = std::hypot(i, j) * cell_; r <= radius)
            disc.push_back({{i, j}, cutter.height(std::min(r, cutter.radius()))});
      return disc;
    };
    const auto wide = disc_of(cutter.radius() + grown), disc = disc_of(cutter.radius());
    std::vector<double> tips(tops.size()), out(tops.size(), std::numeric_limits<double>::infinity());
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < ny_; ++j) {
        double tip = PartMesh::kNone;
        for (const auto& [d, h] : wide) {
          const int a = i + d.first, b = j + d.second;
          if (a >= 0 && b >= 0 && a < nx_ && b < ny_) tip = std::max(tip, tops[at(a, b)] - h);
        }
        tips[at(i, j)] = tip <= highest ? tip : std::numeric_limits<double>::infinity();
      }
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < ny_; ++j)
        for (const auto& [d, h] : disc) {
          const int a = i + d.first, b = j + d.second;
          if (a >= 0 && b >= 0 && a < nx_ && b < ny_) out[at(i, j)] = std::min(out[at(i, j)], tips[at(a, b)] + h);
        }
    return out;
  }

  Point lo_;
  double cell_;
  int nx_, ny_;
  std::vector<double> height_;
  std::vector<int> cut_by_;
};

struct Question {
  Point stock_min, stock_max;
  double cell = 0.1;
  double allowance = 0;       ///< may stand over the part
  double of_interest = 0.01;  ///< more than allowance and this is looked at
  std::map<int, Cutter> cutters{};
  Point from{-1e9, -1e9, -1e9}, to{1e9, 1e9, 1e9};  ///< where the part is looked at
  int reaching = 0;  ///< the cutter that is to have reached all of it; 0: the smallest that is no drill
};

inline const Cutter& reaching_cutter(const Question& question) {
  if (question.reaching != 0) return question.cutters.at(question.reaching);
  return std::ranges::min_element(question.cutters, {},
                                  [](const auto& c) { return std::pair(c.second.point_angle > 0, c.second.diameter); })
      ->second;
}

inline Verdict judge(const std::vector<Piece>& program, const PartMesh& part, const Question& question) {
  Verdict verdict;
  HeightMap map(question.stock_min, question.stock_max, question.cell);
  for (const Piece& piece : program) {
    const auto cutter = question.cutters.find(piece.tool);
    if (cutter == question.cutters.end())
      throw std::runtime_error("line " + std::to_string(piece.line) + ": T" + std::to_string(piece.tool) +
                               " is not given");
    map.cut(piece, cutter->second, verdict);
  }
  map.compare(part, question.from, question.to, question.allowance, question.of_interest, reaching_cutter(question),
              verdict);
  return verdict;
}

}  // namespace judge
