#pragma once
// A path without its stamps: what lies where, and what must be known of all of them.
#include <cstddef>
#include <vector>

#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::simulate {

/// Collected from the stamps one by one, in order.
struct PathOutline {
  struct Run {
    removal::Region tips;
    double longest_feed_mm = 0;  ///< of the tip, from one stamp to the next
  };
  static constexpr std::size_t kBlock = 256;  ///< stamps

  std::vector<removal::ToolRun> runs;   ///< with their counts
  std::vector<Run> of_runs;             ///< the same
  std::vector<removal::Region> blocks;  ///< of the tips of kBlock stamps each
  std::size_t stamps = 0;
  bool upright = true;

  void add(const removal::ToolRun& run, const removal::Stamp& stamp);
};

}  // namespace camber::simulate
