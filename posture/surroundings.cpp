#include "posture/surroundings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "base/convex_distance.h"
#include "base/tool_pose.h"
#include "simulate/tool_outline.h"
#include "simulate/tool_surface.h"

namespace camber::posture {
namespace {

constexpr std::uint32_t kLeaf = 4;
constexpr double kTouch_mm = 1e-3;  ///< a cutter nearer than this overlaps

class Facet : public ConvexSolid {
 public:
  explicit Facet(const std::array<Vec3, 3>& corners) : corners_(corners) {}
  Vec3 support(const Vec3& direction) const override {
    return *std::max_element(corners_.begin(), corners_.end(),
                             [&](const Vec3& a, const Vec3& b) { return a.dot(direction) < b.dot(direction); });
  }

 private:
  const std::array<Vec3, 3>& corners_;
};

/// Distance of a point, `out` from the axis and `up` along it, from the cylinder about a piece: a lower bound of that
/// from the piece.
double bound_mm(const ToolShape::Piece& piece, double out, double up) {
  const double across = std::max(out - piece.radius_mm, 0.0);
  const double along = std::max({piece.bottom_mm - up, up - piece.top_mm, 0.0});
  return std::sqrt(across * across + along * along);
}

double from_axis_mm(const Vec3& p) { return std::sqrt(p.x() * p.x() + p.y() * p.y()); }

std::array<Vec3, 3> in_tool(const std::array<Vec3, 3>& triangle, const Mat3& frame, const Vec3& tip_mm) {
  std::array<Vec3, 3> out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = frame.transpose() * (triangle[i] - tip_mm);
  return out;
}

/// The cylinder about the spindle's axis that holds a body on the spindle, above the holder.
void add_spindle(const machine::Body& body, const Vec3& gauge_mm, const Vec3& axis, double gauge_height_mm,
                 double clearance_mm, ToolShape& out) {
  std::vector<Vec3> corners;
  if (body.box_mm) {
    for (int i = 0; i < 8; ++i)
      corners.emplace_back((*body.box_mm)[i & 1].x(), (*body.box_mm)[(i >> 1) & 1].y(), (*body.box_mm)[i >> 2].z());
  } else {
    for (const Eigen::Vector3f& p : read_stl(body.mesh).points) corners.push_back(p.cast<double>());
  }
  double radius = 0, bottom = std::numeric_limits<double>::infinity(), top = -bottom;
  for (const Vec3& corner : corners) {
    const Vec3 q = corner - gauge_mm;
    radius = std::max(radius, q.cross(axis).norm());
    bottom = std::min(bottom, gauge_height_mm + q.dot(axis));
    top = std::max(top, gauge_height_mm + q.dot(axis));
  }
  simulate::TurnedSolid solid(simulate::OutlineRing::Part::holder);
  solid.add(radius, bottom);
  solid.add(radius, top);
  out.add(std::move(solid), clearance_mm);
}

}  // namespace

void ToolShape::add(simulate::TurnedSolid solid, double need_mm) {
  Piece piece{solid, need_mm, solid.radius_mm(), solid.bottom_mm(), solid.top_mm()};
  pieces.push_back(std::move(piece));
}

ToolShape tool_shape(const machine::Tool& tool, const machine::Machine& machine, double clearance_mm) {
  using Part = simulate::OutlineRing::Part;
  ToolShape out;
  out.pivot_mm = tool.type == machine::ToolType::ball ? tool.diameter_mm / 2 : tool.corner_radius_mm;
  const double end = simulate::cutter_end_mm(tool);
  if (end > out.pivot_mm + kCutterSlack_mm) {
    simulate::TurnedSolid flutes(Part::cutter);
    flutes.add(tool.diameter_mm / 2 - kCutterSlack_mm, out.pivot_mm);
    flutes.add(tool.diameter_mm / 2 - kCutterSlack_mm, end);
    out.add(std::move(flutes), kTouch_mm);
  }
  for (simulate::TurnedSolid& solid : simulate::solids_of(tool))
    if (solid.part() != Part::cutter) out.add(std::move(solid), clearance_mm);
  double gauge_height = tool.overhang_mm;
  for (const machine::HolderPart& part : tool.holder) gauge_height += part.length_mm;
  for (const machine::Body& body : machine.bodies)
    if (body.on == "spindle")
      add_spindle(body, machine.kinematics.gauge_point_mm, machine.kinematics.tool_axis.normalized(), gauge_height,
                  clearance_mm, out);
  return out;
}

void Surroundings::add(const TriangleMesh& mesh, const Vec3& shift_mm) {
  for (const auto& t : mesh.triangles) {
    std::array<Vec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = mesh.points[t[i]].cast<double>() + shift_mm;
    triangles_.push_back(corners);
  }
}

void Surroundings::add_box(const Vec3& min_mm, const Vec3& max_mm) {
  const auto corner = [&](int i) {
    return Vec3((i & 1) != 0 ? max_mm.x() : min_mm.x(), (i & 2) != 0 ? max_mm.y() : min_mm.y(),
                (i & 4) != 0 ? max_mm.z() : min_mm.z());
  };
  constexpr std::array<std::array<int, 4>, 6> kFaces{
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  for (const auto& f : kFaces) {
    triangles_.push_back({corner(f[0]), corner(f[1]), corner(f[2])});
    triangles_.push_back({corner(f[0]), corner(f[2]), corner(f[3])});
  }
}

void Surroundings::finish() {
  nodes_.clear();
  if (triangles_.empty()) return;
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(triangles_.size()));
}

void Surroundings::build(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
  Vec3 low = triangles_[begin][0], high = low;
  for (std::uint32_t i = begin; i < end; ++i)
    for (const Vec3& p : triangles_[i]) low = low.cwiseMin(p), high = high.cwiseMax(p);
  Node now;
  now.centre_mm = (low + high) / 2;
  for (std::uint32_t i = begin; i < end; ++i)
    for (const Vec3& p : triangles_[i]) now.radius_mm = std::max(now.radius_mm, (p - now.centre_mm).norm());
  if (end - begin <= kLeaf) {
    now.begin = begin;
    now.end = end;
    nodes_[node] = now;
    return;
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle, triangles_.begin() + end,
                   [&](const auto& a, const auto& b) {
                     return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
                   });
  now.begin = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node] = now;
  nodes_.emplace_back();
  nodes_.emplace_back();
  build(now.begin, begin, middle);
  build(now.begin + 1, middle, end);
}

