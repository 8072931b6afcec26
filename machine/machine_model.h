#pragma once
// Machine and control, read from machine.toml. A missing limit is no limit (infinity).
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "machine/control_kind.h"
#include "machine/cycle.h"
#include "machine/kinematics.h"
#include "machine/number_range.h"

namespace camber::machine {

/// A box or a mesh as it stands with all axes at 0, in the machine frame.
struct Body {
  std::string name;
  std::string on;        ///< what carries it: "part", an axis, "bed" or "spindle"
  std::size_t axes = 0;  ///< between the part and it; without [kinematics] x, y and z are between part and spindle
  std::optional<std::array<Vec3, 2>> box_mm{};  ///< least and greatest corner
  std::string mesh{};                           ///< STL file, absolute; empty: a box
};

enum class CornerLaw {
  speed_difference,  ///< per-axis permitted speed step (Fanuc 1783): F_c = F / max(dV_axis / V_permitted)
  angle,             ///< F <= a dt / sqrt(2 (1 - cos theta))
  blend,             ///< corners rounded within a tolerance
  exact_stop,
  radius  ///< F <= sqrt(a r_eq), r_eq of the circle through the corner and its neighbours (Yan & Shirase 1997, eq. 16)
};

struct Corner {
  CornerLaw law = CornerLaw::exact_stop;
  double tolerance_mm = 0;                      ///< blend
  double speed_difference_mm_per_s = kNoLimit;  ///< speed_difference
  double time_s = 0;                            ///< angle: dt
  double acceleration_mm_per_s2 = kNoLimit;     ///< radius: a
  /// Corners that turn by less are ignored, under any law (Takata 1999, table 2.1: 5 degrees). 0: none are ignored.
  double threshold_rad = 0;
  /// Corners without rounding: permitted speed step, as a fraction of the speed that an axis gains in one period (dV =
  /// fraction x acceleration x period). 0: only for corners without a change of direction.
  double step_fraction = 0;
  /// A line between two roundings that lasts less than this gets the limits of the roundings.
  double short_line_time_s = 0;
  double stop_angle_rad = kNoLimit;  ///< the control stops at corners that turn by more, under any law
  double stop_time_s = 0;            ///< duration of such a stop
};

/// Default in-position width.
inline constexpr double kInPositionMm = 0.02;

struct Control {
  ControlKind kind = default_control_kind();
  double period_s = 0.001;  ///< period of interpolation and of feed.csv
  double block_time_s = 0;  ///< block processing time T_b
  Corner corner;
  double merge_tolerance_mm = 0;  ///< short lines within it are merged; 0: none
  int lookahead_blocks = 0;  ///< lookahead: number of segments, at the last of which a stop is possible; 0: unlimited
  double arc_normal_fraction = 1;      ///< fraction of the acceleration for arcs: v <= sqrt(fraction a r)
  double arc_tangential_fraction = 1;  ///< fraction of the acceleration, available along an arc at that limit
  /// Fraction of the acceleration in a blended block (G64) that ends in a stop; applied twice when the lookahead plans
  /// the entry speed of that block.
  double stop_acceleration_fraction = 1;
  double rest_latency_s = 0;  ///< a dwell takes this much longer than programmed
  /// Limit along the path, in addition to the axes (before interpolation).
  double path_acceleration_mm_per_s2 = kNoLimit;
  /// Minimum wait at the stop between rapid and feed moves; 0: no stop.
  double rapid_change_s = 0;
  std::optional<double> least_increment_mm{};  ///< step of emitted coordinates; not given: as the program has
  bool kind_given = false;                     ///< [control] dialect; else the default kind
  /// Numbers without a decimal point count least increments, not millimetres or inches; not given: not known.
  std::optional<bool> whole_numbers_are_increments{};
  /// In-position width: between rapid and feed moves, and at exact stops (G9, G61.1), the control waits until every
  /// axis is within it. Infinite: no wait. Read from a file without the key: kInPositionMm, LinuxCNC infinite.
  double in_position_mm = kNoLimit;
  RotaryFeed rotary_feed = RotaryFeed::joints;
  /// Limits of the axes count for the joints, under tool-centre-point control too. False: there for X, Y, Z of the
  /// program, A, B and C instead.
  bool joint_limits = true;
  /// A block that follows the stop of another one begins with the next whole period; false: at once. After rests and
  /// positionings every control begins with a period.
  bool starts_on_period = false;
  std::optional<AccelerationTimes> acceleration_law{};  ///< for a parameter set ([control.mode]); not given: [cycle]'s
};

struct Axis {
  double max_velocity_mm_per_s = kNoLimit;
  double max_feed_mm_per_s = kNoLimit;  ///< limit of feed moves, if lower than max_velocity
  double acceleration_mm_per_s2 = kNoLimit;
  double rapid_mm_per_s = kNoLimit;                ///< rapid rate (G0), if lower than max_velocity
  double rapid_acceleration_mm_per_s2 = kNoLimit;  ///< acceleration of G0; infinite: the same as acceleration
  double g60_mm = 0;                               ///< last distance of G60, signed: the direction of approach
  double jerk_mm_per_s3 = kNoLimit;
  double filter_s = 0;                              ///< moving average after interpolation; 0: none
  double exponential_1_s = 0, exponential_2_s = 0;  ///< first-order lags after interpolation (Yan & Shirase); 0: none
  double position_gain_per_s = kNoLimit;            ///< Kp of the position loop; infinity: no lag
  double velocity_lag_s = 0;                        ///< time constant of the velocity loop inside the position loop
  double feed_forward_percent = 0;
  double acceleration_feed_forward_s = 0;  ///< commanded acceleration x this is added to the velocity command
  double dead_time_s = 0;                  ///< from the command to the position loop
  double backlash_mm = 0;                  ///< lost motion at each reversal, behind the position loop
  /// Corner law speed_difference: value for this axis; infinite: that of the corner law.
  double speed_difference_mm_per_s = kNoLimit;
  double stiffness_N_per_mm = kNoLimit;  ///< static, tool against work, along this axis
  std::array<double, 2> travel_mm{-kNoLimit, kNoLimit};
  bool given = true;  ///< false: the machine file does not have this axis
};

/// Range of the programs that a model was fitted on; beyond it the model extrapolates. [min, max].
struct FittedRange {
  bool known = false;
  std::array<double, 2> feed_mm_per_s{}, corner_rad{}, line_mm{}, arc_radius_mm{};
  std::array<double, 2> arc_mm{};        ///< lengths of arcs; 0, 0: not known
  std::array<double, 2> blocks_per_s{};  ///< at the programmed feed, over eight blocks in a row
  std::array<bool, 3> axis{};            ///< x, y, z moved
};

struct Spindle {
  double max_rpm = kNoLimit;
  double gd2_kgf_m2 = 0;                  ///< flywheel effect of spindle, motor and tool; 0: starts immediately
  double power_W = kNoLimit;              ///< power of the motor
  double constant_torque_rpm = kNoLimit;  ///< N1: constant torque up to here
  double constant_power_rpm = kNoLimit;   ///< N2: constant power from N1 to here, falling above
  double start_time_s = 0;                ///< from rest to max_rpm, instead of gd2 and power; 0: not given
  double orient_s = 0;                    ///< time of the spindle orientation for a tool change
};

struct Machine {
  std::string path;  ///< path of the file it was read from
  Control control;
  /// Parameter sets that codes of the program select ([control.mode.NAME]): `control` with other values, by name.
  std::vector<std::pair<std::string, Control>> modes;
  std::array<Axis, 3> axis;          ///< x, y, z
  std::array<RotaryAxis, 3> rotary;  ///< a, b, c
  Kinematics kinematics;
  std::vector<Body> bodies;
  Spindle spindle;
  Cycle cycle;
  ToolChange tool_change;
  std::array<ReferencePoint, 3> reference_points;  ///< second to fourth
  IndexTable index;
  FittedRange fitted_range;
  std::vector<std::string> translation;  ///< translation of [source]: a line for each native parameter
};

/// Throws InputError with file:line:column for unknown keys, wrong types and values out of range.
Machine read_machine(const std::string& path, Diagnostics& diagnostics);

/// machine.toml text that read_machine reads back to the same values.
std::string to_toml(const Machine& machine);

}  // namespace camber::machine
