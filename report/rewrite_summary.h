#pragma once
// What compress, resegment and the raster tell of a path that is written anew: JSON, text for a terminal, and the page.
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/triangle_mesh.h"
#include "nc/interpreter.h"
#include "repath/compress/compression.h"
#include "repath/path_deviation.h"
#include "repath/post/post_processing.h"
#include "repath/raster/raster.h"
#include "repath/resegment/fastest.h"
#include "report/html_report.h"
#include "report/path_card.h"

namespace camber::report {

// The page of camber compress and camber resegment: what became of the program, or a raster, before and after.

/// Bars of amounts, as per cent of their sum, in equal bins from one value to another.
struct FractionHistogram {
  std::string title;
  std::string fraction_of;  ///< "% of the rewritten length"
  std::string axis;         ///< "deviation, um"
  double from = 0, to = 1;
  int decimals = 3;  ///< decimals of the axis' numbers, at most
  std::vector<double> amounts;
};

struct RewritePage {
  std::string title, subtitle;
  std::vector<Figure> figures;  ///< before and after; the first three are shown large
  double tolerance_mm = 0.01;
  double max_deviation_mm = 0;                 ///< as the fit bounds it
  bool deviation = true;                       ///< a card says how the new path lies from the old one
  double measured_deviation_mm = 0;            ///< by points laid densely on both paths
  Vec3 worst_place_mm = Vec3::Zero();          ///< where that is
  std::vector<double> length_by_deviation_mm;  ///< rewritten length in bins from 0 to the tolerance
  std::size_t runs = 0;                        ///< rewritten
  PathPicture before, after;
  PathPicture part;  ///< drawn below both; empty: none. The page then opens with the view from the top
  std::vector<FractionHistogram> histograms;
  std::vector<TextTable> tables;
  std::vector<std::string> notes;
};

/// The page's text, UTF-8, self-contained. The same data give the same bytes. Does not throw.
std::string rewrite_page(const RewritePage& page);

/// Needs no script. A sentence where the amounts are all zero.
std::string fractions_svg(const FractionHistogram& histogram);

// The figures of camber post: JSON and text for a terminal.

struct PostSummary {
  repath::PostOptions asked;
  repath::Posted posted;
  repath::PostDeviation deviation;  ///< by sampling
  std::size_t blocks_before = 0, blocks_after = 0;
};

/// With a line end.
std::string post_json(const PostSummary& summary);
/// For a terminal.
std::string post_text(const PostSummary& summary);

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
