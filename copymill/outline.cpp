#include "copymill/outline.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace camber::copymill {
namespace {

/// An edge of the grid, from a point to the next one in X or in Y.
struct Edge {
  int i = 0, j = 0;
  bool upright = false;
};

/// The steps through one cell: from edge to edge, the inside on the left. Edges: 0 below, 1 right, 2 above, 3 left.
/// Corners: 1 lower left, 2 lower right, 4 upper right, 8 upper left.
struct Step {
  int from = -1, to = -1;
};
constexpr std::array<std::array<Step, 2>, 16> kSteps{{
    {},
    {{{0, 3}}},          // lower left
    {{{1, 0}}},          // lower right
    {{{1, 3}}},          // lower
    {{{2, 1}}},          // upper right
    {{{0, 3}, {2, 1}}},  // lower left, upper right
    {{{2, 0}}},          // right
    {{{2, 3}}},          // all but upper left
    {{{3, 2}}},          // upper left
    {{{0, 2}}},          // left
    {{{1, 0}, {3, 2}}},  // lower right, upper left
    {{{1, 2}}},          // all but upper right
    {{{3, 1}}},          // upper
    {{{0, 1}}},          // all but lower right
    {{{3, 0}}},          // all but lower left
    {},
}};

Edge edge_of(int i, int j, int side) {
  switch (side) {
    case 0:
      return {i, j, false};
    case 1:
      return {i + 1, j, true};
    case 2:
      return {i, j + 1, false};
    default:
      return {i, j, true};
  }
}

/// Follows the steps from cell to cell.
class Tracer {
 public:
  Tracer(const Grid& grid, const std::vector<char>& inside,
         const std::function<Vec2(const Vec2&, const Vec2&)>& crossing)
      : grid_(grid), inside_(inside), crossing_(crossing), next_(2 * grid.size(), kNone) {}

  std::vector<Outline> run() {
    for (int j = 0; j + 1 < grid_.ny; ++j)
      for (int i = 0; i + 1 < grid_.nx; ++i)
        for (const Step& s : kSteps[corners(i, j)])
          if (s.from >= 0) next_[id(edge_of(i, j, s.from))] = static_cast<std::uint32_t>(id(edge_of(i, j, s.to)));
    std::vector<Outline> out;
    for (std::size_t k = 0; k < next_.size(); ++k)
      if (next_[k] != kNone) out.push_back(follow(k));
    return out;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::size_t corners(int i, int j) const {
    const auto bit = [&](int di, int dj) { return inside_[grid_.index(i + di, j + dj)] ? 1U : 0U; };
    return bit(0, 0) | bit(1, 0) << 1 | bit(1, 1) << 2 | bit(0, 1) << 3;
  }
  std::size_t id(const Edge& e) const { return 2 * grid_.index(e.i, e.j) + (e.upright ? 1 : 0); }

  Outline follow(std::size_t k) {
    Outline out;
    while (next_[k] != kNone) {
      out.push_back(place(k));
      const std::size_t to = next_[k];
      next_[k] = kNone;
      k = to;
    }
    return out;
  }

  Vec2 place(std::size_t k) const {
    const bool upright = k % 2 == 1;
    const int i = static_cast<int>(k / 2 % static_cast<std::size_t>(grid_.nx));
    const int j = static_cast<int>(k / 2 / static_cast<std::size_t>(grid_.nx));
    const Vec2 a = grid_.at(i, j), b = upright ? grid_.at(i, j + 1) : grid_.at(i + 1, j);
    return inside_[grid_.index(i, j)] ? crossing_(a, b) : crossing_(b, a);
  }

  const Grid& grid_;
  const std::vector<char>& inside_;
  const std::function<Vec2(const Vec2&, const Vec2&)>& crossing_;
  std::vector<std::uint32_t> next_;
};

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Returns the index of the point at least `leg_mm` away from `from`, in steps of `way`.
std::size_t away(const Outline& loop, std::size_t from, bool forwards, double leg_mm) {
  const std::size_t n = loop.size();
  std::size_t k = from;
  for (int tries = 0; tries < 4; ++tries) {
    k = forwards ? (k + 1) % n : (k + n - 1) % n;
    if ((loop[k] - loop[from]).norm() >= leg_mm) break;
  }
  return k;
}

/// Returns where the chords before loop[a] and behind loop[b] meet, if that is a corner ahead of both.
std::optional<Vec2> corner_between(const Outline& loop, std::size_t a, std::size_t b, double reach_mm) {
  const double leg = 0.5 * reach_mm;
  const Vec2 before = loop[a] - loop[away(loop, a, false, leg)], behind = loop[away(loop, b, true, leg)] - loop[b];
  const double lengths = before.norm() * behind.norm();
  constexpr double kStraight = 0.2, kBack = -0.95;  // sine and cosine of the turn
  if (lengths <= 0 || std::abs(cross(before, behind)) < kStraight * lengths || before.dot(behind) < kBack * lengths)
    return std::nullopt;
  const Vec2 gap = loop[b] - loop[a];
  const double s = cross(gap, behind) / cross(before, behind), t = cross(gap, before) / cross(before, behind);
  // loop[a] + s before = loop[b] + t behind
  if (s * before.norm() < 1e-4 || s * before.norm() > 2 * reach_mm || -t * behind.norm() < 1e-4 ||
      -t * behind.norm() > 2 * reach_mm)
    return std::nullopt;
  return Vec2(loop[a] + s * before);
}

class ChordRefiner {
 public:
  ChordRefiner(const Inside& inside, double tolerance_mm) : inside_(inside), tolerance_mm_(tolerance_mm) {}

