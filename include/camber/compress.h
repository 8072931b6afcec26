#pragma once
// Many G1 replaced by few G1, G2 and G3 within a tolerance.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "camber/machine.h"
#include "camber/program.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct CompressOptions {
  double tolerance_mm = 0.01;  ///< maximum distance between the new and the old path
  double tangent_deg = 1;      ///< maximum kink of an arc and its neighbour where the program is smooth; 180: any
  /// Feeds that the control reaches on lines and on arcs, both or none: the least time instead of the fewest blocks.
  std::optional<double> line_feed_mm_per_min{}, arc_feed_mm_per_min{};
  double block_s = 0.005;      ///< with these feeds: additional time per block
  bool lines_only = false;     ///< no arcs
  bool helices = false;        ///< also helical arcs where the path is three-dimensional
  bool switch_planes = false;  ///< also arcs in other planes than the program's, with G17 G18 G19 around them
  bool json = true;            ///< also CompressResult::json, for which the deviation is measured
  bool page = false;           ///< also CompressResult::page
  std::string output{};        ///< name of the new program in messages and on the page; empty: that of the given one
};

struct CompressResult {
  std::string program{};  ///< text of the new program
  ProgramCounts before{}, after{};
  std::size_t runs = 0;                                   ///< rewritten
  double max_deviation_mm = 0, max_kink_deg = 0;          ///< kink: at an arc
  std::optional<double> time_before_s{}, time_after_s{};  ///< on the machine, where one is given
  std::string unchanged_because{};                        ///< empty: something was rewritten
  std::vector<Diagnostic> diagnostics{};                  ///< warnings
  std::string json{};                                     ///< all figures, as `camber compress --json` writes them
  std::string printed{};                                  ///< the same, as `camber compress` prints them
  std::string page{};                                     ///< the same, as `camber compress --report` writes them
};

/// Throws InputError, Cancelled.
CAMBER_API CompressResult compress(const Program& program, const CompressOptions& options, const RunOptions& run = {});
/// Read as the machine's control reads it, with the times before and after.
CAMBER_API CompressResult compress(const Program& program, const Machine& machine, const CompressOptions& options,
                                   const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
