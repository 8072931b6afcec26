#pragma once
// The kinematic chain of a machine and its rotary axes, as machine.toml gives them ([kinematics], [axis.a] to
// [axis.c]). What the chain does with a tool: kinematics/chain.h.
#include <array>
#include <cstddef>
#include <limits>
#include <string>

#include "base/geometry.h"

namespace camber::machine {

/// Body that turns by the right-hand rule about `direction` when the axis' word grows: the tool relative to the part
/// (ISO 841), or the part relative to the tool.
enum class PositiveTurn { tool, table };

struct RotaryAxis {
  bool given = false;
  Vec3 direction = Vec3::UnitZ();  ///< direction of the axis with all axes at 0, machine frame; any length but zero
  Vec3 point_mm = Vec3::Zero();    ///< any point of the axis with all axes at 0, machine frame
  PositiveTurn positive = PositiveTurn::tool;
  /// The control takes absolute words modulo one turn, and turns by at most half a turn.
  bool shortest_way = false;
  std::array<double, 2> travel_rad{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double max_velocity_rad_per_s = std::numeric_limits<double>::infinity();
  double max_feed_rad_per_s = std::numeric_limits<double>::infinity();  ///< speed limit of feed moves
  double rapid_rad_per_s = std::numeric_limits<double>::infinity();     ///< rapid rate (G0), if lower than max_velocity
  double acceleration_rad_per_s2 = std::numeric_limits<double>::infinity();
  double jerk_rad_per_s3 = std::numeric_limits<double>::infinity();
  double filter_s = 0;                                                   ///< moving average; 0: none
  double exponential_1_s = 0, exponential_2_s = 0;                       ///< first-order lags; 0: none
  double position_gain_per_s = std::numeric_limits<double>::infinity();  ///< Kp of the position loop
  double velocity_lag_s = 0;                                             ///< lag of the velocity loop
  double feed_forward_percent = 0;                                       ///< feed forward of the position loop
  double acceleration_feed_forward_s = 0, dead_time_s = 0;               ///< as of machine::Axis
  double backlash_rad = 0;                                               ///< lost motion at each reversal
  /// Corner law speed_difference: value for this axis; infinite: the number of the corner law, in degrees.
  double speed_difference_rad_per_s = std::numeric_limits<double>::infinity();
  double clamp_s = 0;              ///< time to unclamp and clamp the axis, for each rotation
  int clamp_m = 0, unclamp_m = 0;  ///< M codes that clamp and release the axis; 0: none
};

/// The chain from the part to the spindle. Every axis is where the machine has it with all axes at 0; that is the
/// machine frame, and the part's frame too, which the table carries along.
struct Kinematics {
  std::string chain;                   ///< letters of the axes from the part to the spindle ("cayxz"); empty: not given
  std::size_t table_axes = 0;          ///< the first so many carry the part, the others carry the spindle
  Vec3 gauge_point_mm = Vec3::Zero();  ///< gauge line of the spindle on its axis, with all axes at 0
  Vec3 tool_axis = Vec3::UnitZ();      ///< from the tip towards the spindle, with all axes at 0; any length but zero

  bool given() const { return !chain.empty(); }
  /// Letters of the rotary axes from the part to the spindle.
  std::string rotary_axes() const;
};

}  // namespace camber::machine
