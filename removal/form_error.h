#pragma once
// Form error: points of the target surface with the height of the machined surface along their normals, statistics, and
// the part as a mesh.
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::removal {

/// Signed distances to a closed mesh, negative inside, exact to the rounding of its coordinates. Found through a tree
/// of boxes around the triangles; the sign is that of the angle-weighted normal at the nearest place (Baerentzen and
/// Aanaes, "Signed distance computation using the angle weighted pseudonormal", 2005).
class PartMesh {
 public:
  explicit PartMesh(const TriangleMesh& closed);
  ~PartMesh();
  PartMesh(PartMesh&&) noexcept;

  double distance_mm(const Vec3& point) const;  ///< thread safe
  const Vec3& min_mm() const { return min_mm_; }
  const Vec3& max_mm() const { return max_mm_; }

 private:
  class Tree;
  Vec3 min_mm_, max_mm_;
  std::unique_ptr<Tree> tree_;
};

/// Undeflected cutters by stamp id. Ids are added in ascending order.
class CutterPlaces {
 public:
  /// Stamps first_id, first_id + 1, ... of one cutter.
  void add(std::int32_t first_id, const CutterShape& shape, std::span<const Stamp> stamps);
  bool empty() const { return runs_.empty(); }
  bool knows(std::int32_t id) const { return find(id) != nullptr; }
  /// Distance to a known stamp's envelope, mm, negative inside the cutter.
  double distance_mm(std::int32_t id, const Vec3& point) const;
  Vec3 gradient(std::int32_t id, const Vec3& point) const;
  struct Depth {
    std::int32_t id;
    double depth_mm;  ///< depth of the point inside that cutter
  };
  /// Local search from a known stamp along its run: the stamp in which the point lies deepest.
  Depth deepest_from(std::int32_t id, const Vec3& point) const;

 private:
  struct Run {
    std::int32_t first_id;
    CutterShape shape;
    std::vector<Vec3> tips;       ///< places of upright stamps
    std::vector<ToolPose> poses;  ///< poses of other stamps
    std::size_t size() const { return tips.size() + poses.size(); }
    ToolPose pose(std::size_t k) const { return poses.empty() ? ToolPose{tips[k]} : poses[k]; }
    ToolPose pose_of(std::int32_t id) const { return pose(static_cast<std::size_t>(id - first_id)); }
  };
  const Run* find(std::int32_t id) const;
  std::vector<Run> runs_;
};

struct SurfacePoint {
  Vec3 place_mm = Vec3::Zero();      ///< on the target's surface
  Vec3 crossing_mm = Vec3::Zero();   ///< where a grid line crosses the target's field, beside it
  Vec3 normal = Vec3::UnitZ();       ///< outward, unit
  double error_mm = 0;               ///< machined minus target along the normal; positive: excess material
  double contour_mm = 0;             ///< share of error_mm that servo lag and corner rounding cause
  double area_mm2 = 0;               ///< area of the target's surface that the point represents
  std::int32_t target_stamp = -1;    ///< stamp of the target sweep that generated it
  std::int32_t machined_stamp = -1;  ///< stamp that last cut the machined field there; -1: none
  /// Shares of contour_mm that the axes' lag and the control's path tolerance cause by themselves (simulate/contour.h).
  float lag_mm = 0, path_tolerance_mm = 0;
  float part_mm = 0;  ///< share of error_mm that the part's own deflection causes
  bool valid = true;  ///< false: left where the model does not hold (simulate/validity.h); in no figure
};

/// Points where grid lines cross the target's surface, in a fixed order. A crossing along axis a represents the area
/// voxel^2 |n_a|; over all three axes these add up to the surface area, since sum n_a^2 = 1. Only surface that the
/// target's sweep has cut, leaving out one voxel along its edges. Errors are clipped to the band. Both stocks must have
/// the same voxels.
std::vector<SurfacePoint> compare_surfaces(const Stock& machined, const Stock& target);

/// Returns the points of the target alone, without error, tile by tile. Each point is moved along its grid line to the
/// surface left by the cutters that the voxels around it name, since a trilinear field is inaccurate at ridges and
/// edges; it has the normal of the cutter that governs there. It is also moved aside within the square that its grid
/// line stands for (always the same for one grid edge): the squares cover the surface once, and cusps in step with the
/// grid are sampled at all their places.
///
/// `solid`: the stock that the target was cut from, before any allowance was removed. With it the points reach up to
/// the edges with the stock's faces: the last point of a row stands for the rest up to the edge, so that the seen part
/// of a low wall does not depend on the grid. Without it (null) one voxel along the edges is left out.
///
/// `unseen_mm2` (null: not needed): approximate area of the surface cut by the target's sweep that has no point.
std::vector<std::vector<SurfacePoint>> surface_points(const Stock& target, const CutterPlaces& places,
                                                      const Stock* solid = nullptr, double* unseen_mm2 = nullptr);

/// A value and the area that it stands for.
struct ValueOfArea {
  double value = 0, area_mm2 = 0;
};
/// Returns the least value that `area_mm2` of the points do not exceed, the greatest where all of them are less; 0
/// without points. Sums of areas that differ by no more than rounding count as equal. Takes linear time.
double value_at_area(std::vector<ValueOfArea> points, double area_mm2);

/// Area-weighted figures of an error, in the unit of the values.
struct ErrorFigures {
  double min = 0, max = 0, mean = 0, rms = 0;
  double p95 = 0;  ///< 95th percentile of the magnitude
  double area_mm2 = 0;
};
ErrorFigures error_figures(const std::vector<double>& error, const std::vector<double>& area_mm2);

/// Distribution of the area over the error.
struct ErrorSpread {
  static constexpr std::array<double, 9> kFractions{0.01, 0.05, 0.10, 0.25, 0.50, 0.75, 0.90, 0.95, 0.99};
  std::array<double, kFractions.size()> percentile{};  ///< percentiles of the signed error, weighted by area
  double bin_from = 0, bin_width = 0;                  ///< in the unit of the values
  std::vector<double> bin_area_mm2;                    ///< their sum is the whole area
};
/// Forty bins or fewer of a round width (1, 2 or 5 times a power of ten) from the minimum to the maximum error.
ErrorSpread error_spread(const std::vector<double>& error, const std::vector<double>& area_mm2);

/// The error that the cutters have left at a point of a SurfaceMap.
struct PointMark {
  double error_mm = 0;
  std::uint32_t point = 0;  ///< index in SurfaceMap::points
  std::int32_t stamp = -1;
};

class TiltedStamps;  // removal/form_error/tilted_stamps.h

/// Points of the target's surface (as compare_surfaces has them, moved along their grid line onto the cutters that made
/// the surface there), each with the height of the machined surface along its normal.
///
/// A field between voxels rounds the ridges between two cuts. The deflected cutter leaves other ridges than the
/// straight one, sharper by the jump of the deflection as an edge enters the cut, so that rounding does not cancel
/// between two fields: 3.5 % of the error were lost at 0.1 mm voxels (docs/engagement.md). Here every point is
/// intersected with every envelope: the height e at which x = q + e n - delta(s, phi) lies on the undeflected envelope,
/// with (s, phi) of x; the minimum over all stamps is kept. Results do not depend on the number of threads.
class SurfaceMap {
 public:
  /// `places`: the cutters of the target's sweep, by the ids that its voxels name. `blank`: the surface wherever no
  /// mark is deeper. `solid`: see surface_points. All have the same voxels. They are not needed afterwards.
  SurfaceMap(const Stock& target, const CutterPlaces& places, const Stock& blank, const Stock* solid = nullptr);
  /// With the marks that it has; a map without marks serves several cuts against one target.
  SurfaceMap(const SurfaceMap& other);
  SurfaceMap(SurfaceMap&&) noexcept;
  SurfaceMap& operator=(const SurfaceMap&) = delete;
  ~SurfaceMap();

  /// Takes the marks of `stamps`, deflected by the rows of `deflections`; ids are first_id + index.
  void mark(const EnvelopeGrid& envelope, std::span<const Stamp> stamps, const DeflectionTable& deflections,
            std::int32_t first_id);

  /// Approximate area of the target surface without a point, mm^2; the ends of the surface are known to half a voxel.
  double unseen_mm2() const { return unseen_mm2_; }

  /// Returns the points with the errors from the marks and, where uncut, from the blank. Ends the map.
  std::vector<SurfacePoint> take();
  /// The errors that take() would return, and the map is without marks again.
  std::vector<float> take_errors_mm();
  /// The points that have a mark, ascending; the map is without marks again. Takes as long as the part of the surface
  /// is large that was marked.
  std::vector<PointMark> take_marks();
  /// Their errors mean nothing before take().
  std::span<const SurfacePoint> points() const;

 private:
  struct Impl;
  void mark_tilted(const TiltedStamps& stamps);

  std::unique_ptr<Impl> impl_;
  double unseen_mm2_ = 0;
};

}  // namespace camber::removal
