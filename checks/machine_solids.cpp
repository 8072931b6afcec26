#include "checks/machine_solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/triangle_mesh.h"

namespace camber::checks {
namespace {

constexpr double kOutlineStep_mm = 0.5;
/// A pair of spheres so much smaller than their distance is not looked into.
constexpr double kFar = 0.25;
constexpr std::size_t kHullsOfLeaf = 4;

class Hull : public ConvexSolid {
 public:
  explicit Hull(std::span<const Vec3> points) : points_(points) {}
  Vec3 support(const Vec3& direction) const override {
    return *std::ranges::max_element(points_, {}, [&](const Vec3& p) { return p.dot(direction); });
  }

 private:
  std::span<const Vec3> points_;
};

class Moved : public ConvexSolid {
 public:
  Moved(const ConvexSolid& solid, const Eigen::Isometry3d& motion) : solid_(solid), motion_(motion) {}
  Vec3 support(const Vec3& direction) const override {
    return motion_ * solid_.support(motion_.linear().transpose() * direction);
  }

 private:
  const ConvexSolid& solid_;
  const Eigen::Isometry3d& motion_;
};

constexpr double kRounding_mm2 = 1e-9;

/// Returns twice the area of the triangle that three circles of a profile span: positive where it bends outwards.
double bend_mm2(const OutlineRing& a, const OutlineRing& b, const OutlineRing& c) {
  return (b.radius_mm - a.radius_mm) * (c.height_mm - b.height_mm) -
         (b.height_mm - a.height_mm) * (c.radius_mm - b.radius_mm);
}

/// Runs of rings of one part with a convex profile; neighbours share a ring. Rings on a straight line are left out.
std::vector<std::vector<OutlineRing>> convex_runs(const std::vector<OutlineRing>& rings) {
  std::vector<std::vector<OutlineRing>> out;
  for (const OutlineRing& ring : rings) {
    const bool same = !out.empty() && out.back().back().part == ring.part;
    if (!same) {
      out.push_back({ring});
      continue;
    }
    std::vector<OutlineRing>& run = out.back();
    const OutlineRing& last = run.back();
    if (last.radius_mm == ring.radius_mm && last.height_mm == ring.height_mm) continue;
    const double bend = run.size() < 2 ? 1 : bend_mm2(run[run.size() - 2], last, ring);
    if (std::abs(bend) <= kRounding_mm2)
      run.back() = ring;
    else if (bend > 0)
      run.push_back(ring);
    else
      out.push_back({last, ring});
  }
  return out;
}

/// A face between two parts has no thickness; what is above it has.
bool flat(const std::vector<OutlineRing>& run) {
  return run.back().height_mm - run.front().height_mm < 3 * kContact_mm;
}

TurnedSolid shrunk(const std::vector<OutlineRing>& run) {
  TurnedSolid out(run.front().part);
  const double low = run.front().height_mm + kContact_mm, high = run.back().height_mm - kContact_mm;
  for (const OutlineRing& ring : run)
    out.add(std::max(0.0, ring.radius_mm - kContact_mm), std::clamp(ring.height_mm, low, high));
  return out;
}

BodySolid::Sphere sphere_about(const Vec3& lo, const Vec3& hi) { return {(lo + hi) / 2, (hi - lo).norm() / 2}; }

}  // namespace

Vec3 TurnedSolid::support(const Vec3& direction) const {
  const double across = std::sqrt(direction.x() * direction.x() + direction.y() * direction.y());
  const Circle& c = *std::ranges::max_element(
      circles_, {}, [&](const Circle& circle) { return circle.radius_mm * across + circle.height_mm * direction.z(); });
  if (across == 0) return {c.radius_mm, 0, c.height_mm};
  return {c.radius_mm * direction.x() / across, c.radius_mm * direction.y() / across, c.height_mm};
}

double TurnedSolid::radius_mm() const { return std::ranges::max_element(circles_, {}, &Circle::radius_mm)->radius_mm; }

std::vector<TurnedSolid> solids_of(const machine::Tool& tool) {
  std::vector<TurnedSolid> out;
  for (const auto& run : convex_runs(tool_outline(tool, kOutlineStep_mm, 1e6)))
    if (!flat(run)) out.push_back(shrunk(run));
  return out;
}

BodySolid::BodySolid(const machine::Body& body) {
  if (body.box_mm) {
    hull_size_ = 8;
    for (int c = 0; c < 8; ++c)
      points_.emplace_back((*body.box_mm)[c & 1 ? 1 : 0].x(), (*body.box_mm)[c & 2 ? 1 : 0].y(),
                           (*body.box_mm)[c & 4 ? 1 : 0].z());
  } else {
    const TriangleMesh mesh = read_mesh(body.mesh);
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle) points_.push_back(mesh.points[corner].cast<double>());
  }
  min_mm_ = max_mm_ = points_.front();
  for (const Vec3& p : points_) min_mm_ = min_mm_.cwiseMin(p), max_mm_ = max_mm_.cwiseMax(p);
  std::vector<std::size_t> order(points_.size() / hull_size_);
  std::iota(order.begin(), order.end(), std::size_t{0});
  nodes_.emplace_back();
  split(0, 0, order.size(), order);
  std::vector<Vec3> ordered;
  ordered.reserve(points_.size());
  for (const std::size_t i : order) ordered.insert(ordered.end(), hull(i).begin(), hull(i).end());
  points_ = std::move(ordered);
}

