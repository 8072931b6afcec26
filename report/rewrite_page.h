#pragma once
// The page of camber compress and camber resegment: what became of the program, or a raster, before and after.
#include <optional>
#include <string>
#include <vector>

#include "report/html_report.h"
#include "report/path_card.h"

namespace camber::report {

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

}  // namespace camber::report
