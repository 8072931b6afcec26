#include "cli/rewrite_report.h"

#include <fmt/format.h>

#include "base/numbers.h"

namespace camber::cli {

report::RewritePage rewrite_page_of(const Rewriting& rewriting, std::vector<report::Figure> figures) {
  report::RewritePage page;
  page.figures = std::move(figures);
  page.tolerance_mm = rewriting.tolerance_mm;
  page.max_deviation_mm = rewriting.max_deviation_mm;
  page.measured_deviation_mm = rewriting.measured.max_mm;
  page.worst_place_mm = rewriting.measured.worst_place_mm;
  page.length_by_deviation_mm = rewriting.measured.length_by_deviation_mm;
  page.runs = rewriting.runs.size();
  report::BlockRanges old_blocks, new_blocks;
  for (const repath::RewrittenRun& run : rewriting.runs) {
    old_blocks.emplace_back(run.first_block, run.last_block);
    new_blocks.emplace_back(run.first_block_after, run.last_block_after);
  }
  page.before = report::path_picture(rewriting.before, old_blocks, report::kMaxPicturePoints);
  page.after = report::path_picture(rewriting.after, new_blocks, report::kMaxPicturePoints);
  return page;
}

report::TextTable tried_table(std::span<const repath::Candidate> tried) {
  report::TextTable table{
      "Lengths tried",
      {"length x L_b", "feed x", "x about corners", "s between them", "time, s", "contour error, um", "rms"},
      {},
      {}};
  for (const auto& c : tried)
    table.rows.push_back({fmt::format("{:.2f}", c.length_factor), fmt::format("{:.2f}", c.feed_factor),
                          fmt::format("{:.2f}", c.corners.fraction), fmt::format("{:.3f}", c.corners.settle_s),
                          fmt::format("{:.1f}", c.figures.time_s),
                          fmt::format("{:.1f}", 1000 * c.figures.contour_max_mm),
                          fmt::format("{:.1f}", 1000 * c.figures.contour_rms_mm)});
  return table;
}

std::string feeds_text(const repath::Candidate& c) {
  std::string out = fmt::format("length x {:.2f}, feed x {:.2f}", c.length_factor, c.feed_factor);
  if (c.corners.fraction != 1) out += fmt::format(", x {:.2f} about corners", c.corners.fraction);
  if (c.corners.settle_s > 0) out += fmt::format(", {:.3f} s between them", c.corners.settle_s);
  return out;
}

std::string rewrite_subtitle(const std::string& program, const std::string& output, double tolerance_mm) {
  return fmt::format("{} to {}, tolerance {} mm, camber {}", program, output, format_trimmed(tolerance_mm, 5),
                     CAMBER_VERSION);
}

}  // namespace camber::cli
