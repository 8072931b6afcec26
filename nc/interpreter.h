#pragma once
// Interprets a program: turns the words of its blocks into moves of the tool. This is the door of nc/.
//
// Overview
//
// nc/ reads NC programs, gives them a meaning, and writes them again with some words changed. It knows no machine: what
// a control does differently stands in tables of facts (dialect.h, dialects.h).
//
//   text --program--> Program --interpreter--> Interpretation --(other folders)--> edits --emit--> text
//        blocks, words         moves, states                                       only these words change
//
// - program.h: blocks and words with their positions in the file; nothing is interpreted, so that every byte can be
//   written again. Expressions and statements are side tables (expression.h, statement.h).
// - interpreter.h: block_interpreter executes a block once its words have numbers: units, planes, frames (frames.h),
//   arcs, cycles (canned_cycles.h), cutter radius compensation (cutter_radius.h), corners (corner_cut.h), rotary axes
//   (rotary.h). sequencer decides which block runs next: calls, jumps, loops.
// - move.h: the result. Positions are tool tips in one frame, mm; Move::editable says whether the block's own words
//   define the move and may be changed.
// - emit.h: edits of points and feeds, replaced and repeated blocks (repeat.h). Untouched text stays byte for byte;
//   move_map.h finds the moves of the new program in the given one.
// - language.h: the languages. ISO is this folder, heidenhain/ and siemens/ are the others; each turns a text into the
//   same Program and the same moves, and says how changed words are written.
// - reporter.h: diagnostics with file, line and column, each said once with a count.
//
// docs/reference/nc-language*.md list every code and word with what is done; tests compare these tables with the code.
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "nc/dialect.h"
#include "nc/move.h"
#include "nc/offsets.h"
#include "nc/program_text.h"
#include "nc/rotary.h"

namespace camber::nc {

struct InterpreterOptions {
  /// Unit where the program has neither G20 nor G21; not given: millimetres, with a warning.
  std::optional<bool> inch;
  bool skip_slash_blocks = false;  ///< the block skip switch
  /// G4 P and the P of drilling cycles without a decimal point: milliseconds (Fanuc, Haas, Mazak), or seconds
  /// (LinuxCNC). With a point they are seconds for all.
  bool dwell_p_is_ms = false;
  bool absolute_arc_centre = false;         ///< the control starts in G90.1 rather than G91.1
  bool index_table = false;                 ///< B turns an index table: an event, no error
  std::vector<RotaryOption> rotary_axes{};  ///< rotary axes of the machine; none: their words are refused
  double peck_clearance_mm = 0.254;         ///< G83 stops its rapid so far above the last depth; G73 retracts by it
  /// Dialect of the program: a row of the table, or a copy with some facts changed for a control whose parameters
  /// differ. Not given: the dialect that the text shows (O-words, M97), else default_dialect(), except that
  /// `dwell_p_is_ms` then decides the unit of a dwell.
  std::optional<Dialect> dialect{};
  /// X1000 is 1000 least increments of the dialect (1 mm), not 1000 mm. Not given: a setting of the control that is not
  /// known; it is assumed (docs/reference/nc-language.md), with the warning [decimal-point] where the path depends on
  /// it.
  std::optional<bool> whole_numbers_are_increments{};
  double max_spindle_speed_rpm =
      std::numeric_limits<double>::infinity();  ///< maximum of the machine: a greater S is clamped
  std::uint16_t skip_switches = 0;              ///< bit n: blocks that begin with /n are left out (/ is /1)
  /// Blocks that loops and repeated subprograms may run again before the program counts as endless.
  std::size_t max_repeated_blocks = 10'000'000;

  // What the operator has set at the control; what is not given here and not set by the program is not known.
  std::map<int, Vec3> work_offsets_mm{};     ///< machine coordinates, by the number of ModalState::work_offset
  std::map<int, Vec3> rotary_offsets_rad{};  ///< A, B, C of the offsets that work_offsets_mm has
  std::map<int, ToolOffset> tool_offsets{};  ///< tool offsets by H and D number
  /// Machine coordinates of the reference points: G28, G30 P2, P3, P4.
  std::array<std::optional<Vec3>, 4> reference_points_mm{};

  Vec3 single_direction_mm = Vec3::Zero();  ///< last distance of G60, for each axis; 0: none

  const Dialect& dialect_or_default() const { return dialect ? *dialect : default_dialect(); }
};

/// Arcs whose radii at start and end differ by more than the first are warned of, by more than the second refused.
inline constexpr double kArcRadiusWarningMm = 0.005;
inline constexpr double kArcRadiusErrorMm = 0.05;

/// Interprets the whole program. Words of a block act in the order unit, feed mode, distance mode, plane, F, S, T,
/// M6, M3 M4, coolant on, dwell or motion, M5 M9, stops. Reading ends at M2 or M30. All work offsets are taken as
/// one frame, with a warning when several are cut in, unless their values are known (docs/reference/nc-language.md,
/// Frames). Errors and warnings go to `diagnostics`; errors do not stop the reading (Diagnostics throws InputError
/// after kMaxErrors).
Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics);

}  // namespace camber::nc
