#include "cli/raster_command.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/json.h"
#include "base/output_file.h"
#include "base/triangle_mesh.h"
#include "checks/plausibility.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/program_figures.h"
#include "cli/progress.h"
#include "cli/raster_report.h"
#include "cli/rewrite_report.h"
#include "feedmodel/control_options.h"
#include "machine/job_file.h"
#include "repath/fastest.h"
#include "repath/raster.h"
#include "repath/raster_text.h"

namespace camber::cli {
namespace {

constexpr double kComparedStepMm = 0.1;  ///< of the raster that it is set against
constexpr double kAboveAllMm = 5;
constexpr double kLeadInMm = 1;
constexpr double kLargestPartMm = 1e4;
constexpr double kFineToleranceMm = 0.004;  ///< below, coordinates have four decimals

TriangleMesh read_part(const std::string& path) {
  TriangleMesh mesh = read_mesh(path);
  if (const std::size_t open = mesh.open_edges(); open > 0)
    fail_on_file(path,
                 fmt::format("the mesh is not closed: {} of its edges have no second triangle, and the cutter could "
                             "fall through; a closed one was expected",
                             open),
                 "stl-open");
  return mesh;
}

std::string tool_numbers(const machine::Job& job) {
  std::string out;
  for (const auto& [number, tool] : job.tools) out += fmt::format("{}T{}", out.empty() ? "" : ", ", number);
  return out;
}

const machine::Tool& chosen_tool(const machine::Job& job, const RasterArguments& arguments) {
  if (!arguments.tool && job.tools.size() != 1)
    fail_on_file(job.path, fmt::format("has the tools {}; --tool N was expected", tool_numbers(job)), "tool-missing");
  const auto found = arguments.tool ? job.tools.find(*arguments.tool) : job.tools.begin();
  if (found == job.tools.end())
    fail_on_file(job.path, fmt::format("has no [tool.{}]; it has {}", *arguments.tool, tool_numbers(job)),
                 "tool-missing");
  const machine::ToolType type = found->second.type;
  if (type != machine::ToolType::ball && type != machine::ToolType::flat && type != machine::ToolType::bull)
    fail_on_file(job.path,
                 fmt::format("[tool.{}] is no ball, flat or bull-nose cutter; one of them was expected for a raster",
                             found->first),
                 "tool-type");
  return found->second;
}

/// Of the rectangle that was asked for, what lies over the part.
repath::Rectangle boundary_of(const RasterArguments& arguments, const std::string& part,
                              const repath::DropCutter& drop) {
  const Vec2 low = drop.min_mm().head<2>(), high = drop.max_mm().head<2>();
  if (const double size = (high - low).maxCoeff(); size > kLargestPartMm)
    fail_on_file(part, fmt::format("the part is {:g} mm long; no more than {:g} mm was expected", size, kLargestPartMm),
                 "part-size");
  const auto& b = arguments.boundary_mm;
  if (b.empty()) return {low, high};
  const repath::Rectangle out{{b[0], b[1]}, {b[2], b[3]}};
  if ((out.min.array() >= high.array()).any() || (out.max.array() <= low.array()).any())
    fail_on_file(part,
                 fmt::format("nothing of the part lies inside --boundary {:g},{:g},{:g},{:g}; it reaches from X{:g} "
                             "Y{:g} to X{:g} Y{:g}",
                             b[0], b[1], b[2], b[3], low.x(), low.y(), high.x(), high.y()),
                 "boundary-empty");
  return {out.min.cwiseMax(low), out.max.cwiseMin(high)};
}

/// Nothing for a field of another job: where its stock ends is not known here.
std::optional<double> top_of_stock_mm(const machine::StockDescription& stock) {
  if (stock.box) return stock.box->max_mm.z();
  if (stock.cylinder) return stock.cylinder->base_mm.z() + stock.cylinder->height_mm;
  if (stock.mesh.empty()) return std::nullopt;
  double top = -std::numeric_limits<double>::infinity();
  for (const auto& p : read_mesh(stock.mesh).points) top = std::max(top, static_cast<double>(p.z()));
  return top;
}

/// Where feed begins: in a stock that is left all over alike a little above it, else above the blank.
repath::RasterProgram program_of(const RasterArguments& arguments, const machine::Job& job, const machine::Tool& tool,
                                 double part_top_mm, int decimals) {
  repath::RasterProgram out{.dialect = feedmodel::dialect_of(job.machine.control.kind),
                            .tool = tool,
                            .spindle_rpm = arguments.spindle_rpm,
                            .feed_mm_per_min = arguments.feed_mm_per_min,
                            .lead_in_mm = kLeadInMm,
                            .decimals = decimals};
  const auto stock_top = top_of_stock_mm(job.stock);
  const double top = std::max(part_top_mm, stock_top.value_or(part_top_mm));
  if (arguments.clearance_mm && *arguments.clearance_mm < top)
    fail_on_file(job.path,
                 fmt::format("--clearance-mm {:g} lies below the top of stock and part, Z{:g}; a height above it was "
                             "expected",
                             *arguments.clearance_mm, top),
                 "clearance-low");
  out.clearance_mm = arguments.clearance_mm.value_or(top + kAboveAllMm);
  if (job.stock.allowance_mm > 0)
    out.lead_in_mm = kLeadInMm + 2 * job.stock.allowance_mm, out.lead_in_from_mm = -out.clearance_mm - 1e6;
  else
    out.lead_in_from_mm = stock_top ? top + kLeadInMm : out.clearance_mm;
  return out;
}

struct Read {
  nc::Program program;
  nc::Interpretation moves;
};

Read read(const std::string& name, const std::string& text, const nc::InterpreterOptions& options) {
  Diagnostics ours;
  Read out;
  out.program = nc::read_program(SourceText(name, text), ours);
  out.moves = nc::interpret(out.program, options, ours);
  ours.throw_if_errors();
  return out;
}

struct Report {
  const RasterArguments& arguments;
  const repath::Raster& raster;
  const repath::Fastest& result;
  repath::ContourFigures compared;
  ProgramFigures before, after;

