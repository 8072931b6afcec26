#pragma once
// An NC program as text: blocks and words with their positions in the file, without interpretation, so that it can be
// written again byte for byte.
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "nc/language_id.h"
#include "nc/statement.h"

namespace camber::nc {

/// One word, e.g. `X-12.5`. Offsets count bytes from the start of the file.
struct Word {
  char letter = 0;            ///< upper case; of a word with a comma (,R ,C ,A) lower case
  std::uint8_t value_at = 0;  ///< position of the number's first character, from `offset`
  std::uint16_t length = 0;   ///< letter, blanks inside and number
  std::uint32_t offset = 0;   ///< position of the letter
  double value = 0;           ///< number as written, in the program's unit; NaN: an expression (MacroTables::words)
};

static_assert(sizeof(Word) == 16, "large programs have a hundred million of them");

/// True for ,R ,C and ,A: rounding, chamfer and angle at the end of a block. `offset` is that of the comma.
constexpr bool is_corner_word(const Word& word) { return word.letter >= 'a'; }

/// One line of the file. Comments, % and empty lines are blocks without words.
struct Block {
  std::uint32_t offset = 0;  ///< position of the line's first byte
  std::uint32_t length = 0;  ///< length without the line end
  std::uint32_t first_word = 0;
  std::uint16_t word_count = 0;
  std::uint8_t skip = 0;  ///< begins with / or /1: 1; with /2 .. /9: 2 .. 9
  bool flow = false;      ///< holds statements, expressions or calls (M97 M98 M99, G65 G66 G67)
  bool divided = false;   ///< a `;` stands in the line with words behind it: Program::parts
};

/// Words of a line behind a `;`: a further block for some controls, a comment for others
/// (Dialect::semicolon_ends_block).
struct BlockPart {
  std::uint32_t block = 0;
  std::uint32_t offset = 0;      ///< behind the `;`
  std::uint32_t first_word = 0;  ///< index into Program::words, behind those of the block itself
  std::uint32_t word_count = 0;
};

/// The tree that a language other than ISO makes of a text, beside its words.
struct LanguageTree {
  virtual ~LanguageTree() = default;
};

struct Program {
  LanguageId language = LanguageId::iso;
  std::string language_reason{};               ///< why the text is read in it
  std::shared_ptr<const LanguageTree> tree{};  ///< only for languages other than ISO
  SourceText source;
  std::vector<Block> blocks;  ///< blocks[i] is line i + 1 of the file
  std::vector<Word> words;
  MacroTables macro;
  std::vector<BlockPart> parts;     ///< ascending
  std::uint32_t leader_blocks = 0;  ///< lines before the first %, which are no part of the program
  /// Position of the first comment within a comment, (a (b) c), which some dialects refuse.
  std::uint32_t nested_comment = kNowhere;
  static constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

  /// Words before the first `;` of a divided block.
  std::span<const Word> words_of(std::size_t block) const {
    return {words.data() + blocks[block].first_word, blocks[block].word_count};
  }
  /// Returns the position of the first word of a block, or of the block where it has none.
  std::size_t offset_of(std::size_t block) const {
    return blocks[block].word_count > 0 ? words[blocks[block].first_word].offset : blocks[block].offset;
  }
};

/// Splits a text in blocks and words, in the language that it shows (nc/language.h). Problems go to `diagnostics`;
/// reading resumes at the next block. Throws InputError after Diagnostics::kMaxErrors errors.
Program read_program(SourceText source, Diagnostics& diagnostics);

}  // namespace camber::nc
