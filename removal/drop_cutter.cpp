#include "removal/drop_cutter.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::removal {
namespace {

constexpr std::uint32_t kLeaf = 4;
constexpr double kNothing = -std::numeric_limits<double>::infinity();

}  // namespace

DropCutter::DropCutter(const TriangleMesh& mesh, const CutterShape& shape) : cutter_(underside_of(shape)) {
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
  double top = kNothing;
  for (std::uint32_t k = begin; k < end; ++k)
    for (const Vec3& p : facets_[k].corner) {
      low = low.cwiseMin(p.head<2>()), high = high.cwiseMax(p.head<2>());
      top = std::max(top, p.z());
    }
  nodes_[node] = {low, high, top, begin, end};
  if (end - begin <= kLeaf) return;
  const int axis = high.x() - low.x() > high.y() - low.y() ? 0 : 1;
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

/// What the box could lift the tip to, were its highest point the one that is nearest to the axis.
double DropCutter::most(const Node& node, const Vec2& axis) const {
  const Vec2 away = (node.min - axis).cwiseMax(axis - node.max).cwiseMax(0.0);
  const double r = away.norm();
  return r < cutter_.radius_mm() ? node.top - cutter_.height_mm(r) : kNothing;
}

void DropCutter::offer(std::uint32_t facet, const Vec2& axis, std::optional<Contact>& best) const {
  auto contact = contact_with(cutter_, facets_[facet], axis);
  if (!contact || (best && contact->tip_mm <= best->tip_mm)) return;
  contact->triangle = facet;
  best = contact;
}

void DropCutter::search(std::uint32_t at, const Vec2& axis, std::optional<Contact>& best) const {
  const Node& node = nodes_[at];
  if (node.end > 0) {
    for (std::uint32_t k = node.begin; k < node.end; ++k) offer(k, axis, best);
    return;
  }
  std::uint32_t first = node.begin, second = node.begin + 1;
  double most_first = most(nodes_[first], axis), most_second = most(nodes_[second], axis);
  if (most_second > most_first) std::swap(first, second), std::swap(most_first, most_second);
  const auto worth = [&](double m) { return m > (best ? best->tip_mm : kNothing); };
  if (worth(most_first)) search(first, axis, best);
  if (worth(most_second)) search(second, axis, best);
}

std::optional<Contact> DropCutter::at(const Vec2& axis, std::optional<std::uint32_t> near) const {
  std::optional<Contact> best;
  if (near && *near < facets_.size()) offer(*near, axis, best);
  if (most(nodes_[0], axis) > (best ? best->tip_mm : kNothing)) search(0, axis, best);
  return best;
}

}  // namespace camber::removal