  const repath::Candidate& chosen() const { return result.tried[result.chosen]; }
  bool scallops_too_high() const { return raster.spacing.steep_fraction > 0; }

  std::string text() const {
    const auto [least, most] = row_spaces_mm(raster.spacing);
    const repath::ContourFigures& now = chosen().figures;
    std::string out = fmt::format(
        "rows {}, {:.3f} to {:.3f} mm apart, in {} pieces, {} links along the surface; scallops up to {:.4f} mm\n",
        raster.spacing.rows_mm.size(), least, most, raster.pieces, raster.links, raster.spacing.largest_scallop_mm);
    out += "                 points every 0.1 mm   this program\n";
    out += fmt::format("blocks           {:>19} {:>14}\n", before.blocks, after.blocks);
    out += fmt::format("time             {:>17.1f} s {:>12.1f} s   {:+.1f} %\n", compared.time_s, now.time_s,
                       100 * (now.time_s / compared.time_s - 1));
    out += fmt::format("contour error    {:>16.1f} um {:>11.1f} um   predicted, largest while cutting\n",
                       1000 * compared.contour_max_mm, 1000 * now.contour_max_mm);
    out += fmt::format("                 {:>16.1f} um {:>11.1f} um   rms\n", 1000 * compared.contour_rms_mm,
                       1000 * now.contour_rms_mm);
    return out + fmt::format("largest deviation {:.4f} mm; {}, of {} tried\n", result.path.max_deviation_mm,
                             feeds_text(chosen()), result.tried.size());
  }

