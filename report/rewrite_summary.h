#pragma once
// What compress, resegment and the raster tell of a path that is written anew: JSON, text for a terminal, and the page.
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/triangle_mesh.h"
#include "nc/interpreter.h"
#include "repath/compress.h"
#include "repath/fastest.h"
#include "repath/path_deviation.h"
#include "repath/raster.h"
#include "report/rewrite_page.h"

namespace camber::report {

/// Blocks that hold a word; cutting moves that are lines and arcs, and their length.
struct ProgramFigures {
  std::size_t blocks = 0, lines = 0, arcs = 0;
  double length_mm = 0;
};
ProgramFigures program_figures(const nc::Program& program, const nc::Interpretation& moves);

/// Names and moves of both programs.
struct BothPaths {
  std::string program, output;
  const nc::Interpretation &before, &after;
  const repath::DeviationFigures& measured;
};

struct CompressSummary {
  ProgramFigures before, after;
  std::optional<double> time_before_s, time_after_s;                    ///< on the machine
  std::optional<double> time_at_feeds_before_s, time_at_feeds_after_s;  ///< of the cuts, at the feeds of lines and arcs
  const repath::Compression& result;
  double tolerance_mm = 0;
  std::string why;  ///< it is unchanged; empty: it is not
};
std::string compress_text(const CompressSummary& summary);
std::string compress_json(const CompressSummary& summary, const repath::DeviationFigures& measured);
std::string compress_page(const CompressSummary& summary, const BothPaths& paths);

struct ResegmentSummary {
  ProgramFigures before, after;
  repath::ContourFigures contour_before;
  const repath::Fastest& result;
  double tolerance_mm = 0;
  const repath::DeviationFigures& measured;
  std::string why;  ///< it is unchanged; empty: it is not

  repath::Candidate chosen() const {
    return result.gains ? result.tried[result.chosen] : repath::Candidate{.figures = contour_before};
  }
};
std::string resegment_text(const ResegmentSummary& summary);
std::string resegment_json(const ResegmentSummary& summary);
std::string resegment_page(const ResegmentSummary& summary, const BothPaths& paths);

/// "Before" is the raster of constant steps.
struct RasterSummary {
  std::string part, output;  ///< names
  const TriangleMesh& mesh;
  const repath::Raster& raster;
  const repath::Fastest& result;
  const nc::Interpretation &moves_before, &moves_after;
  ProgramFigures before, after;
  repath::ContourFigures contour_before;
  double scallop_mm = 0, tolerance_mm = 0, compared_step_mm = 0;

  const repath::Candidate& chosen() const { return result.tried[result.chosen]; }
};
std::string raster_text(const RasterSummary& summary);
std::string raster_json(const RasterSummary& summary);
std::string raster_page(const RasterSummary& summary);

}  // namespace camber::report
