#pragma once
// Marks that deflected cutters of any pose leave on points of the surface.
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/field/stamp_deflection.h"
#include "removal/field/tilted/carve.h"
#include "removal/form_error.h"
#include "removal/form_error/mark_queue.h"
#include "removal/tool_path.h"

namespace camber::removal {

/// Stamps of a stretch with their deflections. What it is made from must outlive it.
class TiltedStamps {
 public:
  TiltedStamps(const EnvelopeGrid& envelope, std::span<const Stamp> stamps, const DeflectionTable& deflections,
               const std::vector<StampDeflection>& bounds, std::int32_t first_id);

  /// Lists the stamps that come within `reach_mm` of a place, deflected as they are.
  void find_near(const Vec3& place_mm, double reach_mm, std::vector<std::size_t>& out) const;
  /// Keeps those of a list that do.
  void keep_near(const Vec3& place_mm, double reach_mm, std::vector<std::size_t>& list) const;

  const EnvelopeGrid& envelope() const { return envelope_; }
  const DeflectionTable& deflections() const { return deflections_; }
  const tilted::StampFrame& frame(std::size_t k) const { return frames_[k]; }
  const ToolPose& pose(std::size_t k) const { return stamps_[k].pose; }
  const StampDeflection& deflection(std::size_t k) const { return bounds_[k]; }
  std::int32_t id(std::size_t k) const { return first_id_ + static_cast<std::int32_t>(k); }
  double straight_distance_mm(std::size_t k, const Vec3& place_mm) const {
    return envelope_.shape.distance_mm(frames_[k].in_tool(place_mm));
  }

 private:
  const EnvelopeGrid& envelope_;
  std::span<const Stamp> stamps_;
  const DeflectionTable& deflections_;
  const std::vector<StampDeflection>& bounds_;
  std::int32_t first_id_;
  std::vector<tilted::StampFrame> frames_;
};

/// Lowers points of the surface to the deepest of the stamps beside them. One thread.
class TiltedMarks {
 public:
  explicit TiltedMarks(const TiltedStamps& stamps);
  void mark(std::span<SurfacePoint> points, std::span<const std::size_t> near);

 private:
  void lower(SurfacePoint& point, std::size_t point_number, std::size_t stamp);
  void settle(std::span<SurfacePoint> points);

  const TiltedStamps& stamps_;
  MarkQueue queue_;
  std::vector<std::size_t> first_;  ///< for each point the stamp that goes deepest where it is straight
};

}  // namespace camber::removal
