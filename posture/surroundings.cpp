#include "posture/surroundings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>

#include "base/convex_distance.h"
#include "base/tool_pose.h"
#include "base/triangle_mesh.h"
#include "checks/tool_outline.h"
#include "checks/tool_surface.h"

namespace camber::posture {
namespace {

constexpr std::uint32_t kLeaf = 4;
constexpr double kFar_mm = std::numeric_limits<double>::infinity();
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

/// Returns whether a triangle, in the tool's frame, is nearer to the piece than it needs to be.
bool too_near(const ToolShape::Piece& piece, const std::array<Vec3, 3>& corners) {
  const Vec3 centre = (corners[0] + corners[1] + corners[2]) / 3;
  const double out = centre.head<2>().norm(), across = out > 0 ? std::min(out, piece.radius_mm) / out : 0;
  const Vec3 nearest(across * centre.x(), across * centre.y(), std::clamp(centre.z(), piece.bottom_mm, piece.top_mm));
  Vec3 off = nearest - centre;
  if (off.squaredNorm() < 1e-12) off = Vec3::UnitZ();
  return convex_nearer(piece.solid, Facet(corners), piece.need_mm, off);
}

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
    for (const Eigen::Vector3f& p : read_mesh(body.mesh).points) corners.push_back(p.cast<double>());
  }
  double radius = 0, bottom = std::numeric_limits<double>::infinity(), top = -bottom;
  for (const Vec3& corner : corners) {
    const Vec3 q = corner - gauge_mm;
    radius = std::max(radius, q.cross(axis).norm());
    bottom = std::min(bottom, gauge_height_mm + q.dot(axis));
    top = std::max(top, gauge_height_mm + q.dot(axis));
  }
  checks::TurnedSolid solid(checks::OutlineRing::Part::holder);
  solid.add(radius, bottom);
  solid.add(radius, top);
  out.add(std::move(solid), clearance_mm);
}

}  // namespace

void ToolShape::add(checks::TurnedSolid solid, double need_mm) {
  Piece piece{solid, need_mm, solid.radius_mm(), solid.bottom_mm(), solid.top_mm()};
  pieces.push_back(std::move(piece));
}

ToolShape tool_shape(const machine::Tool& tool, const machine::Machine& machine, double clearance_mm) {
  using Part = checks::OutlineRing::Part;
  ToolShape out;
  out.pivot_mm = tool.type == machine::ToolType::ball ? tool.diameter_mm / 2 : tool.corner_radius_mm;
  const double end = checks::cutter_end_mm(tool);
  if (end > out.pivot_mm + kCutterSlack_mm) {
    checks::TurnedSolid flutes(Part::cutter);
    flutes.add(tool.diameter_mm / 2 - kCutterSlack_mm, out.pivot_mm);
    flutes.add(tool.diameter_mm / 2 - kCutterSlack_mm, end);
    out.add(std::move(flutes), kTouch_mm);
  }
  for (checks::TurnedSolid& solid : checks::solids_of(tool))
    if (solid.part() != Part::cutter) out.add(std::move(solid), clearance_mm);
  double gauge_height = tool.overhang_mm;
  for (const machine::HolderPart& part : tool.holder) gauge_height += part.length_mm;
  for (const machine::Body& body : machine.bodies)
    if (body.on == "spindle")
      add_spindle(body, machine.kinematics.gauge_point_mm, machine.kinematics.tool_axis.normalized(), gauge_height,
                  clearance_mm, out);
  return out;
}

void Surroundings::add(const TriangleMesh& mesh, const Vec3& shift_mm, Obstacle what) {
  for (const auto& t : mesh.triangles) {
    std::array<Vec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = mesh.points[t[i]].cast<double>() + shift_mm;
    tree_of(what).triangles.push_back(corners);
  }
}

void Surroundings::add(std::span<const std::array<Vec3, 3>> triangles, Obstacle what) {
  auto& all = tree_of(what).triangles;
  all.insert(all.end(), triangles.begin(), triangles.end());
}

