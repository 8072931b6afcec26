#include "removal/form_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/diagnostics.h"
#include "base/triangle_mesh.h"

namespace camber::removal {
namespace {

/// Where of a triangle a place lies: on a corner, on the edge from corner i to the next, or within.
enum class Feature : std::uint8_t { corner0, corner1, corner2, edge0, edge1, edge2, face };

struct Nearest {
  Vec3 place_mm;
  Feature feature;
};

/// The place of a triangle that is nearest to p, by the regions of its plane.
Nearest nearest_on(const std::array<Vec3, 3>& t, const Vec3& p) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0], bp = p - t[1], cp = p - t[2];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {t[0], Feature::corner0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {t[1], Feature::corner1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {t[0] + d1 / (d1 - d3) * ab, Feature::edge0};
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {t[2], Feature::corner2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {t[0] + d2 / (d2 - d6) * ac, Feature::edge2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6)
    return {t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]), Feature::edge1};
  const double sum = va + vb + vc;
  return {t[0] + vb / sum * ab + vc / sum * ac, Feature::face};
}

double angle_rad(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

struct Box {
  Eigen::Vector3f lo = Eigen::Vector3f::Constant(std::numeric_limits<float>::max()), hi = -lo;
  void add(const Eigen::Vector3f& p) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  double squared_distance(const Vec3& p) const {
    return (lo.cast<double>() - p).cwiseMax(p - hi.cast<double>()).cwiseMax(0).squaredNorm();
  }
};

}  // namespace

class PartMesh::Tree {
 public:
  explicit Tree(const TriangleMesh& mesh) : points_(mesh.points), triangles_(mesh.triangles) {
    build();
    find_normals();
  }

  double distance_mm(const Vec3& p) const;

 private:
  static constexpr std::size_t kLeaf = 4;  ///< triangles

  /// A leaf where `count` is not 0: `first` is a triangle; else the two children stand at `first` and the next place.
  struct Node {
    Box box;
    std::uint32_t first = 0, count = 0;
  };

  /// Where its signs come from: outward normals of its face, its edges and its corners, of any length.
  struct Normals {
    std::array<Eigen::Vector3f, 7> of;  ///< by Feature
  };

  std::array<Vec3, 3> corners(std::size_t triangle) const {
    const auto& t = triangles_[triangle];
    return {points_[t[0]].cast<double>(), points_[t[1]].cast<double>(), points_[t[2]].cast<double>()};
  }
  void build();
  void divide(std::size_t node, std::span<std::uint32_t> order, std::uint32_t first,
              const std::vector<Eigen::Vector3f>& middles);
  void find_normals();

  std::vector<Eigen::Vector3f> points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< in the order of the leaves
  std::vector<Node> nodes_;
  std::vector<Normals> normals_;
};

void PartMesh::Tree::build() {
  std::vector<Eigen::Vector3f> middles;
  middles.reserve(triangles_.size());
  for (const auto& t : triangles_) middles.emplace_back((points_[t[0]] + points_[t[1]] + points_[t[2]]) / 3);
  std::vector<std::uint32_t> order(triangles_.size());
  std::iota(order.begin(), order.end(), 0u);
  nodes_.resize(1);
  divide(0, order, 0, middles);
  std::vector<std::array<std::uint32_t, 3>> sorted;
  sorted.reserve(order.size());
  for (const std::uint32_t t : order) sorted.push_back(triangles_[t]);
  triangles_ = std::move(sorted);
}

/// Halves a node's triangles along the longest side of the box of their middles.
void PartMesh::Tree::divide(std::size_t node, std::span<std::uint32_t> order, std::uint32_t first,
                            const std::vector<Eigen::Vector3f>& middles) {
  Box of_middles;
  for (const std::uint32_t t : order) {
    of_middles.add(middles[t]);
    for (const std::uint32_t c : triangles_[t]) nodes_[node].box.add(points_[c]);
  }
  if (order.size() <= kLeaf) {
    nodes_[node].first = first;
    nodes_[node].count = static_cast<std::uint32_t>(order.size());
    return;
  }
  int axis = 0;
  (of_middles.hi - of_middles.lo).maxCoeff(&axis);
  const std::size_t half = order.size() / 2;
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return std::pair(middles[a][axis], a) < std::pair(middles[b][axis], b);
                   });
  const std::size_t children = nodes_.size();
  nodes_[node].first = static_cast<std::uint32_t>(children);
  nodes_.resize(children + 2);
  divide(children, order.first(half), first, middles);
  divide(children + 1, order.subspan(half), first + static_cast<std::uint32_t>(half), middles);
}

