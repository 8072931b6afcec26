#pragma once
// Moves of an interpreted program, the result that all other folders use. Positions are the tool tip, mm, in the frame
// of the work offset that was active at the first move (docs/reference/nc-language.md, Frames).
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "base/tool_pose.h"
#include "nc/event.h"
#include "nc/frame.h"
#include "nc/rotary.h"

namespace camber::nc {

enum class MoveKind : std::uint8_t { rapid, linear, arc, dwell };
/// The code that has switched on a control's mode for fine paths: G08 P1, G05 P10000, G05.1 Q1; CYCLE832 (Siemens),
/// cycle 32 (Heidenhain), whose tolerance is blend_tolerance_mm.
enum class Contouring : std::uint8_t { none, g08_p1, g05_p10000, g05_1_q1, cycle832, cycle32 };

enum class PathControl : std::uint8_t { exact_path, exact_stop, blend };  ///< G61, G61.1/G09, G64
enum class SpindleDirection : std::uint8_t { stopped, clockwise, counter_clockwise };
enum class FeedMode : std::uint8_t { per_minute, inverse_time, per_revolution };  ///< G94, G93, G95

/// Modal state during a move; shared by many moves.
struct ModalState {
  int tool = 0;  ///< tool in the spindle (after M6); names are in Interpretation::tool_names
  double spindle_speed_rpm = 0;
  double programmed_spindle_speed_rpm = 0;  ///< S; more than spindle_speed_rpm where the machine clamps it
  SpindleDirection spindle = SpindleDirection::stopped;
  PathControl path_control = PathControl::blend;
  double blend_tolerance_mm = -1;  ///< tolerance of the path: G64 P, cycle 32, CYCLE832; negative: the control's own
  double merge_tolerance_mm = -1;  ///< G64 Q; negative: not given
  FeedMode feed_mode = FeedMode::per_minute;
  bool inch = false;
  bool incremental = false;  ///< G91
  int work_offset = 54;      ///< 54..59; G59.1..G59.3: 591..593; G54.1 Pn: 540000 + n
  bool coolant = false;
  bool absolute_arc_centre = false;    ///< G90.1
  bool high_speed_contouring = false;  ///< G08 P1, G05 P10000, G05.1 Q1
  Contouring contouring = Contouring::none;
  std::uint32_t mode_words = 0;  ///< SOFT, DYNFINISH, G642 ...: bits of kModeWords (nc/mode_words.h)
  std::uint8_t path_g = 0;       ///< 61 (G61, G61.1), 62, 63 or 64, as the program says; 0: none so far
  std::uint8_t plane_g = 17;     ///< 17, 18 or 19
  bool cutter_radius = false;    ///< G41, G42 with a radius other than zero: the path was computed
  std::uint32_t frame = 0;       ///< index into Interpretation::frames
  TipControl tip_control = TipControl::off;
  WorkFrame work_frame = WorkFrame::machine;
  /// Gauge line to tip, where G43 with a known length is active; 0 without G43. Not given: not known. Only for
  /// machines with rotary axes; else 0.
  std::optional<double> tool_length_mm = 0;
  bool operator==(const ModalState&) const = default;
};

/// Only arcs have one. The tool turns by sweep_rad about `normal` through `center_mm` and moves along
/// `normal` at a constant rate from the start to the end (helix).
struct Arc {
  Vec3 center_mm = Vec3::Zero();  ///< component along `normal` = start's
  Vec3 normal = Vec3::UnitZ();    ///< unit: +Z for G17, +Y for G18, +X for G19
  double sweep_rad = 0;           ///< counter-clockwise about `normal` positive (G3); includes full turns
  bool by_radius = false;         ///< the text says R, not I J K
};

struct Move {
  Vec3 start_mm = Vec3::Zero();
  Vec3 end_mm = Vec3::Zero();
  double feed_mm_per_s = 0;  ///< programmed, along the path; 0 for rapids and dwells
  double dwell_s = 0;
  std::uint32_t block = 0;     ///< index into Program::blocks; line = block + 1
  std::uint32_t state = 0;     ///< index into Interpretation::states
  std::uint32_t arc = kNoArc;  ///< index into Interpretation::arcs
  MoveKind kind = MoveKind::rapid;
  std::uint8_t cycle = 0;       ///< G of the drilling cycle that made it (73, 74, 76, 81 ... 89); 0: none
  bool exact_stop : 1 = false;  ///< G9 or a control that must stop at the end of this move
  /// Part of a move to or from the reference point (G28, G30, G53) whose place in the work frame is not
  /// known: counts for nothing in material.
  bool reference : 1 = false;
  std::uint8_t reference_point : 2 = 0;  ///< index of the reference point of G28, G30: 0 for the first, to 3
  std::uint8_t reference_axes : 3 = 0;   ///< bit i: axis i goes to that point
  bool creeps : 1 = false;               ///< the last distance of G60
  bool canned : 1 = false;               ///< made by a cycle: one of several moves of its block
  /// True if the words of the block define this move and no other: the block is in the main program, runs once, and its
  /// words have numbers. Only such blocks may be edited. False in loops, in subprograms called more than once or from a
  /// file of their own, for expressions, under G41 and G42 and in polar coordinates.
  bool editable : 1 = true;
  bool feed_given : 1 = false;        ///< an F word or a feed mode was read since the previous move, up to this block
  bool feed_by_variable : 1 = false;  ///< the modal feed was set by an expression (F#1)
  /// Only on machines with rotary axes. Bit i: the programmed coordinate X, Y, Z of the end does not follow from the
  /// program, as rotary axes have turned or the axis was taken to a machine coordinate since it was last programmed;
  /// end_mm has its last value. All three: the linear axes stay. ProgramJoints (kinematics/) follows the machine there.
  std::uint8_t open_axes : 3 = 0;
  bool start_open : 1 = false;  ///< the same for the start

