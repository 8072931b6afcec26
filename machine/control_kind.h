#pragma once
// The facts in which the kinds of control differ, apart from the NC dialect that they read (nc/dialect.h). The rows are
// in machine/control_kinds.h; code queries a fact of the control and never compares its name.
#include <span>
#include <string_view>
#include <vector>

#include "machine/cycle.h"

namespace camber::machine {

/// Quantity that F counts per minute in a block that moves linear and rotary axes without tool-centre-point control.
enum class RotaryFeed {
  linear,  ///< the length in X Y Z, whatever the rotary axes do
  joints   ///< sqrt(dx^2 + dy^2 + dz^2 + da^2 + db^2 + dc^2), mm and degrees
};

/// Properties of a control that machine.toml does not give. The defaults are for an unknown control.
struct ControlKind {
  std::string_view name;        ///< the word of [control] dialect and --dialect
  std::string_view nc_dialect;  ///< dialect of its programs: nc::Dialect::name

  // Motion
  RapidPath rapid_path = RapidPath::dogleg;  ///< path of G0 where [cycle] rapid_path is not given
  /// Without Q, the P of G64 (corner tolerance) is also the tolerance within which short lines are merged.
  bool g64_p_merges = false;
  /// Stops between rapid and feed moves, whatever the corner law. (Control::rapid_change_s: stops and waits.)
  bool stops_between_rapid_and_feed = false;
  /// Waits until the axes are in position where [control] in_position_mm is not given: between rapid and feed moves, at
  /// exact stops.
  bool waits_in_position = true;
  /// G61 stops at every corner, instead of just following the path exactly.
  bool g61_stops = true;
  /// G61.1 stops exactly; false: it is a mode of its own (Mazak: high-accuracy shape correction), not a stop.
  bool g61_1_stops = true;
  /// A block that follows a stop begins with a period; where [control] starts_on_period is not given.
  bool starts_on_period = false;
  /// No segment passes in less than this many periods.
  double min_segment_periods = 1;
  // With rotary axes
  RotaryFeed rotary_feed = RotaryFeed::joints;  ///< where [control] rotary_feed is not given
  /// The planner looks at the limits of the joints; where [control] joint_limits is not given.
  bool joint_limits = true;
  /// Blocks that turn rotary axes run from rest to rest under G64, each beginning while the one before it brakes, at
  /// Control::stop_acceleration_fraction of the acceleration; under G61 they stop.
  bool turning_blocks_overlap = false;

  /// On helices, the acceleration along the path grows with the rise of the whole arc.
  bool helix_rise_frees_acceleration = false;

  // Starting values of fit-feed for the corner law "blend", for keys that machine.toml leaves out. 0: not known
  double default_step_fraction = 0;     ///< Corner::step_fraction
  int usual_lookahead_blocks = 0;       ///< Control::lookahead_blocks
  double usual_short_line_periods = 0;  ///< Corner::short_line_time_s, in periods of the control
  bool fits_short_lines = false;        ///< fit-feed tries several short-line times and lookaheads
};

/// All rows, in the order in which messages list them.
std::span<const ControlKind> control_kinds();

std::vector<std::string_view> control_kind_names();

/// Assumed where machine.toml does not name one: Fanuc.
const ControlKind& default_control_kind();

/// Null for an unknown name.
const ControlKind* control_kind_named(std::string_view name);

}  // namespace camber::machine
