#pragma once
// Runs of G1 laid out again in segments that are just long enough for the control; and rasters on a part, laid out so.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "camber/job.h"
#include "camber/machine.h"
#include "camber/program.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct ResegmentOptions {
  double tolerance_mm = 0.01;  ///< maximum distance between the new and the old path
  double length_mm = 0;        ///< length of the segments; 0: the fastest is looked for
  /// Maximum deviation of the predicted axes from the old path; 0: maximum and rms not above those of the old blocks,
  /// or the tolerance; of a raster no limit.
  double contour_mm = 0;
  bool page = false;     ///< also the result's page
  std::string output{};  ///< name of the new program in messages and on the page; empty: that of the given one
};

/// Predicted axes against the path while cutting.
struct ContourError {
  double time_s = 0, max_um = 0, rms_um = 0;
};

struct ResegmentResult {
  std::string program{};     ///< text of the new program
  bool within_limit = true;  ///< the contour error is; false: this is the closest
  double limit_um = 0;
  ProgramCounts before{}, after{};
  ContourError contour_before{}, contour_after{};
  std::size_t runs = 0, tried = 0;  ///< runs rewritten, layouts tried
  double max_deviation_mm = 0;
  std::string unchanged_because{};        ///< empty: something was rewritten
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber resegment --json` writes them
  std::string printed{};                  ///< the same, as `camber resegment` prints them
  std::string page{};                     ///< the same, as `camber resegment --report` writes them
};

/// Throws InputError, Cancelled.
CAMBER_API ResegmentResult resegment(const Program& program, const Machine& machine, const ResegmentOptions& options,
                                     const RunOptions& run = {});

struct RasterOptions {
  ResegmentOptions layout{};
  std::string part{};         ///< STL; empty: the job's [part] mesh
  std::optional<int> tool{};  ///< not given: the job's only one
  double scallop_mm = 0.01;   ///< maximum scallop height between rows
  double feed_mm_per_min = 1000, spindle_rpm = 10000;
  double direction_deg = 0;              ///< direction of the rows, from +X
  std::vector<double> boundary_mm{};     ///< X0 Y0 X1 Y1; empty: the part's own
  std::optional<double> clearance_mm{};  ///< Z of moves over the part; not given: 5 mm above stock and part
};

struct RasterResult {
  std::string program{};           ///< text
  bool within_limit = true;        ///< the contour error is; false: this is the closest
  bool scallops_too_high = false;  ///< where the surface is steep across the rows
  double limit_um = 0;
  double largest_scallop_mm = 0, closest_rows_mm = 0;
  std::size_t rows = 0, pieces = 0;
  ProgramCounts before{}, after{};  ///< before: the same rows with a point every 0.1 mm
  ContourError contour_before{}, contour_after{};
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber resegment --json` writes them
  std::string printed{};                  ///< the same, as `camber resegment` prints them
  std::string page{};                     ///< the same, as `camber resegment --report` writes them
};

/// A finishing raster on the offset surface of the part of a job, whose program is not needed. Throws InputError,
/// Cancelled.
CAMBER_API RasterResult raster(const Job& job, const RasterOptions& options, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
