#pragma once
// The block that runs: its words, what its codes ask for, and where the result and the messages go. Internal to nc/.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "nc/block_words.h"
#include "nc/interpreter.h"

namespace camber::nc {

inline constexpr char kAxisLetters[] = "XYZ";

/// Non-modal actions of the G codes of one block.
struct BlockRequest {
  bool dwell = false, exact_stop = false, machine_frame = false, reference = false;
  bool motion_given = false, cycle_given = false, feed_mode_given = false;
  bool skip_motion = false;  ///< the axis words belong to something that is not read
  bool trouble = false;      ///< an error was reported: say nothing of unused words
  const Word* motion_word = nullptr;
  const Word* reference_word = nullptr;
  Code frame_code{};  ///< a code whose words set a frame or an offset (G10, G52, G68 ...); no word: none
  bool return_from_reference = false;
  bool single_direction = false;  ///< G60
};

/// State and options shared by all parts of the interpreter.
struct BlockContext {
  const InterpreterOptions& options;
  Reporter& report;
  Interpretation& out;
  const Program& main;
  const Program* program;  ///< file of the block
  std::uint32_t block = 0;
  bool editable = true;
  BlockWords words{};
  BlockRequest request{};
  bool not_editable_told = false;
  ReliedEnds relied_ends{};

  const Dialect& dialect() const { return options.dialect_or_default(); }
  void error(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});
  std::string code_text(const Code& code) const;
  bool written_with_point(const Word& word) const;
  bool written_as_number(const Word& word) const;
  /// The time of a dwell; nothing where the block has no such word.
  std::optional<double> dwell_seconds(char letter);
};

/// State of knowledge of an axis position in the work frame.
enum class AxisPlace : std::uint8_t {
  never,      ///< not programmed so far; its coordinate counts as 0
  reference,  ///< at the reference point or at a machine coordinate (G28, G30, G53)
  known
};

/// Position of the tool in the frame of the moves, and which coordinates are known.
struct ToolPlace {
  Vec3 position_mm = Vec3::Zero();
  std::array<AxisPlace, 3> axis{AxisPlace::never, AxisPlace::never, AxisPlace::never};
  bool unknown() const {
    return std::any_of(axis.begin(), axis.end(), [](AxisPlace p) { return p != AxisPlace::known; });
  }
};

}  // namespace camber::nc
