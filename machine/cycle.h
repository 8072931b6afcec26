#pragma once
// Inputs of the cycle time other than the path: positioning, spindle start, tool change, codes. Source: Takata 1999,
// table 2.1.
#include <limits>

namespace camber::machine {

/// dogleg: each axis at its own rapid rate until it arrives; linear: along the straight line.
enum class RapidPath { dogleg, linear };

/// linear: constant acceleration along the path, with lookahead. exponential: after interpolation, two first-order lags
/// in series (Yan & Shirase 1997, eqs. 2-5), block by block. bell: as linear, but the acceleration takes bell_time_s to
/// build up and to fall, so that a change of speed that reaches it takes half of that longer.
enum class AccelerationLaw { linear, exponential, bell };

/// An acceleration law with its times, as Cycle has them.
struct AccelerationTimes {
  AccelerationLaw law = AccelerationLaw::linear;
  double time_constant_1_s = 0, time_constant_2_s = 0;  ///< exponential
  double bell_time_s = 0;                               ///< bell
};

/// sequential: the time of an M, S or T code comes before the motion of its block; simultaneous: together with it.
enum class CodeOrder { sequential, simultaneous };

struct Cycle {
  RapidPath rapid_path = RapidPath::dogleg;
  AccelerationLaw acceleration_law = AccelerationLaw::linear;
  double time_constant_1_s = 0;  ///< exponential: T1
  double time_constant_2_s = 0;  ///< exponential: T2
  double bell_time_s = 0;        ///< bell
  double rapid_override_percent = 100;
  double feed_override_percent = 100;
  /// Overlap of two rapids: the second begins when the first has slowed to this fraction of its speed; 0: at rest.
  double rapid_overlap_percent = 0;
  double linear_acceleration_mm_per_s2 = std::numeric_limits<double>::infinity();  ///< cutting, before interpolation
  double arc_acceleration_mm_per_s2 = std::numeric_limits<double>::infinity();     ///< centripetal, F <= sqrt(a r)
  double arc_tolerance_mm = std::numeric_limits<double>::infinity();  ///< radius error due to the lag of the axes
  double arc_loop_factor = 2;  ///< m of the arc tolerance: 8 with smooth high-gain position loops, else 2
  double jerk_filter_s = 0;    ///< T_filter: added to the time of each change of speed
  CodeOrder code_order = CodeOrder::sequential;
  double m_code_s = 0;           ///< each M code except M6 and M60
  double s_code_s = 0;           ///< each S
  double t_code_s = 0;           ///< each T
  double histogram_step_mm = 0;  ///< step of the distance histograms; 0: non-uniform steps
  double pallet_change_s = 0;    ///< M60
  /// Speed limit of the last distance of G60.
  double creep_feed_mm_per_s = std::numeric_limits<double>::infinity();
};

struct ToolChange {
  double chip_to_chip_s = 0;  ///< total without the spindle start; 0: the sum of the parts below
  double tool_to_tool_s = 0;
  /// Tool change position in program coordinates; also the target of G28, and of G30 if its point is not given. inf:
  /// not known, ignored.
  double x_mm = std::numeric_limits<double>::infinity();
  double y_mm = std::numeric_limits<double>::infinity();
  double z_mm = std::numeric_limits<double>::infinity();
};

/// A reference point of G30 P2, P3, P4, in the program's coordinates. inf: as the tool change position.
struct ReferencePoint {
  double x_mm = std::numeric_limits<double>::infinity();
  double y_mm = std::numeric_limits<double>::infinity();
  double z_mm = std::numeric_limits<double>::infinity();
  bool operator==(const ReferencePoint&) const = default;
};

/// An index table about B.
struct IndexTable {
  bool present = false;
  double max_velocity_rad_per_s = std::numeric_limits<double>::infinity();
  double acceleration_rad_per_s2 = std::numeric_limits<double>::infinity();
  double clamp_s = 0;  ///< time to unclamp and clamp, for each rotation
};

}  // namespace camber::machine
