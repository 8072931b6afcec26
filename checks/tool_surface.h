#pragma once
// The surface of a turning tool as points, at any pose, against the stock.
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/tool_pose.h"
#include "checks/material_distance.h"
#include "checks/tool_outline.h"
#include "removal/stock.h"

namespace camber::checks {

/// Points on circles about the tool's axis, in patches a few millimetres wide. Tool frame: origin at the tip, axis +Z.
class ToolSurface {
 public:
  struct Patch {
    OutlineRing::Part part = OutlineRing::Part::cutter;
    Vec3 centre_mm = Vec3::Zero();
    double radius_mm = 0;  ///< of a sphere that holds its points
    std::size_t from = 0, count = 0;
  };

  /// `step_mm`: between the points of a ring, at most. At least one ring.
  ToolSurface(std::span<const OutlineRing> rings, double step_mm);

  const std::vector<Patch>& patches() const { return patches_; }
  std::span<const Vec3> points(const Patch& patch) const { return std::span(points_).subspan(patch.from, patch.count); }
  double radius_mm() const { return radius_mm_; }  ///< the largest
  double top_mm() const { return top_mm_; }
  /// Lowest height of what is not cutter; infinite where the tool is all cutter.
  double shank_from_mm() const { return shank_from_mm_; }
  /// The tool, drawn back along its axis, stays in the space that it takes or has taken.
  bool widens_upwards() const { return widens_upwards_; }
  /// No point of the tool is farther than this from where it was. The spindle's turn does not count.
  double displacement_mm(const ToolPose& from, const ToolPose& to) const;
  /// False only if the tool, or its shank and holder alone, is farther than the margin from the box.
  bool may_touch(const ToolPose& pose, bool with_cutter, const Vec3& min_mm, const Vec3& max_mm,
                 double margin_mm = 0) const;

 private:
  void add_band(std::span<const OutlineRing> band, double step_mm);

  std::vector<Patch> patches_;
  std::vector<Vec3> points_;
  double radius_mm_ = 0, bottom_mm_ = 0, top_mm_ = 0, shank_from_mm_ = 0;
  bool widens_upwards_ = true;
};

/// The frame of a tool whose turn about its axis does not matter.
Mat3 outline_frame(const ToolPose& pose);

/// Poses from the first, exclusive, to the second, inclusive, of which the neighbours differ by `step_mm` at most.
/// For small changes of direction.
std::vector<ToolPose> poses_between(const ToolSurface& tool, const ToolPose& from, const ToolPose& to, double step_mm);

/// One tool's surface in a stock that is being cut.
class SurfaceFeeler {
 public:
  struct Touch {
    OutlineRing::Part part;
    Vec3 place_mm;
  };
  /// All must outlive this. `material`: of `stock`.
  SurfaceFeeler(const ToolSurface& tool, const removal::Stock& stock, MaterialDistance& material);

  /// The first point of the surface that is in material by more than a voxel and for which counts(point) is true.
  /// `probe`: of the stock as it is.
  std::optional<Touch> touch(const removal::Stock::Probe& probe, const ToolPose& pose, bool with_cutter,
                             const std::function<bool(const Vec3&)>& counts = {});

 private:
  bool in_material(const removal::Stock::Probe& probe, const Vec3& point) const;

  const ToolSurface& tool_;
  const removal::Stock& stock_;
  MaterialDistance& material_;
  std::optional<ToolPose> last_;
  double moved_mm_ = 0;                 ///< sum of displacements
  std::vector<double> clear_until_mm_;  ///< per patch: value of moved_mm_ up to which it cannot touch material
};

}  // namespace camber::checks
