#pragma once
// camber resegment --part: a finishing raster on the offset surface of a part.
#include <optional>
#include <string>
#include <vector>

#include "cli/global_options.h"

namespace camber::cli {

struct RasterArguments {
  std::string part, job, output;
  std::string json;         ///< empty: none
  std::string report;       ///< the page; empty: none
  std::optional<int> tool;  ///< not given: the job's only one
  double tolerance_mm = 0, scallop_mm = 0;
  double feed_mm_per_min = 0, spindle_rpm = 0;
  double direction_deg = 0;            ///< direction of the rows, from +X
  std::vector<double> boundary_mm;     ///< X0 Y0 X1 Y1; empty: the part's own
  std::optional<double> clearance_mm;  ///< Z; not given: 5 mm above stock and part
  double length_mm = 0;                ///< 0: the fastest is looked for
  double contour_mm = 0;               ///< most that the predicted axes may stray; 0: no limit
};

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut where scallops stay higher than asked for, or no length
/// keeps the axes as near as asked for.
int run_raster(const RasterArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
