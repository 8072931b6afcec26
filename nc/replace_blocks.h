#pragma once
// Re-emission: stretches of blocks replaced by new lines, everything else byte for byte.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "nc/program.h"

namespace camber::nc {

/// Blocks first .. last (both included) become `lines`.
struct BlockReplacement {
  std::uint32_t first = 0, last = 0;  ///< indexes into Program::blocks
  std::vector<std::string> lines;     ///< without line ends; they get the one of block `first`
};

/// The new text. `replacements`: ascending, not overlapping. A last line that the file leaves without a line end stays
/// without one.
std::string replace_blocks(const Program& program, std::span<const BlockReplacement> replacements);

}  // namespace camber::nc