  static constexpr std::uint32_t kNoArc = std::numeric_limits<std::uint32_t>::max();
};

/// The blank that the program describes: BLK FORM, WORKPIECE. In the frame of the moves.
struct ProgramStock {
  bool cylinder = false;  ///< along Z, as wide as the box
  Vec3 min_mm = Vec3::Zero();
  Vec3 max_mm = Vec3::Zero();
  std::uint32_t block = 0;  ///< block that ends its description
};

struct Interpretation {
  std::vector<Move> moves;  ///< moves in order; each starts at the end of the previous one
  std::vector<Arc> arcs;
  std::vector<ModalState> states;
  std::vector<Event> events;                   ///< beside the moves, in order
  std::vector<Frame> frames{Frame{}};          ///< frames of the text's coordinates; the first is the identity
  std::vector<MachineTarget> machine_targets;  ///< one per move to machine coordinates, in order
  std::vector<RotaryTarget> rotary;            ///< one per move that turns rotary axes, in order; all axes start at 0
  /// Origin of the machine's coordinates in the frame of the moves, where the work offset is known.
  std::optional<Vec3> machine_origin_mm{};
  /// Moves on the ends of which others rely (an arc tangent to it, a polar coordinate), ascending: not editable, but
  /// where an edit before one has moved its start, its words may be changed so that it still ends there.
  std::vector<std::uint32_t> fixed_ends{};
  std::map<int, std::string> tool_names{};  ///< tools that the program calls by name, by their number in states
  std::optional<ProgramStock> stock{};
  bool whole_numbers_are_increments = false;  ///< how the program's numbers without a decimal point were read

  const ModalState& state_of(const Move& m) const { return states[m.state]; }
  const Frame& frame_of(const Move& m) const { return frames[states[m.state].frame]; }
};

/// Collects the moves from whose ends others are computed, while they are read.
class ReliedEnds {
 public:
  /// The end of the last motion among `moves`.
  void add(std::span<const Move> moves);
  /// Its direction: also where it starts.
  void add_direction(std::span<const Move> moves);
  /// Fills Interpretation::fixed_ends, once it is known which moves can be edited. Where such a move cannot be, or is a
  /// full circle, the one before it decides.
  void fix(Interpretation& program);

 private:
  std::vector<std::uint32_t> blocks_;  ///< of whose last moves the ends are relied on
};

/// True for a feed move of rotary axes alone: its F is degrees per minute, whatever unit lengths have.
bool only_turns(const Interpretation& program, std::size_t move);
/// F of such a move.
double feed_deg_per_min(const Interpretation& program, const Move& move);
/// Length along the path, mm (helices included).
double length_mm(const Interpretation& program, const Move& move);
/// Point at the fraction u in [0, 1] of the move's length.
Vec3 point_at(const Interpretation& program, const Move& move, double u);
/// The tool there. Upright: rotary axes are not looked at (kinematics/program_joints.h has the joints of such
/// programs).
ToolPose pose_at(const Interpretation& program, const Move& move, double u);
/// Unit direction of motion at the fraction u; zero for a move without length.
Vec3 direction_at(const Interpretation& program, const Move& move, double u);

}  // namespace camber::nc