/// Halves at the median of the longest side.
void BodySolid::split(std::size_t node, std::size_t first, std::size_t count, std::vector<std::size_t>& order) {
  Vec3 lo = hull(order[first]).front(), hi = lo;
  for (std::size_t i = first; i < first + count; ++i)
    for (const Vec3& p : hull(order[i])) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  nodes_[node] = {sphere_about(lo, hi), first, count};
  if (count <= kHullsOfLeaf) return;
  Eigen::Index axis = 0;
  (hi - lo).maxCoeff(&axis);
  const auto middle = [&](std::size_t i) {
    double sum = 0;
    for (const Vec3& p : hull(i)) sum += p[axis];
    return sum;
  };
  const auto at = order.begin() + static_cast<std::ptrdiff_t>(first);
  const std::size_t half = count / 2;
  std::nth_element(at, at + static_cast<std::ptrdiff_t>(half), at + static_cast<std::ptrdiff_t>(count),
                   [&](std::size_t a, std::size_t b) { return std::pair(middle(a), a) < std::pair(middle(b), b); });
  const std::size_t children = nodes_.size();
  nodes_.resize(children + 2);
  split(children, first, half, order);
  split(children + 1, first + half, count - half, order);
  nodes_[node].first = children;
  nodes_[node].count = 0;
}

