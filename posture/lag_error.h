#pragma once
// Lag error: the error that the following errors of the axes leave on the surface. Each axis is behind its command by
// its own time.
//
// An axis i at the speed q'_i is behind by  tau_i q'_i,  tau = filter / 2 + T1 + T2 + (1 - Kf) / Kp  (feedmodel/drive.h
// at constant speed). The centre of the cutter's rounding, c(q) in the part's frame, is off by  J (tau o q'),  J =
// dc/dq, and the surface by the component along the normal:
//     e = n . J (tau o q')
// which is 0 where all axes are behind by the same time, as the centre goes along the surface.
#include <array>
#include <span>
#include <vector>

#include "kinematics/chain.h"
#include "machine/machine.h"
#include "posture/path_points.h"

namespace camber::posture {

class LagError {
 public:
  /// For a tool of this length (gauge line to tip), whose cutter is rounded about a point `pivot_mm` above the tip;
  /// `origin_mm`: machine zero in the frame of the points.
  LagError(const machine::Machine& machine, const Vec3& origin_mm, double tool_length_mm, double pivot_mm);

  /// False: the axes follow their commands, all with the same delay.
  bool any() const { return any_; }

  /// The machine with the tool at a point.
  struct Place {
    kinematics::Joints joints;
    Vec3 linear = Vec3::Zero(), rotary = Vec3::Zero();  ///< (J^T n)_i tau_i; s, mm s / rad
  };
  Place place(const PathPoint& point, const Vec3& axis, const Vec3& rotary_rad) const;

  /// mm, on the way between two places in this time; angles by the shorter way. Greater than zero: into the part.
  static double error_mm(const Place& from, const Place& to, double time_s);

  /// Errors along the path, at a constant direction and with the axes where `rotary_rad` has them: a value for each
  /// point, 0 off the part.
  std::vector<double> along(std::span<const PathPoint> points, const Vec3& axis, const Vec3& rotary_rad) const;

 private:
  Vec3 centre_mm(const kinematics::Joints& joints) const;

  kinematics::Chain chain_;
  Vec3 origin_mm_;
  double tool_length_mm_, pivot_mm_;
  Vec3 linear_tau_s_, rotary_tau_s_;
  bool any_ = false;
};

}  // namespace camber::posture
