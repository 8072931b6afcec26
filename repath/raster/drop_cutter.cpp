#include "repath/raster/drop_cutter.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::repath {
namespace {

constexpr std::uint32_t kLeaf = 2;
constexpr double kSteepest = 5;     ///< of the planes over the boxes
constexpr double kRounding = 1e-9;  ///< mm, of what a box could lift the cutter to
constexpr double kNothing = -std::numeric_limits<double>::infinity();

}  // namespace

DropCutter::DropCutter(const TriangleMesh& mesh, const removal::CutterShape& shape) : cutter_(underside_of(shape)) {
  facets_.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    facets_.emplace_back(mesh.points[t[0]].cast<double>(), mesh.points[t[1]].cast<double>(),
                         mesh.points[t[2]].cast<double>());
  min_ = Vec3::Constant(-kNothing), max_ = Vec3::Constant(kNothing);
  for (const Facet& f : facets_)
    for (const Vec3& p : f.corner) min_ = min_.cwiseMin(p), max_ = max_.cwiseMax(p);
  nodes_.reserve(facets_.size());
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(facets_.size()));
}

void DropCutter::build(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
  Vec2 low = Vec2::Constant(-kNothing), high = Vec2::Constant(kNothing);
  double top = kNothing, bottom = -kNothing, plane = kNothing;
  Vec3 normal = Vec3::Zero();
  for (std::uint32_t k = begin; k < end; ++k) normal += facets_[k].normal;
  const double level = std::max(normal.z(), normal.head<2>().norm() / kSteepest);
  const Vec2 slope = level > 0 ? Vec2(-normal.head<2>() / level) : Vec2(0, 0);
  for (std::uint32_t k = begin; k < end; ++k)
    for (const Vec3& p : facets_[k].corner) {
      low = low.cwiseMin(p.head<2>()), high = high.cwiseMax(p.head<2>());
      top = std::max(top, p.z()), bottom = std::min(bottom, p.z());
      plane = std::max(plane, p.z() - slope.dot(p.head<2>()));
    }
  nodes_[node] = {low, high, top, slope, plane, begin, end};
  if (end - begin <= kLeaf) return;
  // Across the longest side; across Z too, which parts a block's top from its bottom.
  const Vec3 size(high.x() - low.x(), high.y() - low.y(), top - bottom);
  int axis = 0;
  size.maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(facets_.begin() + begin, facets_.begin() + middle, facets_.begin() + end,
                   [axis](const Facet& a, const Facet& b) {
                     return a.corner[0][axis] + a.corner[1][axis] + a.corner[2][axis] <
                            b.corner[0][axis] + b.corner[1][axis] + b.corner[2][axis];
                   });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].begin = children, nodes_[node].end = 0;
  build(children, begin, middle);
  build(children + 1, middle, end);
}

/// No less than what the box could lift the tip to. Its highest point may be the one that is nearest to the axis; and
/// under the plane, height less underside is concave, so that it lies below its tangent at any place of the box.
double DropCutter::upper_bound_mm(const Node& node, const Vec2& axis) const {
  const Vec2 nearest = axis.cwiseMax(node.min).cwiseMin(node.max);
  const double r = (nearest - axis).norm(), radius = cutter_.radius_mm();
  if (!(r < radius)) return kNothing;
  const double by_top = node.top - cutter_.height_mm(r);
  // Where the cutter would touch the plane, or what of the box is nearest to that.
  const double steep = node.slope.norm();
  const Vec2 uphill = steep > 0 ? Vec2(node.slope / steep) : Vec2(0, 0);
  const double reach = steep > 0 ? cutter_.flat_mm + cutter_.corner_mm * steep / std::sqrt(1 + steep * steep) : 0.0;
  Vec2 at = (axis + reach * uphill).cwiseMax(node.min).cwiseMin(node.max);
  double out = (at - axis).norm();
  if (!(out < 0.999 * radius)) at = nearest, out = r;
  const double beyond = out - cutter_.flat_mm;
  const double steepness =
      beyond > 0 ? beyond / std::sqrt(std::max(1e-300, (cutter_.corner_mm - beyond) * (cutter_.corner_mm + beyond)))
                 : 0;
  const Vec2 gradient = out > 0 ? Vec2(node.slope - steepness / out * (at - axis)) : node.slope;
  const Vec2 rest = (gradient.array() > 0).select(node.max - at, node.min - at);
  const double by_plane = node.plane + node.slope.dot(at) - cutter_.height_mm(out) + gradient.dot(rest);
  return std::min(by_top, by_plane) + kRounding;
}

void DropCutter::offer(std::uint32_t facet, const Vec2& axis, std::optional<DropContact>& best) const {
  auto contact = contact_with(cutter_, facets_[facet], axis);
  if (!contact || (best && contact->tip_mm <= best->tip_mm)) return;
  contact->triangle = facet;
  best = contact;
}

void DropCutter::search(std::uint32_t at, const Vec2& axis, std::optional<DropContact>& best) const {
  const Node& node = nodes_[at];
  if (node.end > 0) {
    for (std::uint32_t k = node.begin; k < node.end; ++k) offer(k, axis, best);
    return;
  }
  std::uint32_t first = node.begin, second = node.begin + 1;
  double max_first = upper_bound_mm(nodes_[first], axis), max_second = upper_bound_mm(nodes_[second], axis);
  if (max_second > max_first) std::swap(first, second), std::swap(max_first, max_second);
  const auto worth = [&](double m) { return m > (best ? best->tip_mm : kNothing); };
  if (worth(max_first)) search(first, axis, best);
  if (worth(max_second)) search(second, axis, best);
}

std::optional<DropContact> DropCutter::at(const Vec2& axis, std::optional<std::uint32_t> near) const {
  std::optional<DropContact> best;
  if (near && *near < facets_.size()) offer(*near, axis, best);
  if (upper_bound_mm(nodes_[0], axis) > (best ? best->tip_mm : kNothing)) search(0, axis, best);
  return best;
}

}  // namespace camber::repath
