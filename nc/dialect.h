#pragma once
// The facts in which the NC dialects differ. The rows are in nc/dialects.h; code queries a fact of the dialect and
// never compares its name.
#include <cstdint>
#include <span>
#include <string_view>

#include "nc/language_id.h"

namespace camber::nc {

struct Program;

/// Inclusive range of variable numbers.
struct NumberRange {
  int first = 0, last = -1;
  bool holds(double number) const { return number >= first && number <= last; }
};

/// Columns of the memory of tool offsets, by their variables (nc/offset_variables.h).
enum class OffsetColumns : std::uint8_t { none, fanuc, haas, mazak };

/// One dialect of a language. Most facts are about those of RS-274; Siemens and Heidenhain have languages of their own
/// with one dialect each (nc/language.h).
struct Dialect {
  LanguageId language = LanguageId::iso;
  std::string_view name;   ///< the word in files, options and messages
  std::string_view title;  ///< name as its maker writes it

  // Program text: constructs that identify the dialect, and how Camber writes a program
  bool shown_by_o_words = false;    ///< the only one with O-words (o100 sub) and named parameters (#<x>)
  bool shown_by_m97 = false;        ///< the only one with M97, the call of a local subprogram
  bool has_program_number = true;   ///< O1234 is the program's number; else an O-word begins a subprogram
  bool g64_p_is_tolerance = false;  ///< G64 P0.01: corners are rounded within 0.01 mm
  std::string_view program_end = "M30";
  std::string_view file_extension = ".nc";

  bool semicolon_ends_block = true;  ///< G0 X1; G1 X2 in one line are two blocks; else a comment begins
  /// Errors are what other dialects read: a modal group twice in a block, a word that nothing uses, a cycle without
  /// axis words, a comment within a comment, abbreviated macro words.
  bool strict = false;

  // Words
  bool corner_words = true;              ///< ,R ,C ,A at the end of a block
  bool d_is_modal = true;                ///< D holds until the next D, in whatever block; else in blocks with G41, G42
  bool dwell_takes_p_alone = false;      ///< axis words beside G4 belong to the motion code: it dwells, then moves
  bool stores_reference_points = false;  ///< G28.1, G30.1: the place of the tool becomes the reference point
  bool haas_work_offsets = false;        ///< G154 P1 to P99, G110 to G129
  bool pecks_by_ijk = false;             ///< G73, G83: I first peck, J less each time, K at least; L alone repeats

  // Numbers
  bool dwell_p_is_ms = true;                  ///< G4 P500 is 500 ms; else 500 s
  bool whole_numbers_are_increments = false;  ///< X1000 is 1000 least increments (Fanuc 3401#0 = 0); else 1000 mm
  /// The setting of the control that decides it; empty: there is none, a point makes no difference.
  std::string_view whole_numbers_setting{};
  double least_increment_mm = 0.001;
  double least_increment_inch = 0.0001;
  double least_increment_deg = 0.001;
  /// Unit of an F without a point where numbers are increments: per minute, per revolution (Fanuc 1403#0, 1405#1).
  double whole_feed_mm = 1, whole_feed_inch = 0.01;
  double whole_feed_per_turn_mm = 0.01, whole_feed_per_turn_inch = 0.0001;

  // Variables
  NumberRange local{1, 33};  ///< one set for each level of macro calls
  NumberRange common[2]{{100, 199}, {500, 999}};
  bool has_null = true;     ///< a variable never set is vacant (#0): X#1 is then as if it were not written; else 0
  bool system_4000 = true;  ///< #1000.. #5000.. as Fanuc numbers them; else LinuxCNC's #5061..#5428
  OffsetColumns offset_columns = OffsetColumns::fanuc;  ///< layout of the variables that are tool offsets

  // Expressions
  bool logic_is_bitwise = true;      ///< 5 AND 2 is 0; else any number but 0 is true, and the result is 0 or 1
  bool and_binds_as_product = true;  ///< AND goes with * and /, OR and XOR with + and -; else all three come last
  bool fix_to_zero = true;           ///< FIX[-2.8] is -2 and FUP[-2.2] is -3; else floor and ceiling
  bool mod_is_whole = true;          ///< MOD rounds both sides and has the sign of the left; else never negative
  bool atan_is_positive = true;      ///< ATAN[a]/[b] runs from 0 to 360 degrees; else from -180 to 180
  bool round_to_increment = true;    ///< ROUND in the value of an axis word rounds to the least increment
  double equal_within = 0;           ///< EQ holds for numbers that differ by less

  // Frames and cutter radius compensation
  bool g52_is_g92 = false;              ///< G52 and G92 share one shift; else they add up
  bool g10_adds_in_g91 = true;          ///< G91 G10 L2 adds to the offset; else G91 is nothing to it
  bool g10_p0_is_external = true;       ///< G10 L2 P0 sets the shift common to all offsets; else the active one
  bool g10_l20_is_g54_1 = true;         ///< G10 L20 Pn sets G54.1 Pn; else it touches off
  bool rotation_r_adds_in_g91 = false;  ///< R of G68 in G91 is added to the angle (RIN = 1)
  double scale_unit = 0.001;            ///< value of 1 without a decimal point in P, I, J, K of G51
  bool g41_1_has_diameter = false;      ///< G41.1 D: a diameter; else it is normal direction control
  bool radius_corner_lines = true;      ///< outside corners by lines, else by arcs
  bool radius_entry_square = true;      ///< CutterRadius::entry_square_to_next (type A, 5003#0 = 0)
  /// After G40 the cutter stays off the contour until a block has a word of the plane; else it returns with the next
  /// move of any kind.
  bool radius_exit_waits = true;
  int radius_look_ahead = 1;  ///< CutterRadius::moves_without_plane_motion
  /// Arcs by I J K whose radii differ by up to this are spirals (3410 = 0); 0: only those with L are.
  double spiral_radius_difference_mm = 0;
  /// And by up to this fraction of the larger radius, as long as it is less than spiral_max_mm.
  double spiral_radius_fraction = 0;
  double spiral_max_mm = 0;

  // Five axes
  int tip_control_on_m = 0, tip_control_off_m = 0;  ///< M codes of tool-centre-point control; 0: G codes only

  // Subprograms
  bool m98_count_in_p = false;  ///< M98 P31234: O1234, three times
  int max_levels = 15;          ///< largest number of calls inside calls
};

/// Returns all rows, in the order in which messages list them.
std::span<const Dialect> dialects();

/// Returns the dialect assumed for a program whose text shows none: Fanuc, in which most macros are written.
const Dialect& default_dialect();

/// Null for an unknown name.
const Dialect* dialect_named(std::string_view name);

/// The dialect that the text shows by O-words, named parameters or M97; null where it shows none.
const Dialect* dialect_shown_by(const Program& program);

}  // namespace camber::nc
