#pragma once
// Table of the words of the language: what each is and what the reader does with it
// (docs/reference/nc-language-siemens.md).
#include <cstdint>
#include <span>
#include <string_view>

namespace camber::nc::siemens {

enum class WordKind : std::uint8_t {
  address,   ///< NAME=value, NAME[..]=value
  command,   ///< alone
  cycle,     ///< NAME(...): moves, or would
  procedure  ///< NAME(...): a predefined one that does not move
};

/// Treatment of a word by the interpreter.
enum class Does : std::uint8_t {
  nothing,  ///< has no effect on the path: read, and nothing is said
  noted,    ///< read without effect, and said: the path or its time depends on it on a real control
  refused,  ///< [not-supported]
  // addresses
  extra,                 // those of Extra
  modal_rounding,        // RNDM
  corner_feed,           // FRC, FRCM
  block_feed,            // FB
  blend_distance_rapid,  // ADISPOS
  contour_tolerance,     // CTOL
  offset_normal,         // OFFN
  spindle_position,      // SPOS SPOSA
  position_axis,         // POS POSA POSP
  // commands
  supa,
  frame,  // TRANS ...
  cip,
  ct,
  transform_on,   // TRAORI
  transform_off,  // TRAFOOF
  contour_mode,   // COMPON ...
  contour_mode_off,
  mode_word,  // SOFT ...: nc/mode_words.h
  cycle832,
  cycle800,
  drilling,        // CYCLE81 ...
  pattern,         // HOLES1 ...
  thread_milling,  // CYCLE90
  pocket,          // POCKET3, POCKET4
  slots,           // LONGHOLE, SLOT1
  face,            // CYCLE61, CYCLE71
  modal_call,      // MCALL
  alarm,           // SETAL
  end_subprogram,  // RET
  workpiece,
  main_spindle,  // SETMS
  call_text,     // CALL, PCALL
  home           // machine's own positions
};

struct WordRow {
  std::string_view name;
  WordKind kind = WordKind::command;
  Does does = Does::nothing;
  std::string_view what;          ///< text for the table
  std::string_view instead = {};  ///< refused: what could be done
};

/// Returns all words, by name.
std::span<const WordRow> word_rows();
/// Null for a name that is none of them.
const WordRow* find_word(std::string_view upper_name);

/// Functions of expressions: SIN, SQRT ...; arguments at least and at most.
struct FunctionRow {
  std::string_view names;
  std::uint8_t least = 1, most = 1;
};
const FunctionRow* find_function(std::string_view upper_name);

}  // namespace camber::nc::siemens
