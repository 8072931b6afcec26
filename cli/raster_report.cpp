#include "cli/raster_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/numbers.h"
#include "cli/rewrite_report.h"

namespace camber::cli {
namespace {

constexpr double kEdgeCosine = 0.97;  ///< of 14 degrees: where two triangles meet in an edge that is drawn
constexpr std::size_t kMaxEdges = 20000;
constexpr std::size_t kBins = 40;

void add_line(report::PathPicture& picture, const Vec3& from, const Vec3& to) {
  for (const auto& [point, kind] :
       {std::pair{from, report::PathKind::start}, std::pair{to, report::PathKind::kept_line}}) {
    picture.points.push_back(point);
    picture.kind.push_back(kind);
    picture.block.push_back(0);
    picture.ends.push_back(0);
  }
}

/// The edges of the part; of one that has too many (or none, as a ball) its box as seen from above.
report::PathPicture outline(const TriangleMesh& part) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> normals;
  report::PathPicture out;
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const auto& p : part.points) low = low.cwiseMin(p.cast<double>()), high = high.cwiseMax(p.cast<double>());
  for (const auto& t : part.triangles) {
    const auto at = [&](std::size_t k) -> Vec3 { return part.points[t[k]].cast<double>(); };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      const auto [found, first] = normals.try_emplace({a, b}, normal);
      if (!first && found->second.dot(normal) < kEdgeCosine)
        add_line(out, part.points[a].cast<double>(), part.points[b].cast<double>());
    }
  }
  if (!out.points.empty() && out.points.size() <= 2 * kMaxEdges) return out;
  out = {};
  const std::array<Vec3, 4> box{Vec3(low.x(), low.y(), high.z()), Vec3(high.x(), low.y(), high.z()),
                                Vec3(high.x(), high.y(), high.z()), Vec3(low.x(), high.y(), high.z())};
  for (std::size_t k = 0; k < box.size(); ++k) add_line(out, box[k], box[(k + 1) % box.size()]);
  return out;
}

/// Amounts by value, from zero to a little above the greatest.
report::FractionHistogram histogram(const std::string& title, const std::string& fraction_of, const std::string& axis,
                                    const std::vector<std::pair<double, double>>& value_and_amount) {
  report::FractionHistogram out{title, fraction_of, axis, 0, 1e-3, 4, std::vector<double>(kBins, 0)};
  for (const auto& [value, amount] : value_and_amount) out.to = std::max(out.to, 1.02 * value);
  for (const auto& [value, amount] : value_and_amount)
    out.amounts[std::min(kBins - 1, static_cast<std::size_t>(value / out.to * kBins))] += amount;
  return out;
}

std::vector<std::pair<double, double>> spaces(const std::vector<double>& rows_mm) {
  std::vector<std::pair<double, double>> out;
  for (std::size_t k = 1; k < rows_mm.size(); ++k) out.emplace_back(rows_mm[k] - rows_mm[k - 1], 1);
  return out;
}

std::vector<std::pair<double, double>> segments(const nc::Interpretation& program) {
  std::vector<std::pair<double, double>> out;
  for (const nc::Move& m : program.moves)
    if (m.kind == nc::MoveKind::linear) out.emplace_back(nc::length_mm(program, m), nc::length_mm(program, m));
  return out;
}

std::vector<report::Figure> figures(const RasterResult& r) {
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  const auto& [before, after] = std::pair{r.figures_before, r.figures_after};
  const auto [least, most] = row_spaces_mm(r.raster.spacing);
  return {{"time", r.contour_before.time_s, r.contour_after.time_s, "s", 1, "time_{}_s"},
          {"blocks", count(before.blocks), count(after.blocks), "", 0, "blocks_{}"},
          {"contour error, largest", 1000 * r.contour_before.contour_max_mm, 1000 * r.contour_after.contour_max_mm,
           "um", 1, "contour_{}_um.max"},
          {"contour error, rms", 1000 * r.contour_before.contour_rms_mm, 1000 * r.contour_after.contour_rms_mm, "um", 1,
           "contour_{}_um.rms"},
          {"cutting length", before.length_mm, after.length_mm, "mm", 1, "length_{}_mm"},
          {"rows", count(r.raster.spacing.rows_mm.size()), std::nullopt, "", 0, "rows"},
          {"pieces of rows", count(r.raster.pieces), std::nullopt, "", 0, "pieces"},
          {"links along the surface", count(r.raster.links), std::nullopt, "", 0, "links.surface"},
          {"links over the clearance plane", count(r.raster.chains.size() - 1), std::nullopt, "", 0, "links.clearance"},
          {"minimum row distance", least, std::nullopt, "mm", 3, "row_spacing_mm.min"},
          {"maximum row distance", most, std::nullopt, "mm", 3, "row_spacing_mm.max"},
          {"requested scallop", r.scallop_mm, std::nullopt, "mm", 4, "scallop_mm.asked"},
          {"largest scallop", r.raster.spacing.largest_scallop_mm, std::nullopt, "mm", 4, "scallop_mm.largest"},
          {"tolerance", r.tolerance_mm, std::nullopt, "mm", 4, "tolerance_mm"}};
}

}  // namespace

std::pair<double, double> row_spaces_mm(const repath::RowSpacing& spacing) {
  const auto& rows = spacing.rows_mm;
  double least = rows.size() > 1 ? rows[1] - rows[0] : 0, most = least;
  for (std::size_t k = 1; k < rows.size(); ++k)
    least = std::min(least, rows[k] - rows[k - 1]), most = std::max(most, rows[k] - rows[k - 1]);
  return {least, most};
}

report::RewritePage raster_page(const RasterResult& r) {
  report::RewritePage page;
  page.figures = figures(r);
  page.tolerance_mm = r.tolerance_mm;
  page.max_deviation_mm = r.result.path.max_deviation_mm;
  page.deviation = false;
  page.part = outline(r.part);
  const report::BlockRanges all{{0, ~0u}};
  page.before = report::path_picture(r.before, all, report::kMaxPicturePoints);
  page.after = report::path_picture(r.after, all, report::kMaxPicturePoints);
  page.histograms = {histogram("Row distance", "% of the spaces", "distance of neighbouring rows, mm",
                               spaces(r.raster.spacing.rows_mm)),
                     histogram("Segment length", "% of the length cut", "length of a segment, mm", segments(r.after))};
  page.tables.push_back(tried_table(r.result.tried));
  page.notes.push_back(
      fmt::format("Before: the same rows with a point every {} mm. After: the program that was written.",
                  format_trimmed(r.compared_step_mm, 3)));
  if (r.raster.spacing.steep_fraction > 0)
    page.notes.push_back("Scallops are higher than requested where the surface is steep across the rows.");
  return page;
}

}  // namespace camber::cli
