#pragma once
// A chain of primitives as NC blocks, in the style of the program.
#include <memory>
#include <string>
#include <vector>

#include "nc/emit/number_style.h"
#include "nc/emit/text_rules.h"
#include "repath/compress/compression.h"
#include "repath/resegment/resegmentation.h"

namespace camber::repath {

/// How the whole program writes; worked out once.
struct TextStyle {
  nc::NumberStyle numbers, feeds;
  int decimals = 3;              ///< the most that a coordinate has; at least 3 (mm) or 4 (inch)
  bool two_digit_codes = false;  ///< G01 rather than G1
  std::shared_ptr<nc::TextRules> rules{};
};
TextStyle text_style_of(const nc::Program& program, const nc::Interpretation& moves);

/// The blocks of the chain: the N of the block that ended where the primitive ends, G1 G2 G3 where the mode changes (or
/// always, where the program does so), X Y Z that change (arcs: both of the plane, but for a full turn), I J K, and the
/// further words of the run's first block (F, S, M8 ...). `says_mode`: the first block says its G1, G2 or G3.
struct RunLines {
  std::vector<std::string> lines;
  std::vector<std::size_t> line_of{};  ///< by primitive: the one in which its move is
  std::string mode_behind{};  ///< G1, where the chain ends on an arc and the blocks behind rely on G1; else empty
};
RunLines text_of(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run, const RunPath& path,
                 const std::vector<Primitive>& chain, const TextStyle& style, bool says_mode);

/// What the segments of a layout get of the programmed feed; see ResegmentOptions.
struct LayoutFeeds {
  double factor = 1;
  CornerFeeds corners{};
};

/// Whether a block behind `block` moves axes in the mode (G1 G2 ..) that `block` leaves.
bool mode_is_used_behind(const nc::Program& program, std::size_t block);

/// The blocks of straight cuts to the points of a layout but its first: X Y Z that change, the N of the old block that
/// ended where the new one does (each once), G1 as the run has it (and where it begins with an arc), and the F of the
/// run's first block; where the feed is another one, that, and the programmed one in a block of its own behind.
std::vector<std::string> text_of(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run,
                                 const SpacePath& path, const Layout& layout, const TextStyle& style,
                                 const LayoutFeeds& feeds);

}  // namespace camber::repath