  std::string json() const {
    const auto [least, most] = row_spaces_mm(raster.spacing);
    const repath::ContourFigures& now = chosen().figures;
    const auto um = [](const repath::ContourFigures& f) {
      return Json{{"max", 1000 * f.contour_max_mm}, {"rms", 1000 * f.contour_rms_mm}};
    };
    Json out = {{"rows", raster.spacing.rows_mm.size()},
                {"row_spacing_mm", {{"min", least}, {"max", most}}},
                {"pieces", raster.pieces},
                {"links", {{"surface", raster.links}, {"clearance", raster.chains.size() - 1}}},
                {"scallop_mm",
                 {{"asked", arguments.scallop_mm},
                  {"largest", raster.spacing.largest_scallop_mm},
                  {"too_high_share", raster.spacing.steep_fraction}}},
                {"compared_step_mm", kComparedStepMm},
                {"blocks_before", before.blocks},
                {"blocks_after", after.blocks},
                {"lines", after.lines},
                {"arcs", after.arcs},
                {"length_before_mm", before.length_mm},
                {"length_after_mm", after.length_mm},
                {"tolerance_mm", arguments.tolerance_mm},
                {"max_deviation_mm", result.path.max_deviation_mm},
                {"time_before_s", compared.time_s},
                {"time_after_s", now.time_s},
                {"contour_before_um", um(compared)},
                {"contour_after_um", um(now)},
                {"within_contour_limit", result.within_limit},
                {"length_factor", chosen().length_factor},
                {"feed_factor", chosen().feed_factor}};
    for (const auto& c : result.tried)
      out["tried"].push_back({{"length_factor", c.length_factor},
                              {"feed_factor", c.feed_factor},
                              {"corner_feed_share", c.corners.fraction},
                              {"settle_s", c.corners.settle_s},
                              {"time_s", c.figures.time_s},
                              {"contour_um", um(c.figures)}});
    return out.dump(2) + "\n";
  }
};

int status_of(const Report& report, const repath::Fastest& result) {
  if (report.scallops_too_high())
    fmt::print(stderr,
               "resegment: scallops of up to {:.4f} mm remain where the surface is steep across the rows, which lie no "
               "closer than {:.3f} mm; another --direction-deg or --boundary may help\n",
               report.raster.spacing.largest_scallop_mm, report.raster.spacing.closest_mm);
  if (!result.within_limit)
    fmt::print(stderr,
               "resegment: no length keeps the axes within {:.1f} um of the path; the closest one was written\n",
               1000 * result.limit.max_mm);
  return report.scallops_too_high() || !result.within_limit ? kNumbersDidNotWorkOut : kDone;
}

}  // namespace

int run_raster(const RasterArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Job job = machine::read_unprogrammed_job(arguments.job, diagnostics);
  const std::string part = arguments.part.empty() ? job.part.mesh : arguments.part;
  if (part.empty())
    fail_on_file(job.path, "has no [part] mesh, and there is no --part; one of them was expected", "part-missing");
  check_outputs({arguments.output, arguments.json, arguments.report},
                {job.path, job.machine_path, part, job.stock.mesh, job.stock.vdb});
  const machine::Tool& tool = chosen_tool(job, arguments);
  if (arguments.spindle_rpm > job.machine.spindle.max_rpm)
    fail_on_file(job.machine_path,
                 fmt::format("the spindle turns at {:g} rpm at most; --spindle-rpm {:g} was given",
                             job.machine.spindle.max_rpm, arguments.spindle_rpm),
                 "spindle-speed");
  checks::check_job_values(job, diagnostics);
  settle(diagnostics, options);

  const TriangleMesh mesh = read_part(part);
  const repath::DropCutter drop(mesh, removal::shape_of(tool));
  repath::RasterOptions raster_options{.boundary = boundary_of(arguments, part, drop),
                                       .direction_rad = arguments.direction_deg * kPi / 180,
                                       .scallop_mm = arguments.scallop_mm,
                                       .tolerance_mm = arguments.tolerance_mm};
  const int decimals = arguments.tolerance_mm < kFineToleranceMm ? 4 : 3;
  if (decimals == 4) raster_options.increment_mm = 0.0001;
  ProgressLine progress(options, "laying rows");
  raster_options.progress = [&](double fraction) { progress.show("laying rows", std::clamp(fraction, 0.0, 1.0)); };
  const repath::Raster raster = repath::make_raster(drop, raster_options);
  progress.clear();
  if (raster.chains.empty()) fail_on_file(part, "the cutter touches nothing inside the boundary", "boundary-empty");

  const repath::RasterProgram program = program_of(arguments, job, tool, drop.max_mm().z(), decimals);
  std::vector<std::vector<Vec3>> chains, compared;
  for (const auto& chain : raster.chains) {
    chains.push_back(repath::points_of(drop, chain, raster_options));
    compared.push_back(repath::points_of(drop, chain, raster_options, kComparedStepMm));
  }
  const nc::InterpreterOptions interpreter = feedmodel::interpreter_options(job.machine, std::nullopt);
  const Read whole = read(arguments.output, repath::raster_text(program, chains), interpreter);
  const Read constant = read(arguments.output, repath::raster_text(program, compared), interpreter);
  const repath::ContourFigures before = repath::contour_figures(constant.moves, whole.moves, job.machine);

  repath::FastestOptions fastest;
  fastest.layout.tolerance_mm = repath::tolerance_left_mm(raster_options);
  fastest.layout.length_mm = arguments.length_mm;
  fastest.contour_mm = arguments.contour_mm > 0 ? arguments.contour_mm : std::numeric_limits<double>::infinity();
  fastest.keep_old = false;
  fastest.fewest_blocks = true;
  fastest.interpreter = interpreter;
  const repath::Fastest result = repath::find_fastest(whole.program, whole.moves, job.machine, before, fastest);

  const Read now = read(arguments.output, result.path.text, interpreter);
  const Report report{arguments,
                      raster,
                      result,
                      before,
                      figures_of(constant.program, constant.moves),
                      figures_of(now.program, now.moves)};
  write_file(arguments.output, result.path.text);
  if (!arguments.json.empty()) write_file(arguments.json, report.json());
  if (!arguments.report.empty()) {
    report::RewritePage page =
        raster_page({mesh, raster, result, constant.moves, now.moves, report.before, report.after, before,
                     report.chosen().figures, arguments.scallop_mm, arguments.tolerance_mm, kComparedStepMm});
    page.title = "Raster on " + part;
    page.subtitle = rewrite_subtitle(part, arguments.output, arguments.tolerance_mm);
    write_file(arguments.report, report::rewrite_page(page));
  }
  if (!options.quiet) fmt::print("{}", report.text());
  return status_of(report, result);
}

}  // namespace camber::cli
