#pragma once
// The page that compress and resegment write.
#include <span>
#include <string>
#include <vector>

#include "nc/interpreter.h"
#include "repath/compress.h"
#include "repath/fastest.h"
#include "repath/path_deviation.h"
#include "report/rewrite_page.h"

namespace camber::cli {

struct Rewriting {
  const nc::Interpretation &before, &after;
  std::span<const repath::RewrittenRun> runs;
  double tolerance_mm = 0, max_deviation_mm = 0;
  const repath::DeviationFigures& measured;
};

/// Pictures, deviations and the figures given; title and tables are the caller's.
report::RewritePage rewrite_page_of(const Rewriting& rewriting, std::vector<report::Figure> figures);

/// The lengths that were tried, and what each came to.
report::TextTable tried_table(std::span<const repath::Candidate> tried);

/// "length x 2.00, feed x 0.70, x 0.50 about corners, 0.150 s between them": the last two where they are asked for.
std::string feeds_text(const repath::Candidate& c);

/// "p.nc to out.nc, tolerance 0.01 mm, camber 0.1.0"
std::string rewrite_subtitle(const std::string& program, const std::string& output, double tolerance_mm);

}  // namespace camber::cli
