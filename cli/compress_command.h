#pragma once
// camber compress: many G1 to few G1, G2 and G3 within a tolerance.
#include <optional>
#include <string>

#include "cli/global_options.h"
#include "nc/interpreter.h"

namespace camber::cli {

struct CompressArguments {
  std::string program, output;
  std::string machine;  ///< empty: no times
  std::string json;     ///< empty: none
  std::string report;   ///< the page; empty: none
  double tolerance_mm = 0;
  double tangent_deg = 1;  ///< most that arcs may kink against what is beside them; 180: not bounded
  /// Feeds of a control that runs arcs faster than lines: the least time is sought instead of the fewest blocks.
  std::optional<double> line_feed_mm_per_min, arc_feed_mm_per_min;
  double block_s = 0.005;
  bool lines_only = false;
  bool switch_planes = false;
  bool helices = false;
  nc::InterpreterOptions interpreter;
};

/// Throws InputError. Returns kDone.
int run_compress(const CompressArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