  /// Appends what is needed between two points, and the second one.
  void between(const Vec2& a, const Vec2& b, Outline& out, int depth = 0) const {
    const Vec2 chord = b - a;
    constexpr int kDeepest = 8;
    if (chord.norm() > 10 * tolerance_mm_ && depth < kDeepest) {
      const Vec2 middle = 0.5 * (a + b), outward = Vec2(chord.y(), -chord.x()) / chord.norm();
      if (const auto place = bulge(middle, outward, 0.5 * chord.norm())) {
        between(a, *place, out, depth + 1);
        between(*place, b, out, depth + 1);
        return;
      }
    }
    out.push_back(b);
  }

 private:
  /// The border beside a chord's middle where it is farther than the tolerance.
  std::optional<Vec2> bulge(const Vec2& middle, const Vec2& outward, double most_mm) const {
    if (inside_(middle)) {
      const Vec2 near = middle + tolerance_mm_ * outward;
      if (!inside_(near)) return std::nullopt;
      const Vec2 far = middle + most_mm * outward;
      return inside_(far) ? std::nullopt : std::optional(last_inside(inside_, near, far, 0.1 * tolerance_mm_));
    }
    const Vec2 within = middle - most_mm * outward;
    if (!inside_(within)) return std::nullopt;
    return last_inside(inside_, within, middle, 0.1 * tolerance_mm_);
  }

  const Inside& inside_;
  double tolerance_mm_;
};

}  // namespace

std::vector<Outline> outlines(const Grid& grid, const std::vector<char>& inside,
                              const std::function<Vec2(const Vec2&, const Vec2&)>& crossing) {
  return Tracer(grid, inside, crossing).run();
}

Vec2 last_inside(const Inside& inside, Vec2 in, Vec2 out, double tolerance_mm) {
  while ((out - in).norm() > tolerance_mm) {
    const Vec2 middle = 0.5 * (in + out);
    (inside(middle) ? in : out) = middle;
  }
  return in;
}

Outline refined(const Outline& coarse, const Inside& inside, double tolerance_mm, double reach_mm) {
  Outline corners;
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    const std::size_t next = (k + 1) % coarse.size();
    corners.push_back(coarse[k]);
    if (coarse.size() < 4) continue;
    if (const auto corner = corner_between(coarse, k, next, reach_mm)) {
      const Vec2 middle = 0.5 * (coarse[k] + coarse[next]);
      if (inside(*corner))
        corners.push_back(*corner);
      else if (inside(middle))
        corners.push_back(last_inside(inside, middle, *corner, 0.1 * tolerance_mm));
    }
  }
  const ChordRefiner refiner(inside, tolerance_mm);
  Outline out;
  for (std::size_t k = 0; k < corners.size(); ++k) refiner.between(corners[k], corners[(k + 1) % corners.size()], out);
  return out;
}

}  // namespace camber::copymill