/// Van Oosterom & Strackee 1983.
bool BodySolid::mesh_holds(const Vec3& point) const {
  if (hull_size_ != 3) return false;
  double angle = 0;
  for (std::size_t i = 0; i < points_.size(); i += 3) {
    const Vec3 a = points_[i] - point, b = points_[i + 1] - point, c = points_[i + 2] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(angle) > 2 * kPi;
}

namespace {

/// Distance of a point to the cylinder around a turned solid.
double cylinder_mm(const TurnedSolid& solid, double radius_mm, const Vec3& p) {
  const double out = std::hypot(p.x(), p.y()) - radius_mm;
  const double above = std::max(p.z() - solid.top_mm(), solid.bottom_mm() - p.z());
  return out > 0 && above > 0 ? std::hypot(out, above) : std::max(out, above);
}

/// The least distance of a tool's pieces to a body, branch by branch.
class ToolSearch {
 public:
  ToolSearch(const std::vector<TurnedSolid>& tool, const Eigen::Isometry3d& body_from_tool, const BodySolid& body)
      : tool_(tool), body_from_tool_(body_from_tool), tool_from_body_(body_from_tool.inverse()), body_(body) {
    for (const TurnedSolid& solid : tool) radius_mm_.push_back(solid.radius_mm());
  }

  SolidDistance run() {
    for (std::size_t i = 0; i < tool_.size(); ++i) look(i, 0);
    return best_;
  }

 private:
  void look(std::size_t piece, std::size_t at) {
    const BodySolid::Node& node = body_.nodes()[at];
    const double clear = clearance_mm(piece, at);
    if (clear >= best_.at_least_mm) return;
    if (clear > 0 && node.sphere.radius_mm <= kFar * clear) return take(piece, clear);
    if (!node.leaf()) {
      const bool swap = clearance_mm(piece, node.first + 1) < clearance_mm(piece, node.first);
      look(piece, node.first + (swap ? 1 : 0));
      return look(piece, node.first + (swap ? 0 : 1));
    }
    const Moved solid(tool_[piece], body_from_tool_);
    for (std::size_t i = node.first; i < node.first + node.count; ++i)
      take(piece, convex_distance(solid, Hull(body_.hull(i))));
  }

  double clearance_mm(std::size_t piece, std::size_t at) const {
    const BodySolid::Sphere& sphere = body_.nodes()[at].sphere;
    return cylinder_mm(tool_[piece], radius_mm_[piece], tool_from_body_ * sphere.centre_mm) - sphere.radius_mm;
  }

  void take(std::size_t piece, double distance_mm) {
    if (distance_mm < best_.at_least_mm) best_ = {distance_mm, piece};
  }

  const std::vector<TurnedSolid>& tool_;
  const Eigen::Isometry3d& body_from_tool_;
  Eigen::Isometry3d tool_from_body_;
  const BodySolid& body_;
  std::vector<double> radius_mm_;
  SolidDistance best_{std::numeric_limits<double>::infinity(), 0};
};

class BodySearch {
 public:
  BodySearch(const BodySolid& a, const Eigen::Isometry3d& a_from_b, const BodySolid& b)
      : a_(a), b_(b), a_from_b_(a_from_b) {}

  double run() {
    look(0, 0);
    return best_mm_;
  }

 private:
  void look(std::size_t of_a, std::size_t of_b) {
    const BodySolid::Node &a = a_.nodes()[of_a], &b = b_.nodes()[of_b];
    const double sizes = a.sphere.radius_mm + b.sphere.radius_mm;
    const double clear = (a.sphere.centre_mm - a_from_b_ * b.sphere.centre_mm).norm() - sizes;
    if (clear >= best_mm_) return;
    if (clear > 0 && sizes <= kFar * clear) {
      best_mm_ = clear;
    } else if (a.leaf() && b.leaf()) {
      for (std::size_t i = a.first; i < a.first + a.count; ++i)
        for (std::size_t j = b.first; j < b.first + b.count; ++j) {
          const Hull hull(b_.hull(j));
          best_mm_ = std::min(best_mm_, convex_distance(Hull(a_.hull(i)), Moved(hull, a_from_b_)));
        }
    } else if (b.leaf() || (!a.leaf() && a.sphere.radius_mm > b.sphere.radius_mm)) {
      look(a.first, of_b);
      look(a.first + 1, of_b);
    } else {
      look(of_a, b.first);
      look(of_a, b.first + 1);
    }
  }

  const BodySolid &a_, &b_;
  const Eigen::Isometry3d& a_from_b_;
  double best_mm_ = std::numeric_limits<double>::infinity();
};

}  // namespace

SolidDistance distance(const std::vector<TurnedSolid>& tool, const Eigen::Isometry3d& body_from_tool,
                       const BodySolid& body) {
  return ToolSearch(tool, body_from_tool, body).run();
}

double distance_mm(const BodySolid& a, const Eigen::Isometry3d& a_from_b, const BodySolid& b) {
  return BodySearch(a, a_from_b, b).run();
}

}  // namespace camber::checks
