#include "plan/faces.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "plan/triangle_solid.h"

namespace camber::plan {
namespace {

constexpr double kAlongAxis = 1 - 1.5e-6;  // cosine of 0.1 degrees
constexpr double kSmoothPatch = 0.966;     // cosine of 15 degrees
constexpr double kSmoothWall = 0.857;      // cosine of 31 degrees: facets of small rounded corners
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
  SolidBounds bounds;
  double at_mm = 0;                  ///< planes: mean coordinate
  bool smooth_all_round = true;      ///< no edge of it is sharp
  double largest_neighbour_mm2 = 0;  ///< largest of the triangles round it
  double turn = 0;                   ///< upright walls: > 0 where the facets turn towards each other
  /// Upright walls: coordinates in x and in y at which they go over smoothly into a wall that runs along that axis.
  std::array<std::vector<double>, 2> goes_over_mm{};
};

class PatchFinder {
 public:
  PatchFinder(const TriangleSolid& solid, const MeshEdges& edges) : solid_(solid), edges_(edges) {
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
    return kinds_[a] < 3 ? cosine > 0 : cosine > (kinds_[a] == kUprightWall ? kSmoothWall : kSmoothPatch);
  }

  void look_along_wall(Patch& patch, std::uint32_t t, std::size_t e, std::uint32_t next) const {
    if (normals_[t].dot(normals_[next]) < kSmoothWall) return;
    const Vec3 a = solid_.corner(solid_.triangles[t], e), b = solid_.corner(solid_.triangles[t], (e + 1) % 3);
    for (std::size_t c = 0; c < 3; ++c) patch.turn += (solid_.corner(solid_.triangles[next], c) - a).dot(normals_[t]);
    if (kinds_[next] < 2) {
      const int along = 1 - kinds_[next];
      patch.goes_over_mm[static_cast<std::size_t>(along)].push_back(0.5 * (a[along] + b[along]));
    }
  }

  void grow(Patch& patch, std::uint32_t t, std::vector<bool>& seen) const {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t next = edges_.across(t, e);
      if (next != MeshEdges::kNone && patch.kind == kUprightWall && kinds_[next] != kNoAxis && kinds_[next] != 2)
        look_along_wall(patch, t, e, next);
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

  const TriangleSolid& solid_;
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

/// Seen from above.
double length_mm(const Patch& p) {
  const Vec3 size = p.bounds.max_mm - p.bounds.min_mm;
  return std::max(size.x(), size.y());
}

/// True for the end of a rounded inner corner beside a wall along the axis.
bool wall_goes_on(const Patch& p, int axis, double at_mm, double tolerance_mm) {
  return p.turn > 0 && std::ranges::any_of(p.goes_over_mm[static_cast<std::size_t>(axis)],
                                           [&](double end) { return std::abs(end - at_mm) < tolerance_mm; });
}

void add_planes(const std::vector<Patch>& patches, const FaceOptions& options,
                std::array<std::vector<AxisPlane>, 3>& planes) {
  for (const Patch& p : patches) {
    if (p.area_mm2 < options.min_face_mm2) continue;
    if (p.kind < 3) {
      AxisPlane plane{p.at_mm, p.area_mm2, true};
      if (p.kind < 2) plane.length_mm = length_mm(p);
      if (!is_facet(p)) planes[static_cast<std::size_t>(p.kind)].push_back(plane);
      continue;
    }
    // An upright wall ends where other faces do.
    const bool wall = p.kind == kUprightWall;
    for (int a = 0; a < (wall ? 2 : 3); ++a)
      for (const double at : {p.bounds.min_mm[a], p.bounds.max_mm[a]}) {
        if (wall && wall_goes_on(p, a, at, options.plane_tolerance_mm)) continue;
        AxisPlane bound{at, 0, false};
        if (wall) bound.length_mm = length_mm(p);
        planes[static_cast<std::size_t>(a)].push_back(bound);
      }
  }
  for (auto& of_axis : planes) of_axis = joined(std::move(of_axis), options.plane_tolerance_mm);
}

/// Corners of the outline between upright facets whose normals turn towards each other. A facet may be several
/// triangles side by side.
class CornerFinder {
 public:
  CornerFinder(const TriangleSolid& solid, const MeshEdges& edges, const std::vector<bool>& of_hole)
      : solid_(solid),
        edges_(edges),
        of_hole_(of_hole),
        widths_(solid.triangles.size(), 0),
        chain_(solid.triangles.size(), 0) {}

  std::vector<InnerCorner> find() {
    find_widths();
    for (std::uint32_t t = 0; t < solid_.triangles.size(); ++t) {
      const Vec3 n = unit_normal(solid_, t);
      if (of_hole_[t] || !is_upright(n)) continue;
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t next = edges_.across(t, e);
        if (next != MeshEdges::kNone && next > t && !of_hole_[next]) look_at(t, next, e, n);
      }
    }
    return with_radii_of_chains();
  }

 private:
  static constexpr double kFlat = 1e-3;  ///< rad; less is no turn

  /// Along the wall, of all triangles of a facet.
  void find_widths() {
    std::vector<bool> seen(solid_.triangles.size(), false);
    for (std::uint32_t first = 0; first < seen.size(); ++first) {
      const Vec3 n = unit_normal(solid_, first);
      if (seen[first] || !is_upright(n)) continue;
      std::vector<std::uint32_t> facet{first};
      seen[first] = true;
      double low = 1e300, high = -1e300;
      for (std::size_t i = 0; i < facet.size(); ++i)
        for (std::size_t e = 0; e < 3; ++e) {
          const Vec3 p = solid_.corner(solid_.triangles[facet[i]], e);
          const double along = -n.y() * p.x() + n.x() * p.y();
          low = std::min(low, along), high = std::max(high, along);
          const std::uint32_t next = edges_.across(facet[i], e);
          if (next == MeshEdges::kNone || seen[next] || unit_normal(solid_, next).dot(n) < 1 - kFlat * kFlat / 2)
            continue;
          seen[next] = true;
          facet.push_back(next);
        }
      for (const std::uint32_t t : facet) widths_[t] = high - low, chain_[t] = first;
    }
  }

  std::uint32_t chain_of(std::uint32_t t) const {
    while (chain_[t] != t) t = chain_[t];
    return t;
  }

  /// Facets of a round wall follow each other, and the mesh may have cut it unevenly: the median of its corners' radii
  /// is that of them all. The corner beside a long wall says nothing of it.
  std::vector<InnerCorner> with_radii_of_chains() {
    std::map<std::uint32_t, std::vector<double>> radii;
    for (std::size_t k = 0; k < out_.size(); ++k)
      if (out_[k].radius_mm > 0 && among_facets_[k]) radii[chain_of(facet_[k])].push_back(out_[k].radius_mm);
    for (auto& [chain, of] : radii) std::ranges::sort(of);
    for (std::size_t k = 0; k < out_.size(); ++k) {
      if (out_[k].radius_mm <= 0) continue;
      const auto found = radii.find(chain_of(facet_[k]));
      if (found != radii.end()) out_[k].radius_mm = found->second[found->second.size() / 2];
    }
    return std::move(out_);
  }

  void look_at(std::uint32_t t, std::uint32_t next, std::size_t e, const Vec3& n) {
    const Vec3 m = unit_normal(solid_, next);
    if (!is_upright(m)) return;
    const Vec3 a = solid_.corner(solid_.triangles[t], e), b = solid_.corner(solid_.triangles[t], (e + 1) % 3);
    if (std::abs(a.z() - b.z()) < 1e-6) return;
    const double turn = std::acos(std::clamp(n.dot(m), -1.0, 1.0));
    constexpr double kSharp = kPi / 4;
    if (turn < kFlat) return;
    // Concave: the other facet's far corner lies on the side to which this one's normal points.
    double most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, (solid_.corner(solid_.triangles[next], c) - a).dot(n));
    if (most < 1e-6) return;
    const double one = widths_[t], other = widths_[next], narrower = std::min(one, other);
    const double w = 0.5 * (narrower + std::min(std::max(one, other), 2 * narrower));
    out_.push_back({{a.x(), a.y()},
                    std::min(a.z(), b.z()),
                    std::max(a.z(), b.z()),
                    turn > kSharp + kFlat ? 0 : w / (2 * std::sin(turn / 2))});
    constexpr double kWall = 4;  // times the narrower facet
    facet_.push_back(one < other ? t : next);
    among_facets_.push_back(std::max(one, other) < kWall * narrower);
    if (turn <= kSharp + kFlat && among_facets_.back()) chain_[chain_of(next)] = chain_of(t);
  }

