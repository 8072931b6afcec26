#pragma once
// What the time of a program depends on beside the path: how the control positions, starts the spindle, changes
// tools and works off codes. Source: Takata 1999, table 2.1 (its inputs, as the checks of the papers tell them).
#include <limits>

namespace camber::machine {

/// dogleg: every axis with its own rapid, each until it has arrived; linear: along the straight line.
enum class RapidPath { dogleg, linear };

/// linear: constant acceleration along the path, with lookahead. exponential: after interpolation, two time constants
/// one behind the other (Yan & Shirase 1997, eqs. 2-5), block by block. bell: as linear, but the acceleration takes
/// bell_time_s to build up and to die down, which makes each change of speed take half of that longer.
enum class AccelerationLaw { linear, exponential, bell };

/// An acceleration law with its times, as Cycle has them.
struct AccelerationTimes {
  AccelerationLaw law = AccelerationLaw::linear;
  double time_constant_1_s = 0, time_constant_2_s = 0;  ///< exponential
  double bell_time_s = 0;                               ///< bell
};

/// sequential: an M, S or T code's time comes before the motion of its block; simultaneous: along with it.
enum class CodeOrder { sequential, simultaneous };

struct Cycle {
  RapidPath rapid_path = RapidPath::dogleg;
  AccelerationLaw acceleration_law = AccelerationLaw::linear;
  double time_constant_1_s = 0;  ///< exponential: T1
  double time_constant_2_s = 0;  ///< exponential: T2
  double bell_time_s = 0;        ///< bell
  double rapid_override_percent = 100;
  double feed_override_percent = 100;
  /// Between two rapids the second begins when the first has braked to this fraction of its speed; 0: at rest.
  double rapid_overlap_percent = 0;
  double linear_acceleration_mm_per_s2 = std::numeric_limits<double>::infinity();  ///< cutting, before interpolation
  double arc_acceleration_mm_per_s2 = std::numeric_limits<double>::infinity();     ///< centripetal, F <= sqrt(a r)
  double arc_tolerance_mm = std::numeric_limits<double>::infinity();  ///< radius error by the lag of the axes
  double arc_loop_factor = 2;  ///< m of the arc tolerance: 8 with smooth high-gain position loops, else 2
  double jerk_filter_s = 0;    ///< T_filter: each change of speed takes so much longer
  CodeOrder code_order = CodeOrder::sequential;
  double m_code_s = 0;           ///< each M code but M6 and M60
  double s_code_s = 0;           ///< each S
  double t_code_s = 0;           ///< each T
  double histogram_step_mm = 0;  ///< of the histograms of G0 and G1 distances; 0: uneven steps, finer for short ones
  double pallet_change_s = 0;    ///< M60
  /// Speed of the last way of G60, where the rapids are faster.
  double creep_feed_mm_per_s = std::numeric_limits<double>::infinity();
};

struct ToolChange {
  double chip_to_chip_s = 0;  ///< all of it but the start of the spindle; 0: the sum of the parts below
  double tool_to_tool_s = 0;
  /// Where tools are changed, in the program's coordinates; G28 goes there too, and G30 where its point is not given.
  /// inf: not known, counts for nothing.
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

/// An index table that turns about B.
struct IndexTable {
  bool present = false;
  double max_velocity_rad_per_s = std::numeric_limits<double>::infinity();
  double acceleration_rad_per_s2 = std::numeric_limits<double>::infinity();
  double clamp_s = 0;  ///< unclamp and clamp, for each turn
};

}  // namespace camber::machine
