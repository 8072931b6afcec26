#pragma once
// Which blocks of a program say nothing but where a cut goes: what else stands in them repeats what is in force.
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "nc/program_text.h"

namespace camber::repath {

/// What keeps a block from being rewritten together with others.
enum class Apart : std::uint8_t {
  nothing,
  comment,       ///< or a sign
  word,          ///< an M, T, G or other word that changes something
  number,        ///< N in a program with macros or subprograms: it may be jumped to
  macro,         ///< expressions, statements, calls
  skip,          ///< block skip (/)
  behind_skip,   ///< the place or the code in force depends on the switch
  several,       ///< several blocks in one line, or several moves of one block
  feed,          ///< another feed than before
  state,         ///< another spindle speed, plane, offset ... than before
  between,       ///< lines without cuts stand between
  stop,          ///< exact stop
  feed_mode,     ///< inverse time, feed per revolution
  radius,        ///< G41, G42
  frame,         ///< turned, scaled or polar coordinates
  not_editable,  ///< moves of loops, expressions, subprograms, corner words, cycles
  count
};
using ApartCounts = std::array<std::size_t, static_cast<std::size_t>(Apart::count)>;
/// For messages: "a comment in the block".
std::string_view reason_of(Apart apart);

class PlainBlocks {
 public:
  /// `arcs`: G2, G3 and their words are plain too.
  PlainBlocks(const nc::Program& program, bool arcs);

  /// Returns what keeps a block out of a run; as the `first` one its words may change what is in force.
  Apart apart(std::size_t block, bool first) const {
    return first ? static_cast<Apart>(blocks_[block] >> 8) : static_cast<Apart>(blocks_[block] & 0xff);
  }

 private:
  std::vector<std::uint16_t> blocks_;
};

/// Words of a block that are neither N, coordinates, words of arcs nor codes of motion, as written; in the order of the
/// text. Those of a run's first block stand in the block that takes its place.
std::vector<nc::Word> further_words_of(std::span<const nc::Word> words);

}  // namespace camber::repath
