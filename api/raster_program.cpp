#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "api/job.h"
#include "api/program.h"
#include "api/run.h"
#include "base/triangle_mesh.h"
#include "camber/resegment.h"
#include "kinematics/control_options.h"
#include "plausibility/plausibility.h"
#include "repath/raster/raster.h"
#include "repath/resegment/fastest.h"
#include "report/rewrite_summary.h"

namespace camber {
namespace {

constexpr double kComparedStepMm = 0.1;  ///< step of the raster that it is set against
constexpr double kAboveAllMm = 5;
constexpr double kLeadInMm = 1;
constexpr double kLargestPartMm = 1e4;
constexpr double kFineToleranceMm = 0.004;  ///< below, coordinates have four decimals

std::string tool_numbers(const machine::Job& job) {
  std::string out;
  for (const auto& [number, tool] : job.tools) out += fmt::format("{}T{}", out.empty() ? "" : ", ", number);
  return out;
}

const machine::Tool& raster_tool(const machine::Job& job, const RasterOptions& asked) {
  if (!asked.tool && job.tools.size() != 1)
    fail_on_file(job.path, fmt::format("has the tools {}; --tool N was expected", tool_numbers(job)), "tool-missing");
  const auto found = asked.tool ? job.tools.find(*asked.tool) : job.tools.begin();
  if (found == job.tools.end())
    fail_on_file(job.path, fmt::format("has no [tool.{}]; it has {}", *asked.tool, tool_numbers(job)), "tool-missing");
  const machine::ToolType type = found->second.type;
  if (type != machine::ToolType::ball && type != machine::ToolType::flat && type != machine::ToolType::bull)
    fail_on_file(job.path,
                 fmt::format("[tool.{}] is no ball, flat or bull-nose cutter; one of them was expected for a raster",
                             found->first),
                 "tool-type");
  return found->second;
}

/// The share of the rectangle that lies over the part.
repath::Rectangle raster_boundary(const RasterOptions& asked, const std::string& part, const repath::DropCutter& drop) {
  const Vec2 low = drop.min_mm().head<2>(), high = drop.max_mm().head<2>();
  if (const double size = (high - low).maxCoeff(); size > kLargestPartMm)
    fail_on_file(part, fmt::format("the part is {:g} mm long; no more than {:g} mm was expected", size, kLargestPartMm),
                 "part-size");
  const auto& b = asked.boundary_mm;
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

/// Returns the height of the top of the stock; nothing for a field of another job, whose top is not known here.
std::optional<double> top_of_stock_mm(const machine::StockDescription& stock) {
  if (stock.box) return stock.box->max_mm.z();
  if (stock.cylinder) return stock.cylinder->base_mm.z() + stock.cylinder->height_mm;
  if (stock.mesh.empty()) return std::nullopt;
  double top = -std::numeric_limits<double>::infinity();
  for (const auto& p : read_mesh(stock.mesh).points) top = std::max(top, static_cast<double>(p.z()));
  return top;
}

/// Describes the program of a raster. Feed begins a little above a stock of even allowance, else above the blank.
repath::RasterProgram raster_program(const RasterOptions& asked, const machine::Job& job, const machine::Tool& tool,
                                     double part_top_mm, int decimals) {
  repath::RasterProgram out{.dialect = kinematics::dialect_of(job.machine.control.kind),
                            .tool = tool,
                            .spindle_rpm = asked.spindle_rpm,
                            .feed_mm_per_min = asked.feed_mm_per_min,
                            .lead_in_mm = kLeadInMm,
                            .decimals = decimals};
  const auto stock_top = top_of_stock_mm(job.stock);
  const double top = std::max(part_top_mm, stock_top.value_or(part_top_mm));
  if (asked.clearance_mm && *asked.clearance_mm < top)
    fail_on_file(job.path,
                 fmt::format("--clearance-mm {:g} lies below the top of stock and part, Z{:g}; a height above it was "
                             "expected",
                             *asked.clearance_mm, top),
                 "clearance-low");
  out.clearance_mm = asked.clearance_mm.value_or(top + kAboveAllMm);
  if (job.stock.allowance_mm > 0)
    out.lead_in_mm = kLeadInMm + 2 * job.stock.allowance_mm, out.lead_in_from_mm = -out.clearance_mm - 1e6;
  else
    out.lead_in_from_mm = stock_top ? top + kLeadInMm : out.clearance_mm;
  return out;
}

struct ReadRaster {
  nc::Program program;
  nc::Interpretation moves;
};

ReadRaster read_raster(const std::string& name, const std::string& text, const nc::InterpreterOptions& options) {
  Diagnostics ours;
  ReadRaster out;
  out.program = nc::read_program(SourceText(name, text), ours);
  out.moves = nc::interpret(out.program, options, ours);
  ours.throw_if_errors();
  return out;
}

ContourError contour_error(const repath::ContourFigures& f) {
  return {f.time_s, 1000 * f.contour_max_mm, 1000 * f.contour_rms_mm};
}

RasterResult make_raster(const Job& given, const RasterOptions& asked, api::Run& run) {
  const machine::Job& job = given.impl().job;
  const ResegmentOptions& layout = asked.layout;
  Diagnostics found = given.impl().found;
  const std::string part = asked.part.empty() ? job.part.mesh : asked.part;
  if (part.empty())
    fail_on_file(job.path, "has no [part] mesh, and there is no --part; one of them was expected", "part-missing");
  const machine::Tool& tool = raster_tool(job, asked);
  if (asked.spindle_rpm > job.machine.spindle.max_rpm)
    fail_on_file(job.machine_path,
                 fmt::format("the spindle turns at {:g} rpm at most; --spindle-rpm {:g} was given",
                             job.machine.spindle.max_rpm, asked.spindle_rpm),
                 "spindle-speed");
  plausibility::check_job_values(job, found);
  run.settle_first(found);

  const TriangleMesh mesh = closed_mesh(asked.part.empty() ? machine::part_mesh(job.part) : read_mesh(part), part,
                                        "and the cutter could fall through; a closed one was expected");
  const repath::DropCutter drop(mesh, removal::shape_of(tool));
  repath::RasterOptions rules{.boundary = raster_boundary(asked, part, drop),
                              .direction_rad = asked.direction_deg * kPi / 180,
                              .scallop_mm = asked.scallop_mm,
                              .tolerance_mm = layout.tolerance_mm};
  const int decimals = layout.tolerance_mm < kFineToleranceMm ? 4 : 3;
  if (decimals == 4) rules.increment_mm = 0.0001;
  rules.progress = [&](double fraction) { run.show("laying rows", std::clamp(fraction, 0.0, 1.0)); };
  const repath::Raster raster = repath::make_raster(drop, rules);
  if (raster.chains.empty()) fail_on_file(part, "the cutter touches nothing inside the boundary", "boundary-empty");

  const repath::RasterProgram program = raster_program(asked, job, tool, drop.max_mm().z(), decimals);
  std::vector<std::vector<Vec3>> chains, compared;
  for (const auto& chain : raster.chains) {
    chains.push_back(repath::points_of(drop, chain, rules));
    compared.push_back(repath::points_of(drop, chain, rules, kComparedStepMm));
  }
  const nc::InterpreterOptions read = kinematics::interpreter_options(job.machine, std::nullopt);
  const std::string& name = layout.output;
  const ReadRaster whole = read_raster(name, repath::raster_text(program, chains), read);
  const ReadRaster constant = read_raster(name, repath::raster_text(program, compared), read);
  const repath::ContourFigures before = repath::contour_figures(constant.moves, whole.moves, job.machine);

  repath::FastestOptions fastest;
  fastest.layout.tolerance_mm = repath::tolerance_left_mm(rules);
  fastest.layout.length_mm = layout.length_mm;
  fastest.contour_mm = layout.contour_mm > 0 ? layout.contour_mm : std::numeric_limits<double>::infinity();
  fastest.keep_old = false;
  fastest.fewest_blocks = true;
  fastest.interpreter = read;
  const repath::Fastest result = repath::find_fastest(whole.program, whole.moves, job.machine, before, fastest);

  const ReadRaster now = read_raster(name, result.path.text, read);
  const report::RasterSummary summary{.part = part,
                                      .output = name,
                                      .mesh = mesh,
                                      .raster = raster,
                                      .result = result,
                                      .moves_before = constant.moves,
                                      .moves_after = now.moves,
                                      .before = report::program_figures(constant.program, constant.moves),
                                      .after = report::program_figures(now.program, now.moves),
                                      .contour_before = before,
                                      .scallop_mm = asked.scallop_mm,
                                      .tolerance_mm = layout.tolerance_mm,
                                      .compared_step_mm = kComparedStepMm};
  RasterResult out{.program = result.path.text,
                   .within_limit = result.within_limit,
                   .scallops_too_high = raster.spacing.steep_fraction > 0,
                   .limit_um = 1000 * result.limit.max_mm,
                   .largest_scallop_mm = raster.spacing.largest_scallop_mm,
                   .closest_rows_mm = raster.spacing.closest_mm,
                   .rows = raster.spacing.rows_mm.size(),
                   .pieces = raster.pieces,
                   .before = api::counts_of(summary.before),
                   .after = api::counts_of(summary.after),
                   .contour_before = contour_error(before),
                   .contour_after = contour_error(summary.chosen().figures),
                   .diagnostics = found.all(),
                   .json = report::raster_json(summary),
                   .printed = report::raster_text(summary)};
  if (layout.page) out.page = report::raster_page(summary);
  return out;
}

}  // namespace

RasterResult v0::raster(const Job& job, const RasterOptions& options, const RunOptions& run_options) {
  RasterResult result;
  api::Run run(run_options);
  run.execute([&] { result = make_raster(job, options, run); });
  return result;
}

}  // namespace camber
