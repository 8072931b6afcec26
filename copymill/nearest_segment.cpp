#include "copymill/nearest_segment.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::copymill {
namespace {

class Sweeper {
 public:
  Sweeper(const Grid& grid, const std::vector<Segment>& segments)
      : grid_(grid), segments_(segments), nearest_(grid.size(), -1), distance_(grid.size(), kFar) {}

  std::vector<float> run() {
    for (std::size_t s = 0; s < segments_.size(); ++s) seed(static_cast<int>(s));
    for (int round = 0; round < 2; ++round) sweep(false), sweep(true);
    return std::move(distance_);
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::infinity();

  void seed(int s) {
    const Segment& segment = segments_[static_cast<std::size_t>(s)];
    const Vec2 lo = grid_.cells(segment[0].cwiseMin(segment[1])), hi = grid_.cells(segment[0].cwiseMax(segment[1]));
    for (int j = static_cast<int>(std::floor(lo.y())) - 1; j <= static_cast<int>(std::ceil(hi.y())) + 1; ++j)
      for (int i = static_cast<int>(std::floor(lo.x())) - 1; i <= static_cast<int>(std::ceil(hi.x())) + 1; ++i)
        if (grid_.holds(i, j)) offer(i, j, s);
  }

  void offer(int i, int j, int s) {
    const std::size_t k = grid_.index(i, j);
    if (s < 0 || s == nearest_[k]) return;
    const auto d = static_cast<float>(distance_mm(segments_[static_cast<std::size_t>(s)], grid_.at(i, j)));
    if (d < distance_[k]) distance_[k] = d, nearest_[k] = s;
  }

  void sweep(bool back) {
    const int sign = back ? -1 : 1;
    for (int a = 0; a < grid_.ny; ++a) {
      const int j = back ? grid_.ny - 1 - a : a;
      for (int b = 0; b < grid_.nx; ++b) {
        const int i = back ? grid_.nx - 1 - b : b;
        for (const auto& [di, dj] : {std::array{-sign, 0}, {0, -sign}, {-sign, -sign}, {sign, -sign}})
          if (grid_.holds(i + di, j + dj)) offer(i, j, nearest_[grid_.index(i + di, j + dj)]);
      }
      for (int b = grid_.nx - 2; b >= 0; --b) {  // against the row's direction
        const int i = back ? grid_.nx - 1 - b : b, from = i + sign;
        if (grid_.holds(from, j)) offer(i, j, nearest_[grid_.index(from, j)]);
      }
    }
  }

  const Grid& grid_;
  const std::vector<Segment>& segments_;
  std::vector<int> nearest_;
  std::vector<float> distance_;
};

}  // namespace

double distance_mm(const Segment& segment, const Vec2& p) {
  const Vec2 along = segment[1] - segment[0];
  const double t =
      along.squaredNorm() > 0 ? std::clamp((p - segment[0]).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0;
  return (p - segment[0] - t * along).norm();
}

std::vector<float> distances_mm(const Grid& grid, const std::vector<Segment>& segments) {
  return Sweeper(grid, segments).run();
}

}  // namespace camber::copymill
