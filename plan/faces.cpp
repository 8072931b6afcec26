#include "plan/faces.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "plan/holes.h"
#include "plan/mesh_edges.h"

namespace camber::plan {
namespace {

constexpr double kAlongAxis = 1 - 1.5e-6;  // cosine of 0.1 degrees
constexpr double kSmoothPatch = 0.966;     // cosine of 15 degrees
constexpr int kNoAxis = -1, kUprightWall = 3, kFreeForm = 4;

/// 0 to 2: along that axis.
int kind_of(const Vec3& n) {
  for (int a = 0; a < 3; ++a)
    if (std::abs(n[a]) > kAlongAxis) return a;
  if (n.squaredNorm() < 0.5) return kNoAxis;
  return is_upright(n) ? kUprightWall : kFreeForm;
}

struct Patch {
  int kind = kNoAxis;
  std::vector<std::uint32_t> triangles;
  double area_mm2 = 0;
  Bounds bounds;
  double at_mm = 0;                  ///< planes: mean coordinate
  bool smooth_all_round = true;      ///< no edge of it is sharp
  double largest_neighbour_mm2 = 0;  ///< of the triangles round it
};

class PatchFinder {
 public:
  PatchFinder(const Solid& solid, const MeshEdges& edges) : solid_(solid), edges_(edges) {
    for (std::size_t t = 0; t < solid.triangles.size(); ++t) {
      normals_.push_back(unit_normal(solid, t));
      kinds_.push_back(kind_of(normals_.back()));
      areas_.push_back(0.5 * solid.normal_by_area(solid.triangles[t]).norm());
    }
  }

  std::vector<Patch> find() const {
    std::vector<Patch> out;
    std::vector<bool> seen(solid_.triangles.size(), false);
    for (std::uint32_t first = 0; first < seen.size(); ++first) {
      if (seen[first] || kinds_[first] == kNoAxis) continue;
      Patch patch{.kind = kinds_[first], .triangles = {first}, .bounds = {}};
      seen[first] = true;
      for (std::size_t i = 0; i < patch.triangles.size(); ++i) grow(patch, patch.triangles[i], seen);
      measure(patch);
      out.push_back(std::move(patch));
    }
    return out;
  }

 private:
  bool joins(std::uint32_t a, std::uint32_t b) const {
    if (kinds_[a] != kinds_[b]) return false;
    const double cosine = normals_[a].dot(normals_[b]);
    return kinds_[a] < 3 ? cosine > 0 : cosine > kSmoothPatch;
  }

  void grow(Patch& patch, std::uint32_t t, std::vector<bool>& seen) const {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t next = edges_.across(t, e);
      if (next == MeshEdges::kNone) {
        patch.smooth_all_round = false;
      } else if (joins(t, next)) {
        if (!seen[next]) seen[next] = true, patch.triangles.push_back(next);
      } else if (kinds_[next] != kNoAxis) {
        patch.smooth_all_round = patch.smooth_all_round && normals_[t].dot(normals_[next]) > kSmoothPatch;
        patch.largest_neighbour_mm2 = std::max(patch.largest_neighbour_mm2, areas_[next]);
      }
    }
  }

  void measure(Patch& patch) const {
    double sum = 0;
    for (const std::uint32_t t : patch.triangles) {
      patch.area_mm2 += areas_[t];
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3 p = solid_.corner(solid_.triangles[t], c);
        patch.bounds.add(p);
        if (patch.kind < 3) sum += areas_[t] * p[patch.kind] / 3;
      }
    }
    if (patch.area_mm2 > 0) patch.at_mm = sum / patch.area_mm2;
  }

  const Solid& solid_;
  const MeshEdges& edges_;
  std::vector<Vec3> normals_;
  std::vector<int> kinds_;
  std::vector<double> areas_;
};

/// True where a flat patch is only a facet of a curved surface.
bool is_facet(const Patch& p) {
  constexpr double kFacets = 3;
  return p.smooth_all_round && p.largest_neighbour_mm2 > 0 && p.area_mm2 < kFacets * p.largest_neighbour_mm2;
}

void add_planes(const std::vector<Patch>& patches, const FaceOptions& options,
                std::array<std::vector<AxisPlane>, 3>& planes) {
  for (const Patch& p : patches) {
    if (p.area_mm2 < options.min_face_mm2) continue;
    if (p.kind < 3) {
      if (!is_facet(p)) planes[static_cast<std::size_t>(p.kind)].push_back({p.at_mm, p.area_mm2, true});
      continue;
    }
    // An upright wall ends where other faces do.
    const int axes = p.kind == kUprightWall ? 2 : 3;
    for (int a = 0; a < axes; ++a)
      for (const double at : {p.bounds.min_mm[a], p.bounds.max_mm[a]})
        planes[static_cast<std::size_t>(a)].push_back({at, 0, false});
  }
  for (auto& of_axis : planes) of_axis = joined(std::move(of_axis), options.plane_tolerance_mm);
}

