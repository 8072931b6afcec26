#include "nc/emit.h"

#include <cassert>
#include <string_view>

#include "nc/emit/emitted_text.h"

namespace camber::nc {
namespace {

/// Returns the text between the end of the block and the next one: "\n", "\r\n"; of a file's last line, what the file
/// uses.
std::string_view line_end_of(const Program& program, std::size_t block) {
  const std::string_view text = program.source.text();
  if (block + 1 < program.blocks.size()) {
    const std::size_t end = program.blocks[block].offset + program.blocks[block].length;
    return text.substr(end, program.blocks[block + 1].offset - end);
  }
  return usual_line_end(program.source);
}

}  // namespace

std::string replace_blocks(const Program& program, std::span<const BlockReplacement> replacements) {
  const std::string& text = program.source.text();
  std::string out;
  out.reserve(text.size());
  std::size_t copied = 0;
  for (const BlockReplacement& r : replacements) {
    assert(r.first <= r.last && r.last < program.blocks.size());
    assert(program.blocks[r.first].offset >= copied);
    out.append(text, copied, program.blocks[r.first].offset - copied);
    const std::string_view line_end = line_end_of(program, r.first);
    for (std::size_t i = 0; i < r.lines.size(); ++i) {
      if (i > 0) out += line_end;
      out += r.lines[i];
    }
    copied = program.blocks[r.last].offset + program.blocks[r.last].length;
  }
  out.append(text, copied);
  return out;
}

}  // namespace camber::nc