double Surroundings::room_mm(const ToolShape& tool, const Vec3& tip_mm, const Vec3& axis, double cap_mm) const {
  if (nodes_.empty()) return cap_mm;
  const Mat3 frame = simulate::outline_frame({tip_mm, axis, 0});
  double room = cap_mm;
  const auto least = [&](const Vec3& centre, double radius) {
    double bound = std::numeric_limits<double>::infinity();
    const double out = from_axis_mm(centre);
    for (const ToolShape::Piece& piece : tool.pieces)
      bound = std::min(bound, bound_mm(piece, out, centre.z()) - radius - piece.need_mm);
    return bound;
  };
  struct Open {
    std::uint32_t node;
    double bound;
  };
  const auto opened = [&](std::uint32_t n) {
    return Open{n, least(frame.transpose() * (nodes_[n].centre_mm - tip_mm), nodes_[n].radius_mm)};
  };
  std::array<Open, 128> stack;
  std::size_t size = 0;
  stack[size++] = opened(0);
  while (size > 0) {
    const Open now = stack[--size];
    if (now.bound >= room) continue;
    const Node& node = nodes_[now.node];
    if (node.end == 0) {
      Open a = opened(node.begin), b = opened(node.begin + 1);
      if (a.bound < b.bound) std::swap(a, b);
      stack[size++] = a;
      stack[size++] = b;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const auto corners = in_tool(triangles_[i], frame, tip_mm);
      const Vec3 centre = (corners[0] + corners[1] + corners[2]) / 3;
      const double radius =
          std::max({(corners[0] - centre).norm(), (corners[1] - centre).norm(), (corners[2] - centre).norm()});
      const double out = from_axis_mm(centre);
      for (const ToolShape::Piece& piece : tool.pieces) {
        const double bound = bound_mm(piece, out, centre.z()) - radius - piece.need_mm;
        if (bound >= room) continue;
        room = std::min(room, bound >= 0 ? bound : convex_distance(piece.solid, Facet(corners)) - piece.need_mm);
      }
      if (room < 0) return room;
    }
  }
  return room;
}

bool Surroundings::deepest_point(const Vec3& tip_mm, const Vec3& axis, double radius_mm, double from_mm,
                                 Inside& out) const {
  out.from_axis_mm = radius_mm;
  std::vector<std::uint32_t> open;
  if (!nodes_.empty()) open.push_back(0);
  const auto off = [&](const Vec3& p) { return (p - tip_mm).cross(axis).norm(); };
  const auto look = [&](const Vec3& p) {
    if ((p - tip_mm).dot(axis) <= from_mm) return;
    if (const double e = off(p); e < out.from_axis_mm) out = {p, e};
  };
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (off(node.centre_mm) - node.radius_mm >= out.from_axis_mm ||
        (node.centre_mm - tip_mm).dot(axis) + node.radius_mm <= from_mm)
      continue;
    if (node.end == 0) {
      open.push_back(node.begin);
      open.push_back(node.begin + 1);
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      for (const Vec3& p : triangles_[i]) look(p);
      look((triangles_[i][0] + triangles_[i][1] + triangles_[i][2]) / 3);
    }
  }
  return out.from_axis_mm < radius_mm;
}

}  // namespace camber::posture
