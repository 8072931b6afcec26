#include "report/rewrite_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/json.h"
#include "base/numbers.h"
#include "base/units.h"

namespace camber::report {

ProgramFigures program_figures(const nc::Program& program, const nc::Interpretation& moves) {
  ProgramFigures f;
  for (const nc::Block& block : program.blocks) f.blocks += block.word_count > 0;
  for (const nc::Move& move : moves.moves) {
    if (move.kind != nc::MoveKind::linear && move.kind != nc::MoveKind::arc) continue;
    ++(move.kind == nc::MoveKind::arc ? f.arcs : f.lines);
    f.length_mm += nc::length_mm(moves, move);
  }
  return f;
}

namespace {

/// "p.nc to out.nc, tolerance 0.01 mm, camber 0.1.0"
std::string rewrite_subtitle(const std::string& program, const std::string& output, double tolerance_mm) {
  return fmt::format("{} to {}, tolerance {} mm, camber {}", program, output, format_trimmed(tolerance_mm, 5),
                     CAMBER_VERSION);
}

/// Pictures, deviations and the figures given.
RewritePage page_of(const BothPaths& paths, std::span<const repath::RewrittenRun> runs, double tolerance_mm,
                    double max_deviation_mm, std::vector<Figure> figures) {
  RewritePage page;
  page.subtitle = rewrite_subtitle(paths.program, paths.output, tolerance_mm);
  page.figures = std::move(figures);
  page.tolerance_mm = tolerance_mm;
  page.max_deviation_mm = max_deviation_mm;
  page.measured_deviation_mm = paths.measured.max_mm;
  page.worst_place_mm = paths.measured.worst_place_mm;
  page.length_by_deviation_mm = paths.measured.length_by_deviation_mm;
  page.runs = runs.size();
  BlockRanges old_blocks, new_blocks;
  for (const repath::RewrittenRun& run : runs) {
    old_blocks.emplace_back(run.first_block, run.last_block);
    new_blocks.emplace_back(run.first_block_after, run.last_block_after);
  }
  page.before = path_picture(paths.before, old_blocks, kMaxPicturePoints);
  page.after = path_picture(paths.after, new_blocks, kMaxPicturePoints);
  return page;
}

/// The lengths that were tried, and what each came to.
TextTable tried_table(std::span<const repath::Candidate> tried) {
  TextTable table{
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

/// "length x 2.00, feed x 0.70, x 0.50 about corners, 0.150 s between them": the last two where they are asked for.
std::string candidate_text(const repath::Candidate& c) {
  std::string out = fmt::format("length x {:.2f}, feed x {:.2f}", c.length_factor, c.feed_factor);
  if (c.corners.fraction != 1) out += fmt::format(", x {:.2f} about corners", c.corners.fraction);
  if (c.corners.settle_s > 0) out += fmt::format(", {:.3f} s between them", c.corners.settle_s);
  return out;
}

Json contour_json(const repath::ContourFigures& f) {
  return {{"max", 1000 * f.contour_max_mm}, {"rms", 1000 * f.contour_rms_mm}};
}

Json candidate_json(const repath::Candidate& c) {
  return {{"length_factor", c.length_factor}, {"feed_factor", c.feed_factor}, {"corner_feed_share", c.corners.fraction},
          {"settle_s", c.corners.settle_s},   {"time_s", c.figures.time_s},   {"contour_um", contour_json(c.figures)}};
}

std::vector<Figure> compress_figures(const CompressSummary& s) {
  const ProgramFigures &before = s.before, &after = s.after;
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  std::vector<Figure> out = {{"blocks", count(before.blocks), count(after.blocks), "", 0, "blocks_{}"},
                             {"straight cuts", count(before.lines), count(after.lines), "", 0, "lines_before", "lines"},
                             {"arcs", count(before.arcs), count(after.arcs), "", 0, "arcs_before", "arcs"},
                             {"cutting length", before.length_mm, after.length_mm, "mm", 1, "length_{}_mm"}};
  if (s.time_at_feeds_before_s)
    out.insert(out.begin() + 1, {"cuts at the given feeds", *s.time_at_feeds_before_s, *s.time_at_feeds_after_s, "s", 1,
                                 "time_at_feeds_{}_s"});
  if (s.time_before_s && s.time_after_s)
    out.insert(out.begin() + 1, {"time", *s.time_before_s, *s.time_after_s, "s", 1, "time_{}_s"});
  return out;
}

std::vector<Figure> resegment_figures(const ResegmentSummary& s) {
  const repath::ContourFigures now = s.chosen().figures;
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  return {{"blocks", count(s.before.blocks), count(s.after.blocks), "", 0, "blocks_{}"},
          {"time", s.contour_before.time_s, now.time_s, "s", 1, "time_{}_s"},
          {"contour error, largest", 1000 * s.contour_before.contour_max_mm, 1000 * now.contour_max_mm, "um", 1,
           "contour_{}_um.max"},
          {"contour error, rms", 1000 * s.contour_before.contour_rms_mm, 1000 * now.contour_rms_mm, "um", 1,
           "contour_{}_um.rms"},
          {"straight cuts", count(s.before.lines), count(s.after.lines), "", 0, "lines_before", "lines"},
          {"arcs", count(s.before.arcs), count(s.after.arcs), "", 0, "arcs_before", "arcs"},
          {"cutting length", s.before.length_mm, s.after.length_mm, "mm", 1, "length_{}_mm"}};
}

}  // namespace

// --- compress --------------------------------------------------------------------------------------------------

std::string compress_text(const CompressSummary& s) {
  const ProgramFigures &before = s.before, &after = s.after;
  const repath::Compression& result = s.result;
  std::string out =
      fmt::format("                before        after\nblocks     {:>11} {:>12}   / {:.2f}\n", before.blocks,
                  after.blocks, static_cast<double>(before.blocks) / static_cast<double>(after.blocks));
  out += fmt::format("lines      {:>11} {:>12}\narcs       {:>11} {:>12}\n", before.lines, after.lines, before.arcs,
                     after.arcs);
  out += fmt::format("length     {:>8.1f} mm {:>9.1f} mm\n", before.length_mm, after.length_mm);
  if (s.time_before_s) out += fmt::format("time       {:>9.1f} s {:>10.1f} s\n", *s.time_before_s, *s.time_after_s);
  if (s.time_at_feeds_before_s)
    out +=
        fmt::format("at the given feeds {:>5.1f} s {:>10.1f} s   / {:.2f}, without rapids\n", *s.time_at_feeds_before_s,
                    *s.time_at_feeds_after_s, *s.time_at_feeds_before_s / *s.time_at_feeds_after_s);
  if (result.runs.empty()) return out + fmt::format("nothing was rewritten: {}\n", s.why);
  out += fmt::format("largest deviation {:.4f} mm in {} rewritten runs; largest kink at an arc {:.1f} degrees",
                     result.max_deviation_mm, result.runs.size(), deg_from_rad(result.max_kink_rad));
  if (result.max_kink_rad > 0) out += fmt::format(", line {} of the new program", result.max_kink_block + 1);
  if (result.max_edge_rad > 0)
    out += fmt::format("; a kink of {:.1f} degrees that the given program has stays in line {}",
                       deg_from_rad(result.max_edge_rad), result.max_edge_block + 1);
  return out + "\n";
}

std::string compress_json(const CompressSummary& s, const repath::DeviationFigures& measured) {
  const ProgramFigures &before = s.before, &after = s.after;
  const repath::Compression& result = s.result;
  Json report = {{"blocks_before", before.blocks},
                 {"blocks_after", after.blocks},
                 {"lines", after.lines},
                 {"arcs", after.arcs},
                 {"lines_before", before.lines},
                 {"arcs_before", before.arcs},
                 {"length_before_mm", before.length_mm},
                 {"length_after_mm", after.length_mm},
                 {"tolerance_mm", s.tolerance_mm},
                 {"max_deviation_mm", result.max_deviation_mm},
                 {"measured_deviation_mm", measured.max_mm},
                 {"max_kink_deg", deg_from_rad(result.max_kink_rad)},
                 {"rms_kink_deg", deg_from_rad(result.rms_kink_rad)},
                 {"max_kink_line", nullptr},
                 {"max_edge_deg", deg_from_rad(result.max_edge_rad)},
                 {"max_edge_line", nullptr},
                 {"runs", result.runs.size()},
                 {"time_before_s", nullptr},
                 {"time_after_s", nullptr}};
  if (result.max_kink_rad > 0) report["max_kink_line"] = result.max_kink_block + 1;
  if (result.max_edge_rad > 0) report["max_edge_line"] = result.max_edge_block + 1;
  if (!s.why.empty()) report["unchanged_because"] = s.why;
  if (s.time_before_s) {
    report["time_before_s"] = *s.time_before_s;
    report["time_after_s"] = *s.time_after_s;
  }
  if (s.time_at_feeds_before_s) {
    report["time_at_feeds_before_s"] = *s.time_at_feeds_before_s;
    report["time_at_feeds_after_s"] = *s.time_at_feeds_after_s;
  }
  return report.dump(2) + "\n";
}

std::string compress_page(const CompressSummary& s, const BothPaths& paths) {
  RewritePage page = page_of(paths, s.result.runs, s.tolerance_mm, s.result.max_deviation_mm, compress_figures(s));
  page.title = "Compression of " + paths.program;
  return rewrite_page(page);
}

// --- resegment -------------------------------------------------------------------------------------------------

std::string resegment_text(const ResegmentSummary& s) {
  const repath::ContourFigures now = s.chosen().figures;
  std::string out = "                    before        after\n";
  out += fmt::format("blocks         {:>11} {:>12}\n", s.before.blocks, s.after.blocks);
  out += fmt::format("length         {:>8.1f} mm {:>9.1f} mm\n", s.before.length_mm, s.after.length_mm);
  out += fmt::format("time           {:>9.1f} s {:>10.1f} s   {:+.1f} %\n", s.contour_before.time_s, now.time_s,
                     100 * (now.time_s / s.contour_before.time_s - 1));
  out += fmt::format("contour error  {:>8.1f} um {:>9.1f} um   predicted, largest while cutting\n",
                     1000 * s.contour_before.contour_max_mm, 1000 * now.contour_max_mm);
  out += fmt::format("               {:>8.1f} um {:>9.1f} um   rms\n", 1000 * s.contour_before.contour_rms_mm,
                     1000 * now.contour_rms_mm);
  out += fmt::format("largest deviation {:.4f} mm in {} rewritten runs, {} corners kept; {}, of {} tried\n",
                     s.result.path.max_deviation_mm, s.result.path.runs.size(), s.result.path.corners,
                     candidate_text(s.chosen()), s.result.tried.size());
  const std::string unchanged = s.why.empty() ? "" : fmt::format("the program is unchanged: {}\n", s.why);
  if (s.result.tried.empty()) return out + unchanged;
  const repath::Candidate& fastest = s.result.tried[s.result.unbounded];
  if (!s.result.limit.holds(fastest.figures) && fastest.figures.time_s < now.time_s)
    out += fmt::format("{:.1f} s ({:+.1f} %) with a contour error of {:.1f} um, {:.1f} rms: --contour-mm {:.3f}\n",
                       fastest.figures.time_s, 100 * (fastest.figures.time_s / s.contour_before.time_s - 1),
                       1000 * fastest.figures.contour_max_mm, 1000 * fastest.figures.contour_rms_mm,
                       fastest.figures.contour_max_mm + 0.0005);
  return out + unchanged;
}

std::string resegment_json(const ResegmentSummary& s) {
  Json report = {
      {"blocks_before", s.before.blocks},
      {"blocks_after", s.after.blocks},
      {"lines", s.after.lines},
      {"arcs", s.after.arcs},
      {"length_before_mm", s.before.length_mm},
      {"length_after_mm", s.after.length_mm},
      {"tolerance_mm", s.tolerance_mm},
      {"max_deviation_mm", s.result.path.max_deviation_mm},
      {"measured_deviation_mm", s.measured.max_mm},
      {"lines_before", s.before.lines},
      {"arcs_before", s.before.arcs},
      {"time_before_s", s.contour_before.time_s},
      {"time_after_s", s.chosen().figures.time_s},
      {"contour_before_um", contour_json(s.contour_before)},
      {"contour_after_um", contour_json(s.chosen().figures)},
      {"contour_limit_um", 1000 * s.result.limit.max_mm},
      {"contour_limit_rms_um", std::isinf(s.result.limit.rms_mm) ? Json(nullptr) : Json(1000 * s.result.limit.rms_mm)},
      {"within_contour_limit", s.result.within_limit},
      {"runs", s.result.path.runs.size()},
      {"corners", s.result.path.corners},
      {"gains", s.result.gains},
      {"length_factor", s.chosen().length_factor},
      {"feed_factor", s.chosen().feed_factor},
      {"corner_feed_share", s.chosen().corners.fraction},
      {"settle_s", s.chosen().corners.settle_s}};
  if (!s.why.empty()) report["unchanged_because"] = s.why;
  if (!s.result.tried.empty()) report["fastest_unbounded"] = candidate_json(s.result.tried[s.result.unbounded]);
  report["tried"] = Json::array();
  for (const auto& c : s.result.tried) report["tried"].push_back(candidate_json(c));
  return report.dump(2) + "\n";
}

std::string resegment_page(const ResegmentSummary& s, const BothPaths& paths) {
  RewritePage page =
      page_of(paths, s.result.path.runs, s.tolerance_mm, s.result.path.max_deviation_mm, resegment_figures(s));
  page.title = "Segments of " + paths.program;
  page.tables.push_back(tried_table(s.result.tried));
  return rewrite_page(page);
}

// --- raster ----------------------------------------------------------------------------------------------------

namespace {

/// Least and greatest distance of neighbouring rows; zero for a single row.
std::pair<double, double> row_spaces_mm(const repath::RowSpacing& spacing) {
  const auto& rows = spacing.rows_mm;
  double least = rows.size() > 1 ? rows[1] - rows[0] : 0, most = least;
  for (std::size_t k = 1; k < rows.size(); ++k)
    least = std::min(least, rows[k] - rows[k - 1]), most = std::max(most, rows[k] - rows[k - 1]);
  return {least, most};
}

constexpr double kEdgeCosine = 0.97;  ///< of 14 degrees: where two triangles meet in an edge that is drawn
constexpr std::size_t kMaxEdges = 20000;
constexpr std::size_t kBins = 40;

void add_line(PathPicture& picture, const Vec3& from, const Vec3& to) {
  for (const auto& [point, kind] : {std::pair{from, PathKind::start}, std::pair{to, PathKind::kept_line}}) {
    picture.points.push_back(point);
    picture.kind.push_back(kind);
    picture.block.push_back(0);
    picture.ends.push_back(0);
  }
}

/// The edges of the part; of one that has too many (or none, as a ball) its box as seen from above.
PathPicture outline(const TriangleMesh& part) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> normals;
  PathPicture out;
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
FractionHistogram histogram(const std::string& title, const std::string& fraction_of, const std::string& axis,
                            const std::vector<std::pair<double, double>>& value_and_amount) {
  FractionHistogram out{title, fraction_of, axis, 0, 1e-3, 4, std::vector<double>(kBins, 0)};
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

std::vector<Figure> raster_figures(const RasterSummary& r) {
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  const ProgramFigures &before = r.before, &after = r.after;
  const repath::ContourFigures& now = r.chosen().figures;
  const auto [least, most] = row_spaces_mm(r.raster.spacing);
  return {{"time", r.contour_before.time_s, now.time_s, "s", 1, "time_{}_s"},
          {"blocks", count(before.blocks), count(after.blocks), "", 0, "blocks_{}"},
          {"contour error, largest", 1000 * r.contour_before.contour_max_mm, 1000 * now.contour_max_mm, "um", 1,
           "contour_{}_um.max"},
          {"contour error, rms", 1000 * r.contour_before.contour_rms_mm, 1000 * now.contour_rms_mm, "um", 1,
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

std::string raster_text(const RasterSummary& s) {
  const auto [least, most] = row_spaces_mm(s.raster.spacing);
  const repath::ContourFigures& now = s.chosen().figures;
  std::string out = fmt::format(
      "rows {}, {:.3f} to {:.3f} mm apart, in {} pieces, {} links along the surface; scallops up to {:.4f} mm\n",
      s.raster.spacing.rows_mm.size(), least, most, s.raster.pieces, s.raster.links,
      s.raster.spacing.largest_scallop_mm);
  out += "                 points every 0.1 mm   this program\n";
  out += fmt::format("blocks           {:>19} {:>14}\n", s.before.blocks, s.after.blocks);
  out += fmt::format("time             {:>17.1f} s {:>12.1f} s   {:+.1f} %\n", s.contour_before.time_s, now.time_s,
                     100 * (now.time_s / s.contour_before.time_s - 1));
  out += fmt::format("contour error    {:>16.1f} um {:>11.1f} um   predicted, largest while cutting\n",
                     1000 * s.contour_before.contour_max_mm, 1000 * now.contour_max_mm);
  out += fmt::format("                 {:>16.1f} um {:>11.1f} um   rms\n", 1000 * s.contour_before.contour_rms_mm,
                     1000 * now.contour_rms_mm);
  return out + fmt::format("largest deviation {:.4f} mm; {}, of {} tried\n", s.result.path.max_deviation_mm,
                           candidate_text(s.chosen()), s.result.tried.size());
}

std::string raster_json(const RasterSummary& s) {
  const auto [least, most] = row_spaces_mm(s.raster.spacing);
  const repath::ContourFigures& now = s.chosen().figures;
  Json out = {{"rows", s.raster.spacing.rows_mm.size()},
              {"row_spacing_mm", {{"min", least}, {"max", most}}},
              {"pieces", s.raster.pieces},
              {"links", {{"surface", s.raster.links}, {"clearance", s.raster.chains.size() - 1}}},
              {"scallop_mm",
               {{"asked", s.scallop_mm},
                {"largest", s.raster.spacing.largest_scallop_mm},
                {"too_high_share", s.raster.spacing.steep_fraction}}},
              {"compared_step_mm", s.compared_step_mm},
              {"blocks_before", s.before.blocks},
              {"blocks_after", s.after.blocks},
              {"lines", s.after.lines},
              {"arcs", s.after.arcs},
              {"length_before_mm", s.before.length_mm},
              {"length_after_mm", s.after.length_mm},
              {"tolerance_mm", s.tolerance_mm},
              {"max_deviation_mm", s.result.path.max_deviation_mm},
              {"time_before_s", s.contour_before.time_s},
              {"time_after_s", now.time_s},
              {"contour_before_um", contour_json(s.contour_before)},
              {"contour_after_um", contour_json(now)},
              {"within_contour_limit", s.result.within_limit},
              {"length_factor", s.chosen().length_factor},
              {"feed_factor", s.chosen().feed_factor}};
  for (const auto& c : s.result.tried) out["tried"].push_back(candidate_json(c));
  return out.dump(2) + "\n";
}

std::string raster_page(const RasterSummary& r) {
  RewritePage page;
  page.figures = raster_figures(r);
  page.tolerance_mm = r.tolerance_mm;
  page.max_deviation_mm = r.result.path.max_deviation_mm;
  page.deviation = false;
  page.part = outline(r.mesh);
  const BlockRanges all{{0, ~0u}};
  page.before = path_picture(r.moves_before, all, kMaxPicturePoints);
  page.after = path_picture(r.moves_after, all, kMaxPicturePoints);
  page.histograms = {
      histogram("Row distance", "% of the spaces", "distance of neighbouring rows, mm",
                spaces(r.raster.spacing.rows_mm)),
      histogram("Segment length", "% of the length cut", "length of a segment, mm", segments(r.moves_after))};
  page.tables.push_back(tried_table(r.result.tried));
  page.notes.push_back(
      fmt::format("Before: the same rows with a point every {} mm. After: the program that was written.",
                  format_trimmed(r.compared_step_mm, 3)));
  if (r.raster.spacing.steep_fraction > 0)
    page.notes.push_back("Scallops are higher than requested where the surface is steep across the rows.");
  page.title = "Raster on " + r.part;
  page.subtitle = rewrite_subtitle(r.part, r.output, r.tolerance_mm);
  return rewrite_page(page);
}

}  // namespace camber::report
