#pragma once
// The page of camber compress and camber resegment: what became of the program, before and after.
#include <optional>
#include <string>
#include <vector>

#include "report/html_report.h"
#include "report/path_picture.h"

namespace camber::report {

struct RewritePage {
  std::string title, subtitle;
  std::vector<Figure> figures;  ///< before and after; the first three are shown large
  double tolerance_mm = 0.01;
  double max_deviation_mm = 0;                 ///< as the fit bounds it
  double measured_deviation_mm = 0;            ///< by points laid densely on both paths
  Vec3 worst_place_mm = Vec3::Zero();          ///< where that is
  std::vector<double> length_by_deviation_mm;  ///< rewritten length in bins from 0 to the tolerance
  std::size_t runs = 0;                        ///< rewritten
  PathPicture before, after;
  std::vector<TextTable> tables;
  std::vector<std::string> notes;
};

/// Points of a picture, of each of the two paths, that the page draws at most.
constexpr std::size_t kMostPicturePoints = 80000;

/// The page's text, UTF-8, self-contained. The same data give the same bytes. Does not throw.
std::string rewrite_page(const RewritePage& page);

/// Bars: per cent of the rewritten length by its distance from the old path. Needs no script.
std::string deviation_svg(const RewritePage& page);

}  // namespace camber::report
