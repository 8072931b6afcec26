#pragma once
// The page of a raster on a part.
#include <string>

#include "cli/program_figures.h"
#include "repath/fastest.h"
#include "repath/raster.h"
#include "report/rewrite_page.h"

namespace camber::cli {

/// Data of the raster's report: the part, the raster, its comparison and its result. "Before" is the raster of
/// constant steps.
struct RasterResult {
  const TriangleMesh& part;
  const repath::Raster& raster;
  const repath::Fastest& result;
  const nc::Interpretation &before, &after;
  ProgramFigures figures_before, figures_after;
  repath::ContourFigures contour_before, contour_after;
  double scallop_mm = 0, tolerance_mm = 0, compared_step_mm = 0;
};

/// Least and greatest distance of neighbouring rows; zero for a single row.
std::pair<double, double> row_spaces_mm(const repath::RowSpacing& spacing);

/// Everything but title and subtitle. Figures name the keys of the raster's --json.
report::RewritePage raster_page(const RasterResult& raster);

}  // namespace camber::cli