void PartMesh::Tree::find_normals() {
  std::vector<Vec3> at_corner(points_.size(), Vec3::Zero());
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> at_edge;
  std::vector<Vec3> faces(triangles_.size());
  double volume_mm3 = 0;
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    const auto t = corners(k);
    const Vec3 cross = (t[1] - t[0]).cross(t[2] - t[0]);
    volume_mm3 += t[0].dot(cross) / 6;
    faces[k] = cross.norm() > 0 ? cross.normalized() : Vec3::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangles_[k][i], b = triangles_[k][(i + 1) % 3];
      at_corner[a] += angle_rad(t[(i + 1) % 3] - t[i], t[(i + 2) % 3] - t[i]) * faces[k];
      at_edge.try_emplace(std::minmax(a, b), Vec3::Zero()).first->second += faces[k];
    }
  }
  const double outwards = volume_mm3 < 0 ? -1 : 1;  // a mesh that is inside out
  normals_.resize(triangles_.size());
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangles_[k][i], b = triangles_[k][(i + 1) % 3];
      normals_[k].of[i] = (outwards * at_corner[a]).cast<float>();
      normals_[k].of[3 + i] = (outwards * at_edge.at(std::minmax(a, b))).cast<float>();
    }
    normals_[k].of[6] = (outwards * faces[k]).cast<float>();
  }
}

double PartMesh::Tree::distance_mm(const Vec3& p) const {
  double least = std::numeric_limits<double>::max(), side = 0;
  const auto look = [&](std::size_t triangle) {
    const Nearest at = nearest_on(corners(triangle), p);
    const Vec3 away = p - at.place_mm;
    if (const double d = away.squaredNorm(); d < least) {
      least = d;
      side = away.dot(normals_[triangle].of[static_cast<std::size_t>(at.feature)].cast<double>());
    }
  };
  struct Open {
    std::uint32_t node;
    double squared_mm2;
  };
  std::array<Open, 64> open{};  // the tree is halved: no deeper than the bits of an index
  std::size_t count = 1;
  open[0] = {0, nodes_[0].box.squared_distance(p)};
  while (count > 0) {
    const Open now = open[--count];
    if (now.squared_mm2 >= least) continue;
    const Node& node = nodes_[now.node];
    if (node.count > 0) {
      for (std::uint32_t k = 0; k < node.count; ++k) look(node.first + k);
      continue;
    }
    Open near{node.first, nodes_[node.first].box.squared_distance(p)},
        far{node.first + 1, nodes_[node.first + 1].box.squared_distance(p)};
    if (far.squared_mm2 < near.squared_mm2) std::swap(near, far);
    open[count++] = far;
    open[count++] = near;
  }
  return std::copysign(std::sqrt(least), side);
}

PartMesh::PartMesh(const TriangleMesh& closed) : tree_(std::make_unique<Tree>(closed)) {
  Box box;
  for (const auto& p : closed.points) box.add(p);
  min_mm_ = box.lo.cast<double>();
  max_mm_ = box.hi.cast<double>();
}

PartMesh::~PartMesh() = default;
PartMesh::PartMesh(PartMesh&&) noexcept = default;

double PartMesh::distance_mm(const Vec3& point) const { return tree_->distance_mm(point); }

}  // namespace camber::removal