/// Corners of the outline between upright facets whose normals turn towards each other.
class CornerFinder {
 public:
  CornerFinder(const Solid& solid, const MeshEdges& edges, const std::vector<bool>& of_hole)
      : solid_(solid), edges_(edges), of_hole_(of_hole) {}

  std::vector<InnerCorner> find() {
    for (std::uint32_t t = 0; t < solid_.triangles.size(); ++t) {
      const Vec3 n = unit_normal(solid_, t);
      if (of_hole_[t] || !is_upright(n)) continue;
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t next = edges_.across(t, e);
        if (next != MeshEdges::kNone && next > t && !of_hole_[next]) look_at(t, next, e, n);
      }
    }
    return std::move(out_);
  }

 private:
  /// Across the wall, of the facet's triangle.
  double width(std::uint32_t t, const Vec3& n) const {
    double low = 1e300, high = -1e300;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 p = solid_.corner(solid_.triangles[t], c);
      const double along = -n.y() * p.x() + n.x() * p.y();
      low = std::min(low, along), high = std::max(high, along);
    }
    return high - low;
  }

  void look_at(std::uint32_t t, std::uint32_t next, std::size_t e, const Vec3& n) {
    const Vec3 m = unit_normal(solid_, next);
    if (!is_upright(m)) return;
    const Vec3 a = solid_.corner(solid_.triangles[t], e), b = solid_.corner(solid_.triangles[t], (e + 1) % 3);
    if (std::abs(a.z() - b.z()) < 1e-6) return;
    const double turn = std::acos(std::clamp(n.dot(m), -1.0, 1.0));
    constexpr double kFlat = 1e-3, kSharp = kPi / 4;
    if (turn < kFlat) return;
    // Concave: the other facet's far corner lies on the side to which this one's normal points.
    double most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, (solid_.corner(solid_.triangles[next], c) - a).dot(n));
    if (most < 1e-6) return;
    const double w = std::min(width(t, n), width(next, m));
    out_.push_back({{a.x(), a.y()},
                    std::min(a.z(), b.z()),
                    std::max(a.z(), b.z()),
                    turn > kSharp ? 0 : w / (2 * std::tan(turn / 2))});
  }

  const Solid& solid_;
  const MeshEdges& edges_;
  const std::vector<bool>& of_hole_;
  std::vector<InnerCorner> out_;
};

Solid plugged_of(const Solid& solid, const FoundHoles& holes) {
  Solid out;
  out.points = solid.points;
  out.points.insert(out.points.end(), holes.new_points.begin(), holes.new_points.end());
  for (std::size_t t = 0; t < solid.triangles.size(); ++t)
    if (!holes.of_hole[t]) out.triangles.push_back(solid.triangles[t]);
  out.triangles.insert(out.triangles.end(), holes.caps.begin(), holes.caps.end());
  return out;
}

}  // namespace

std::vector<AxisPlane> joined(std::vector<AxisPlane> planes, double tolerance_mm) {
  std::ranges::sort(planes, [](const AxisPlane& a, const AxisPlane& b) {
    return a.at_mm != b.at_mm ? a.at_mm < b.at_mm : a.area_mm2 > b.area_mm2;
  });
  std::vector<AxisPlane> out;
  for (const AxisPlane& p : planes) {
    if (out.empty() || p.at_mm - out.back().at_mm > tolerance_mm) {
      out.push_back(p);
      continue;
    }
    AxisPlane& last = out.back();
    const double area = last.area_mm2 + p.area_mm2;
    if (area > 0) last.at_mm = (last.at_mm * last.area_mm2 + p.at_mm * p.area_mm2) / area;
    last.area_mm2 = area;
    last.face = last.face || p.face;
  }
  return out;
}

Faces find_faces(const Solid& solid, const FaceOptions& options) {
  Faces out;
  const MeshEdges edges(solid);
  const FoundHoles holes = find_holes(solid, edges, options);
  out.holes = holes.holes;
  out.corners = CornerFinder(solid, edges, holes.of_hole).find();
  out.plugged = plugged_of(solid, holes);
  const std::vector<Patch> patches = PatchFinder(out.plugged, MeshEdges(out.plugged)).find();
  for (const Patch& p : patches)
    if (p.kind == kFreeForm) out.free_form_mm2 += p.area_mm2;
  add_planes(patches, options, out.planes);
  return out;
}

std::array<std::vector<AxisPlane>, 3> find_planes(const Solid& solid, const FaceOptions& options) {
  std::array<std::vector<AxisPlane>, 3> planes;
  add_planes(PatchFinder(solid, MeshEdges(solid)).find(), options, planes);
  return planes;
}

}  // namespace camber::plan
