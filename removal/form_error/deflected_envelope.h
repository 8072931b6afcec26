#pragma once
// The envelope of one stamp whose point (s, phi) is displaced by the deflection of the instant at which an edge passes
// it.
#include "base/tool_pose.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/field/stamp_deflection.h"

namespace camber::removal {

/// One deflected stamp. What it is made from must outlive it.
class DeflectedEnvelope {
 public:
  DeflectedEnvelope(const EnvelopeGrid& envelope, const DeflectionTable& deflections, const StampDeflection& deflection,
                    const ToolPose& pose)
      : e_(envelope), deflections_(deflections), deflection_(deflection), pose_(pose) {}

  const ToolPose& pose() const { return pose_; }
  const StampDeflection& deflection() const { return deflection_; }

  /// Height above q along n at which q + height n lies on the deflected envelope, if that is under `highest`; else
  /// `highest`. mm. removal/simd/upright_mark_kernels.h does the same for many at once.
  double height_mm(const Vec3& q, const Vec3& n, double highest) const;

 private:
  double settled_mm(const Vec3& q, const Vec3& n, double highest, Vec3 deflection) const;
  // Places in the tool's frame:
  double outward_mm(const Vec3& in_tool) const;
  double envelope_height_mm(const Vec3& in_tool) const;
  Vec3 deflection_at(const Vec3& in_tool) const;

  const EnvelopeGrid& e_;
  const DeflectionTable& deflections_;
  const StampDeflection& deflection_;
  ToolPose pose_;
};

}  // namespace camber::removal