  const TriangleSolid& solid_;
  const MeshEdges& edges_;
  const std::vector<bool>& of_hole_;
  std::vector<double> widths_;        ///< width of each triangle's facet
  std::vector<std::uint32_t> chain_;  ///< triangle to another one of its facet or round wall
  std::vector<std::uint32_t> facet_;  ///< for each corner the triangle of the narrower facet
  std::vector<bool> among_facets_;    ///< for each corner: no wall beside it
  std::vector<InnerCorner> out_;
};

TriangleSolid plugged_of(const TriangleSolid& solid, const FoundHoles& holes) {
  TriangleSolid out;
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
    last.length_mm = std::max(last.length_mm, p.length_mm);
    last.face = last.face || p.face;
  }
  return out;
}

std::vector<AxisPlane> without_slivers(const std::vector<AxisPlane>& planes, double narrowest_mm) {
  std::vector<AxisPlane> by_weight = planes, out;
  std::ranges::stable_sort(by_weight, [](const AxisPlane& a, const AxisPlane& b) {
    return a.length_mm != b.length_mm ? a.length_mm > b.length_mm : a.area_mm2 > b.area_mm2;
  });
  constexpr double kRounding = 1 - 1e-3;
  const double least = kRounding * narrowest_mm;
  for (const AxisPlane& p : by_weight)
    if (p.length_mm >= least ||
        std::ranges::none_of(out, [&](const AxisPlane& o) { return std::abs(o.at_mm - p.at_mm) < least; }))
      out.push_back(p);
  std::ranges::sort(out, {}, &AxisPlane::at_mm);
  return out;
}

Faces find_faces(const TriangleSolid& solid, const FaceOptions& options) {
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

std::array<std::vector<AxisPlane>, 3> find_planes(const TriangleSolid& solid, const FaceOptions& options) {
  std::array<std::vector<AxisPlane>, 3> planes;
  add_planes(PatchFinder(solid, MeshEdges(solid)).find(), options, planes);
  return planes;
}

}  // namespace camber::plan
