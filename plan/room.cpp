#include "plan/order.h"

#include <algorithm>
#include <cmath>

namespace camber::plan {
namespace {

constexpr double kFar = 1e20;

/// Squared distances in steps to the places where f is 0, along one line: the lower envelope of parabolas
/// (Felzenszwalb and Huttenlocher, Theory of Computing 8, 2012, 415).
void along_line(std::vector<double>& f, std::vector<int>& vertex, std::vector<double>& from) {
  const int n = static_cast<int>(f.size());
  vertex.assign(f.size(), 0);
  from.assign(f.size() + 1, 0);
  const std::vector<double> given = f;
  const auto value = [&](int i) { return given[static_cast<std::size_t>(i)]; };
  int last = 0;
  from[0] = -kFar, from[1] = kFar;
  for (int q = 1; q < n; ++q) {
    const auto crossing = [&](int v) {
      return ((value(q) + static_cast<double>(q) * q) - (value(v) + static_cast<double>(v) * v)) / (2.0 * (q - v));
    };
    double s = crossing(vertex[static_cast<std::size_t>(last)]);
    while (s <= from[static_cast<std::size_t>(last)]) s = crossing(vertex[static_cast<std::size_t>(--last)]);
    vertex[static_cast<std::size_t>(++last)] = q;
    from[static_cast<std::size_t>(last)] = s;
    from[static_cast<std::size_t>(last) + 1] = kFar;
  }
  int k = 0;
  for (int q = 0; q < n; ++q) {
    while (from[static_cast<std::size_t>(k) + 1] < q) ++k;
    const int v = vertex[static_cast<std::size_t>(k)];
    f[static_cast<std::size_t>(q)] = static_cast<double>(q - v) * (q - v) + value(v);
  }
}

/// Squared distance of each place to the nearest marked one, in steps.
std::vector<double> squared_distances(const std::vector<char>& marked, int nx, int ny) {
  std::vector<double> out(marked.size());
  for (std::size_t k = 0; k < marked.size(); ++k) out[k] = marked[k] != 0 ? 0 : kFar;
  std::vector<double> line, from;
  std::vector<int> vertex;
  const auto pass = [&](int count, int length, int between, int step) {
    line.resize(static_cast<std::size_t>(length));
    for (int a = 0; a < count; ++a) {
      const auto place = [&](int b) {
        return static_cast<std::size_t>(a) * static_cast<std::size_t>(between) +
               static_cast<std::size_t>(b) * static_cast<std::size_t>(step);
      };
      for (int b = 0; b < length; ++b) line[static_cast<std::size_t>(b)] = out[place(b)];
      along_line(line, vertex, from);
      for (int b = 0; b < length; ++b) out[place(b)] = std::min(line[static_cast<std::size_t>(b)], kFar);
    }
  };
  pass(nx, ny, ny, 1);
  pass(ny, nx, 1, ny);
  return out;
}

}  // namespace

double Rect::distance(double x, double y) const {
  return std::hypot(std::max({x0 - x, x - x1, 0.0}), std::max({y0 - y, y - y1, 0.0}));
}

double Rect::distance(const Rect& o) const {
  return std::hypot(std::max({x0 - o.x1, o.x0 - x1, 0.0}), std::max({y0 - o.y1, o.y0 - y1, 0.0}));
}

Room::Room(const TriangleSolid& stays, const Rect& middles, double radius_mm, double above_mm)
    : middles_(middles), radius_mm_(radius_mm), low_(middles.x0 - radius_mm, middles.y0 - radius_mm) {
  const double w = middles.x1 - middles.x0 + 2 * radius_mm, h = middles.y1 - middles.y0 + 2 * radius_mm;
  constexpr double kFewest = 200, kMost = 800, kPerRadius = 12;
  step_mm_ = std::max(std::max(w, h) / kMost, std::min(std::max(w, h) / kFewest, radius_mm / kPerRadius));
  nx_ = static_cast<int>(std::ceil(w / step_mm_)), ny_ = static_cast<int>(std::ceil(h / step_mm_));
  stands_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_), 0);
  for (const Triangle& t : stays.triangles) stand(stays, t, above_mm);
}

void Room::stand(const TriangleSolid& stays, const Triangle& t, double above_mm) {
  const Vec3 n = stays.normal_by_area(t);
  if (n.z() <= 0) return;
  const Vec3 &a = stays.corner(t, 0), &b = stays.corner(t, 1), &c = stays.corner(t, 2);
  if (std::max({a.z(), b.z(), c.z()}) <= above_mm) return;
  const auto first = [&](double least, double low) {
    return static_cast<int>(std::ceil((least - low) / step_mm_ - 0.5));
  };
  const int i0 = std::max(0, first(std::min({a.x(), b.x(), c.x()}), low_.x()));
  const int j0 = std::max(0, first(std::min({a.y(), b.y(), c.y()}), low_.y()));
  const double x1 = std::max({a.x(), b.x(), c.x()}), y1 = std::max({a.y(), b.y(), c.y()});
  const auto side = [](const Vec3& p, const Vec3& q, double px, double py) {
    return (q.x() - p.x()) * (py - p.y()) - (q.y() - p.y()) * (px - p.x());
  };
  for (int i = i0; i < nx_ && x(i) <= x1; ++i)
    for (int j = j0; j < ny_ && y(j) <= y1; ++j) {
      const double u = side(b, c, x(i), y(j)), v = side(c, a, x(i), y(j)), w = side(a, b, x(i), y(j));
      if (u < 0 || v < 0 || w < 0) continue;
      if ((u * a.z() + v * b.z() + w * c.z()) / (u + v + w) > above_mm) stands_[at(i, j)] = 1;
    }
}

double Room::standing_mm2(const std::function<bool(double, double)>& wanted) const {
  double sum = 0;
  for (int i = 0; i < nx_; ++i)
    for (int j = 0; j < ny_; ++j)
      if (stands_[at(i, j)] != 0 && wanted(x(i), y(j))) sum += step_mm_ * step_mm_;
  return sum;
}

double Room::unreached_mm2(const std::function<bool(double, double)>& wanted) const {
  // An outline is within half a step of where the grid has it.
  constexpr double kSlack = 0.75;
  const double radius = radius_mm_ / step_mm_;
  const double free = std::max(radius - kSlack, 0.0), reach = radius + kSlack;
  const std::vector<double> to_obstacle = squared_distances(stands_, nx_, ny_);
  std::vector<char> middle(stands_.size(), 0);
  for (int i = 0; i < nx_; ++i)
    for (int j = 0; j < ny_; ++j)
      middle[at(i, j)] = middles_.distance(x(i), y(j)) < 0.5 * step_mm_ && to_obstacle[at(i, j)] > free * free ? 1 : 0;
  const std::vector<double> to_middle = squared_distances(middle, nx_, ny_);
  double missed = 0;
  for (int i = 0; i < nx_; ++i)
    for (int j = 0; j < ny_; ++j)
      if (stands_[at(i, j)] == 0 && to_middle[at(i, j)] > reach * reach && wanted(x(i), y(j))) missed += 1;
  return missed * step_mm_ * step_mm_;
}

}  // namespace camber::plan
