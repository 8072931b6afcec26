#pragma once
// Puts the emitted text together: the given one, blocks that become others, and a header.
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nc/program_text.h"

namespace camber::nc {

/// Line end behind which a further line of the text begins: "\n", "\r\n" or "\r".
std::string_view usual_line_end(const SourceText& source);

class TextRules;

class EmittedText {
 public:
  EmittedText(const Program& program, const TextRules& rules);

  /// The block becomes `text` (which may hold several lines). At most once for a block, in any order: subprograms run
  /// out of the order of the text.
  void replace(std::uint32_t block, std::string text);
  /// A line of its own behind the block's (new) text.
  void add_line_behind(std::uint32_t block, const std::string& line);

  /// "\n", "\r\n" or "\r", as behind the block.
  std::string line_end_of(std::uint32_t block) const;

  /// The whole text, `header` (lines of comments; empty: none) behind the name of the program.
  std::string text(const std::string& header);
  /// Emission::block_of_line of what text() gave.
  std::vector<std::uint32_t> block_of_lines() const;

 private:
  void copy_until(std::size_t offset);
  void add_header(const std::string& header);

  const Program& program_;
  const TextRules& rules_;
  std::string line_end_;
  std::string out_;
  std::size_t copied_ = 0;                                       ///< bytes of the source that are in out_ or replaced
  std::vector<std::pair<std::uint32_t, std::string>> replaced_;  ///< blocks and their new text
  std::size_t header_before_ = 0, header_lines_ = 0;             ///< the header stands before this block
};

}  // namespace camber::nc
