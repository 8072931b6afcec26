#pragma once
// A part as triangles, for judging: its height under a vertical ray, and distances from its surface. Nothing is taken
// from Camber.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/judge_program.h"

namespace judge {

using Triangle = std::array<Point, 3>;

/// Binary or ASCII STL.
inline std::vector<Triangle> read_stl(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + " cannot be read");
  std::ostringstream all;
  all << file.rdbuf();
  const std::string text = all.str();
  std::vector<Triangle> out;
  std::uint32_t count = 0;
  if (text.size() >= 84) std::memcpy(&count, text.data() + 80, 4);
  if (text.size() >= 84 && text.size() == 84 + 50 * static_cast<std::size_t>(count)) {
    for (std::size_t t = 0; t < count; ++t) {
      std::array<float, 9> v{};
      std::memcpy(v.data(), text.data() + 84 + 50 * t + 12, sizeof v);
      Triangle triangle;
      for (std::size_t c = 0; c < 3; ++c) triangle[c] = {v[3 * c], v[3 * c + 1], v[3 * c + 2]};
      out.push_back(triangle);
    }
    return out;
  }
  std::istringstream words(text);
  std::string word;
  std::vector<Point> corners;
  while (words >> word) {
    if (word != "vertex") continue;
    Point p;
    words >> p.x >> p.y >> p.z;
    corners.push_back(p);
  }
  for (std::size_t c = 0; c + 2 < corners.size(); c += 3) out.push_back({corners[c], corners[c + 1], corners[c + 2]});
  return out;
}

inline Point nearest_on(const Triangle& t, const Point& p) {
  // Regions of the triangle's plane (Ericson, Real-Time Collision Detection, 5.1.5).
  const Point ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return t[0];
  const Point bp = p - t[1];
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return t[1];
  if (const double vc = d1 * d4 - d3 * d2; vc <= 0 && d1 >= 0 && d3 <= 0) return t[0] + d1 / (d1 - d3) * ab;
  const Point cp = p - t[2];
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return t[2];
  if (const double vb = d5 * d2 - d1 * d6; vb <= 0 && d2 >= 0 && d6 <= 0) return t[0] + d2 / (d2 - d6) * ac;
  if (const double va = d3 * d6 - d5 * d4; va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2, sum = va + vb + vc;
  return t[0] + vb / sum * ab + vc / sum * ac;
}

/// Triangles in squares of the plane, for rays and distances.
class PartMesh {
 public:
  static constexpr double kNone = -std::numeric_limits<double>::infinity();

  explicit PartMesh(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
    if (triangles_.empty()) throw std::runtime_error("the part has no triangle");
    lo_ = hi_ = triangles_[0][0];
    for (const Triangle& t : triangles_)
      for (const Point& p : t) {
        lo_ = {std::min(lo_.x, p.x), std::min(lo_.y, p.y), std::min(lo_.z, p.z)};
        hi_ = {std::max(hi_.x, p.x), std::max(hi_.y, p.y), std::max(hi_.z, p.z)};
      }
    const double side = std::sqrt(std::max((hi_.x - lo_.x) * (hi_.y - lo_.y), 1e-9) / 4000);
    square_ = std::max(side, 1e-3);
    nx_ = index((hi_.x - lo_.x) / square_) + 1, ny_ = index((hi_.y - lo_.y) / square_) + 1;
    squares_.resize(static_cast<std::size_t>(nx_ * ny_));
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const Triangle& c = triangles_[t];
      const auto [x0, x1] = std::minmax({c[0].x, c[1].x, c[2].x});
      const auto [y0, y1] = std::minmax({c[0].y, c[1].y, c[2].y});
      for (int i = index((x0 - lo_.x) / square_); i <= index((x1 - lo_.x) / square_); ++i)
        for (int j = index((y0 - lo_.y) / square_); j <= index((y1 - lo_.y) / square_); ++j)
          squares_[place(i, j)].push_back(t);
    }
  }
  const Point& min() const { return lo_; }
  const Point& max() const { return hi_; }

  /// Height of the part's top over a place; kNone beside it.
  double top(double x, double y) const {
    double top = kNone;
    const int i = index((x - lo_.x) / square_), j = index((y - lo_.y) / square_);
    if (i < 0 || j < 0 || i >= nx_ || j >= ny_) return top;
    for (const std::size_t t : squares_[place(i, j)]) {
      const Triangle& c = triangles_[t];
      const double area = side(c[0], c[1], c[2].x, c[2].y);
      if (area == 0) continue;
      const double a = side(c[1], c[2], x, y) / area, b = side(c[2], c[0], x, y) / area, d = 1 - a - b;
      if (a >= 0 && b >= 0 && d >= 0) top = std::max(top, a * c[0].z + b * c[1].z + d * c[2].z);
    }
    return top;
  }

  /// Distance of the part's surface from a point, up to `most`.
  double distance(const Point& p, double most) const {
    double nearest = most;
    const int i = index((p.x - lo_.x) / square_), j = index((p.y - lo_.y) / square_);
    const int rings = index(most / square_) + 1;
    for (int r = 0; r <= rings && (r - 1) * square_ < nearest; ++r)
      for (int a = std::max(0, i - r); a <= std::min(nx_ - 1, i + r); ++a)
        for (int b = std::max(0, j - r); b <= std::min(ny_ - 1, j + r); ++b) {
          if (std::max(std::abs(a - i), std::abs(b - j)) != r) continue;
          for (const std::size_t t : squares_[place(a, b)])
            nearest = std::min(nearest, length(p - nearest_on(triangles_[t], p)));
        }
    return nearest;
  }

 private:
  static int index(double v) { return static_cast<int>(std::floor(v)); }
  std::size_t place(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(ny_) + static_cast<std::size_t>(j);
  }
  static double side(const Point& a, const Point& b, double x, double y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
  }

  std::vector<Triangle> triangles_;
  Point lo_, hi_;
  double square_ = 1;
  int nx_ = 1, ny_ = 1;
  std::vector<std::vector<std::size_t>> squares_;
};

}  // namespace judge
