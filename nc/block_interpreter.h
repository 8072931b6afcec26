#pragma once
// Executes one block: gives its codes and words to the parts of the interpreter, each of which has its own state.
// Internal to nc/; the interface is interpreter.h.
//
//   block_context    the block: words, requests, where moves and messages go
//   modal_groups     motion, plane, unit, feed, spindle, tool
//   frame_codes      where programmed coordinates lie
//   rotary_codes     A B C, tool-centre-point control, tilted frames
//   radius_codes     G40, G41, G42
//   whole_numbers    numbers without a decimal point
//   mover            makes moves of all that; arc_moves, cycle_codes, reference_moves and corner_words use it
//
// A part calls those above it only.
#include <optional>

#include "nc/arc_moves.h"
#include "nc/corner_words.h"
#include "nc/cycle_codes.h"
#include "nc/reference_moves.h"

namespace camber::nc {

/// A block to execute: position of its text, and its words.
struct RunBlock {
  const Program& program;       ///< file of the block
  std::uint32_t block = 0;      ///< index in that file
  std::span<const Word> words;  ///< words whose values are numbers
  std::uint32_t called_from;    ///< Move::block: the block itself, or of the main program the one that called the file
  bool editable = true;         ///< Move::editable
};

class BlockInterpreter {
 public:
  BlockInterpreter(const Program& program, const InterpreterOptions& options, Reporter& report, Interpretation& out);
  BlockInterpreter(const BlockInterpreter&) = delete;

  /// Runs one block; false at the end of the program (M2, M30) or where reading on makes no sense.
  bool run(std::uint32_t block) { return run({*at_.program, block, at_.program->words_of(block), block}); }
  bool run(const RunBlock& block);
  MachineFacts facts() const;
  /// The value of an offset in millimetres or degrees; nothing where it is not known.
  std::optional<double> offset_value(const OffsetVariable& variable);
  /// The program sets it (#5221 = 10.). `offset`: in the text.
  void set_offset(const OffsetVariable& variable, double value, std::size_t offset);
  /// Reports what can be said only at the end.
  void finish();
  RunVerdict verdict() const;

 private:
  bool read_g_codes();
  bool read_g_code(const Code& code, const GCode& meaning);
  void set_work_offset(const Code& code);
  void read_frame_code(const Code& code);
  void run_frame_code();
  void align_tool();
  void dwell();
  void move_after_dwell();
  void position_in_one_direction();
  void move();
  void move_on_line();
  void warn_of_unused_words();
  void check_offset_numbers();

  BlockContext at_;
  ToolPlace place_{};
  ModalGroups modal_{at_};
  FrameCodes frames_{at_, modal_, place_};
  RotaryCodes rotary_{at_, modal_, frames_, place_};
  RadiusCodes radius_{at_, modal_, frames_, place_};
  WholeNumbers whole_numbers_{at_, modal_, frames_};
  Mover mover_{at_, modal_, frames_, rotary_, radius_, whole_numbers_, place_};
  ArcMoves arcs_{at_, modal_, frames_, rotary_, radius_, mover_, place_};
  CycleCodes cycles_{at_, modal_, frames_, rotary_, mover_, place_};
  ReferenceMoves references_{at_, modal_, frames_, rotary_, mover_, place_};
  CornerWords corners_{at_, modal_, radius_, whole_numbers_};
};

}  // namespace camber::nc