void Surroundings::add_box(const Vec3& min_mm, const Vec3& max_mm, Obstacle what) {
  const auto corner = [&](int i) {
    return Vec3((i & 1) != 0 ? max_mm.x() : min_mm.x(), (i & 2) != 0 ? max_mm.y() : min_mm.y(),
                (i & 4) != 0 ? max_mm.z() : min_mm.z());
  };
  constexpr std::array<std::array<int, 4>, 6> kFaces{
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  for (const auto& f : kFaces) {
    tree_of(what).triangles.push_back({corner(f[0]), corner(f[1]), corner(f[2])});
    tree_of(what).triangles.push_back({corner(f[0]), corner(f[2]), corner(f[3])});
  }
}

void Surroundings::finish() {
  tree_of(Obstacle::stock).stock = true;
  for (Tree& tree : trees_) {
    tree.nodes.clear();
    tree.volumes.clear();
    if (tree.triangles.empty()) continue;
    tree.nodes.emplace_back();
    tree.build(0, 0, static_cast<std::uint32_t>(tree.triangles.size()));
    for (const auto& triangle : tree.triangles) tree.volumes.push_back(volume_of({&triangle, 1}));
  }
}

Surroundings::Volume Surroundings::volume_of(std::span<const std::array<Vec3, 3>> triangles) {
  Volume out;
  Vec3 low = triangles[0][0], high = low, normal = Vec3::Zero();
  for (const auto& [a, b, c] : triangles) {
    low = low.cwiseMin(a).cwiseMin(b).cwiseMin(c);
    high = high.cwiseMax(a).cwiseMax(b).cwiseMax(c);
    normal += (b - a).cross(c - a);
  }
  out.centre_mm = (low + high) / 2;
  if (normal.norm() > 0) out.normal = normal.normalized();
  out.low_mm = out.high_mm = out.normal.dot(triangles[0][0]);
  for (const auto& triangle : triangles)
    for (const Vec3& p : triangle) {
      out.radius_mm = std::max(out.radius_mm, (p - out.centre_mm).norm());
      out.low_mm = std::min(out.low_mm, out.normal.dot(p));
      out.high_mm = std::max(out.high_mm, out.normal.dot(p));
    }
  return out;
}

void Surroundings::Tree::build(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
  Node now{volume_of(std::span(triangles).subspan(begin, end - begin))};
  Vec3 low = triangles[begin][0], high = low;
  for (std::uint32_t i = begin; i < end; ++i)
    for (const Vec3& p : triangles[i]) low = low.cwiseMin(p), high = high.cwiseMax(p);
  if (end - begin <= kLeaf) {
    now.begin = begin;
    now.end = end;
    nodes[node] = now;
    return;
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(triangles.begin() + begin, triangles.begin() + middle, triangles.begin() + end,
                   [&](const auto& a, const auto& b) {
                     return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
                   });
  now.begin = static_cast<std::uint32_t>(nodes.size());
  nodes[node] = now;
  nodes.emplace_back();
  nodes.emplace_back();
  build(now.begin, begin, middle);
  build(now.begin + 1, middle, end);
}

/// A tool somewhere, and the room that is left so far.
struct Surroundings::Probe {
  const ToolShape& tool;
  const Vec3& tip_mm;
  const Vec3& axis;
  bool stock;      ///< the obstacle is stock, which the flutes may cut
  double room_mm;  ///< never negative

  bool counts(const ToolShape::Piece& piece) const {
    return !stock || piece.solid.part() != checks::OutlineRing::Part::cutter;
  }

  /// A volume as the tool sees it.
  struct Seen {
    double out, up;       ///< the centre, from the axis and up from the tip
    double tilt, wide;    ///< components of the axis along the slab's normal and across it
    double below, above;  ///< distances from the tip to the slab's sides, along its normal
  };
  Seen seen(const Volume& volume) const {
    const Vec3 from_tip = volume.centre_mm - tip_mm;
    const double up = from_tip.dot(axis), tilt = volume.normal.dot(axis), tip = volume.normal.dot(tip_mm);
    return {std::sqrt(std::max(from_tip.squaredNorm() - up * up, 0.0)),
            up,
            tilt,
            std::sqrt(std::max(1 - tilt * tilt, 0.0)),
            volume.low_mm - tip,
            volume.high_mm - tip};
  }
  /// Returns a lower bound of the room between the volume and the piece, by ball and cylinder, then by the slab;
  /// kFar_mm: by no less than the room.
  double bound_mm(const Seen& seen, double radius_mm, const ToolShape::Piece& piece) const {
    const double across = std::max(seen.out - piece.radius_mm, 0.0);
    const double along = std::max({piece.bottom_mm - seen.up, seen.up - piece.top_mm, 0.0});
    const double squared = across * across + along * along, spare = radius_mm + piece.need_mm;
    if (squared >= (spare + room_mm) * (spare + room_mm)) return kFar_mm;
    const double wide = piece.radius_mm * seen.wide, a = seen.tilt * piece.bottom_mm, b = seen.tilt * piece.top_mm;
    const double slab = std::max(std::min(a, b) - wide - seen.above, seen.below - std::max(a, b) - wide);
    return std::max(std::sqrt(squared) - spare, slab - piece.need_mm);
  }
  double bound_mm(const Volume& volume) const {
    const Seen at = seen(volume);
    double bound = kFar_mm;
    for (const ToolShape::Piece& piece : tool.pieces)
      if (counts(piece)) bound = std::min(bound, bound_mm(at, volume.radius_mm, piece));
    return bound;
  }
};

double Surroundings::Tree::room_mm(const ToolShape& tool, const Vec3& tip_mm, const Vec3& axis, double cap_mm) const {
  if (nodes.empty()) return cap_mm;
  Probe probe{tool, tip_mm, axis, stock, cap_mm};
  std::optional<Mat3> frame;
  struct Open {
    std::uint32_t node;
    double bound_mm;
  };
  std::array<Open, 128> stack;
  std::size_t size = 0;
  stack[size++] = {0, probe.bound_mm(nodes[0])};
  while (size > 0) {
    const Open now = stack[--size];
    if (now.bound_mm >= probe.room_mm) continue;
    const Node& node = nodes[now.node];
    if (node.end == 0) {
      Open a{node.begin, probe.bound_mm(nodes[node.begin])}, b{node.begin + 1, probe.bound_mm(nodes[node.begin + 1])};
      if (a.bound_mm < b.bound_mm) std::swap(a, b);
      if (a.bound_mm < probe.room_mm) stack[size++] = a;
      if (b.bound_mm < probe.room_mm) stack[size++] = b;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const Probe::Seen seen = probe.seen(volumes[i]);
      for (const ToolShape::Piece& piece : tool.pieces) {
        if (!probe.counts(piece)) continue;
        const double bound = probe.bound_mm(seen, volumes[i].radius_mm, piece);
        if (bound >= probe.room_mm) continue;
        probe.room_mm = std::max(bound, 0.0);
        if (bound >= 0) continue;
        if (!frame) frame = checks::outline_frame({tip_mm, axis, 0});
        if (too_near(piece, in_tool(triangles[i], *frame, tip_mm))) return -1;
      }
    }
  }
  return probe.room_mm;
}

double Surroundings::room_mm(const ToolShape& tool, const Vec3& tip_mm, const Vec3& axis, double cap_mm) const {
  double room = cap_mm;
  for (const Tree& tree : trees_)
    if (room >= 0) room = tree.room_mm(tool, tip_mm, axis, room);
  return room;
}

bool Surroundings::deepest_point(const Vec3& tip_mm, const Vec3& axis, double radius_mm, double from_mm,
                                 Inside& out) const {
  out.from_axis_mm = radius_mm;
  for (const Tree& tree : trees_) tree.deepest_point(tip_mm, axis, from_mm, out);
  return out.from_axis_mm < radius_mm;
}

void Surroundings::Tree::deepest_point(const Vec3& tip_mm, const Vec3& axis, double from_mm, Inside& out) const {
  std::vector<std::uint32_t> open;
  if (!nodes.empty()) open.push_back(0);
  const auto off = [&](const Vec3& p) { return (p - tip_mm).cross(axis).norm(); };
  const auto look = [&](const Vec3& p) {
    if ((p - tip_mm).dot(axis) <= from_mm) return;
    if (const double e = off(p); e < out.from_axis_mm) out = {p, e};
  };
  while (!open.empty()) {
    const Node& node = nodes[open.back()];
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
      for (const Vec3& p : triangles[i]) look(p);
      look((triangles[i][0] + triangles[i][1] + triangles[i][2]) / 3);
    }
  }
}

}  // namespace camber::posture
