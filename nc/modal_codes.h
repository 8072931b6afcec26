#pragma once
// Table of G and M codes: the modal group of each, and messages for those that are not supported.
#include <string_view>
#include <vector>

namespace camber::nc {

/// CYCLE832 of a Sinumerik is read as the word G of this number, which no control has; its first argument, where it is
/// 0 or missing, switches the mode off again (kCycle832Off).
inline constexpr double kCycle832 = 83200, kCycle832Off = 83201;

enum class GGroup {
  motion,         ///< G0 G1 G2 G3
  cycle,          ///< G80, G73, G74, G76, G81-G89
  plane,          ///< G17 G18 G19
  distance,       ///< G90 G91
  arc_distance,   ///< G90.1 G91.1
  feed_mode,      ///< G93 G94 G95
  unit,           ///< G20 G21
  cutter_radius,  ///< G40 G41 G42 G41.1 G42.1
  tool_length,    ///< G43 G44 G49
  work_offset,    ///< G54 .. G59.3, G54.1, G154
  path_control,   ///< G61 G61.1 G62 G63 G64
  return_level,   ///< G98 G99
  one_shot,       ///< G4 G9 G28 G28.1 G29 G30 G30.1 G53 G60
  frame,          ///< G10 G15 G16 G50 G51 G50.1 G51.1 G52 G53.1 G68 G68.2 G69 G92 G254 G255: where coordinates lie
  contouring,     ///< G05 G05.1 G08, and CYCLE832 (kCycle832): modes for fine paths
  macro,          ///< G65 G66 G67: the sequencer's
  no_effect,      ///< read, without effect on the path
  not_read,       ///< known, not supported
  turning,        ///< codes of lathes and mill-turn machines
  unknown
};

struct GCode {
  GGroup group = GGroup::unknown;
  std::string_view name{};  ///< meaning of the code, for not_read and turning
  bool owns_words = false;  ///< not_read: its axis words are no move
};

/// code in tenths: 541 is G54.1.
GCode g_code(int tenths);
/// G110 to G129 of Haas: the number of the additional work offset (1 to 20); 0 for other codes. In other dialects some
/// of them mean other things.
constexpr int haas_work_offset_of(int tenths) {
  return tenths >= 1100 && tenths <= 1290 && tenths % 10 == 0 ? tenths / 10 - 109 : 0;
}
/// Returns all codes of the table, in tenths, ascending.
std::vector<int> known_g_codes();
/// Returns the name of a group as docs/reference/nc-language.md has it, e.g. "work offset".
std::string_view group_name(GGroup group);

enum class MGroup {
  stop,          ///< M0 M1 M60
  end,           ///< M2 M30
  spindle,       ///< M3 M4 M5, M13 M14 (with coolant)
  tool,          ///< M6
  coolant,       ///< M7 M8 M9
  no_effect,     ///< read, without effect on the path
  subprogram,    ///< M97 M98 M99: the sequencer's
  interruption,  ///< M96: not read yet
  unknown
};
MGroup m_code(int tenths);
std::string_view group_name(MGroup group);

}  // namespace camber::nc
