#include "cli/resegment_command.h"

#include <cmath>

#include <fmt/format.h>

#include "base/json.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/program_figures.h"
#include "cli/progress.h"
#include "cli/rewrite_report.h"
#include "kinematics/control_options.h"
#include "kinematics/machine_program.h"
#include "nc/language.h"
#include "repath/fastest.h"

namespace camber::cli {
namespace {

struct Report {
  ProgramFigures before, after;
  repath::ContourFigures contour_before;
  const repath::Fastest& result;
  double tolerance_mm;
  const repath::DeviationFigures& measured;
  std::string why;  ///< it is unchanged; empty: it is not

  repath::Candidate chosen() const {
    return result.gains ? result.tried[result.chosen] : repath::Candidate{.figures = contour_before};
  }

  std::string text() const {
    const repath::ContourFigures now = chosen().figures;
    std::string out = "                    before        after\n";
    out += fmt::format("blocks         {:>11} {:>12}\n", before.blocks, after.blocks);
    out += fmt::format("length         {:>8.1f} mm {:>9.1f} mm\n", before.length_mm, after.length_mm);
    out += fmt::format("time           {:>9.1f} s {:>10.1f} s   {:+.1f} %\n", contour_before.time_s, now.time_s,
                       100 * (now.time_s / contour_before.time_s - 1));
    out += fmt::format("contour error  {:>8.1f} um {:>9.1f} um   predicted, largest while cutting\n",
                       1000 * contour_before.contour_max_mm, 1000 * now.contour_max_mm);
    out += fmt::format("               {:>8.1f} um {:>9.1f} um   rms\n", 1000 * contour_before.contour_rms_mm,
                       1000 * now.contour_rms_mm);
    out += fmt::format("largest deviation {:.4f} mm in {} rewritten runs, {} corners kept; {}, of {} tried\n",
                       result.path.max_deviation_mm, result.path.runs.size(), result.path.corners, feeds_text(chosen()),
                       result.tried.size());
    if (result.tried.empty()) return out;
    const repath::Candidate& fastest = result.tried[result.unbounded];
    if (!result.limit.holds(fastest.figures) && fastest.figures.time_s < now.time_s)
      out += fmt::format("{:.1f} s ({:+.1f} %) with a contour error of {:.1f} um, {:.1f} rms: --contour-mm {:.3f}\n",
                         fastest.figures.time_s, 100 * (fastest.figures.time_s / contour_before.time_s - 1),
                         1000 * fastest.figures.contour_max_mm, 1000 * fastest.figures.contour_rms_mm,
                         fastest.figures.contour_max_mm + 0.0005);
    return out;
  }

  std::string json() const {
    Json report = {{"blocks_before", before.blocks},
                   {"blocks_after", after.blocks},
                   {"lines", after.lines},
                   {"arcs", after.arcs},
                   {"length_before_mm", before.length_mm},
                   {"length_after_mm", after.length_mm},
                   {"tolerance_mm", tolerance_mm},
                   {"max_deviation_mm", result.path.max_deviation_mm},
                   {"measured_deviation_mm", measured.max_mm},
                   {"lines_before", before.lines},
                   {"arcs_before", before.arcs},
                   {"time_before_s", contour_before.time_s},
                   {"time_after_s", chosen().figures.time_s},
                   {"contour_before_um", of(contour_before)},
                   {"contour_after_um", of(chosen().figures)},
                   {"contour_limit_um", 1000 * result.limit.max_mm},
                   {"contour_limit_rms_um", rms_limit()},
                   {"within_contour_limit", result.within_limit},
                   {"runs", result.path.runs.size()},
                   {"corners", result.path.corners},
                   {"gains", result.gains},
                   {"length_factor", chosen().length_factor},
                   {"feed_factor", chosen().feed_factor},
                   {"corner_feed_share", chosen().corners.fraction},
                   {"settle_s", chosen().corners.settle_s}};
    if (!why.empty()) report["unchanged_because"] = why;
    if (!result.tried.empty()) report["fastest_unbounded"] = of(result.tried[result.unbounded]);
    report["tried"] = Json::array();
    for (const auto& c : result.tried) report["tried"].push_back(of(c));
    return report.dump(2) + "\n";
  }

  std::vector<report::Figure> figures() const {
    const repath::ContourFigures now = chosen().figures;
    const auto count = [](std::size_t n) { return static_cast<double>(n); };
    return {{"blocks", count(before.blocks), count(after.blocks), "", 0, "blocks_{}"},
            {"time", contour_before.time_s, now.time_s, "s", 1, "time_{}_s"},
            {"contour error, largest", 1000 * contour_before.contour_max_mm, 1000 * now.contour_max_mm, "um", 1,
             "contour_{}_um.max"},
            {"contour error, rms", 1000 * contour_before.contour_rms_mm, 1000 * now.contour_rms_mm, "um", 1,
             "contour_{}_um.rms"},
            {"straight cuts", count(before.lines), count(after.lines), "", 0, "lines_before", "lines"},
            {"arcs", count(before.arcs), count(after.arcs), "", 0, "arcs_before", "arcs"},
            {"cutting length", before.length_mm, after.length_mm, "mm", 1, "length_{}_mm"}};
  }

 private:
  Json rms_limit() const {
    if (std::isinf(result.limit.rms_mm)) return nullptr;
    return 1000 * result.limit.rms_mm;
  }

  static Json of(const repath::Candidate& c) {
    return {
        {"length_factor", c.length_factor}, {"feed_factor", c.feed_factor}, {"corner_feed_share", c.corners.fraction},
        {"settle_s", c.corners.settle_s},   {"time_s", c.figures.time_s},   {"contour_um", of(c.figures)}};
  }

  static Json of(const repath::ContourFigures& f) {
    return {{"max", 1000 * f.contour_max_mm}, {"rms", 1000 * f.contour_rms_mm}};
  }
};

}  // namespace

int run_resegment(const ResegmentArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Machine machine = machine::read_machine(arguments.machine, diagnostics);
  kinematics::ReadingOptions reading{.given = arguments.interpreter, .rotary = kinematics::RotaryWords::never};
  const auto given = kinematics::open_program(SourceText::read(arguments.program), machine, reading, diagnostics);
  const nc::Program& program = given.text();
  const nc::Interpretation& moves = given.commanded();
  settle(diagnostics, options);

  repath::FastestOptions fastest;
  fastest.layout.tolerance_mm = arguments.tolerance_mm;
  fastest.layout.length_mm = arguments.length_mm;
  fastest.contour_mm = arguments.contour_mm;
  fastest.interpreter = arguments.interpreter;
  ProgressLine progress(options, "timing the old blocks");
  const repath::ContourFigures before = repath::contour_figures(moves, moves, machine);
  fastest.progress = [&](double fraction) { progress.show("timing new ones", fraction); };
  const repath::Fastest result = repath::find_fastest(program, moves, machine, before, fastest);

  Diagnostics again;
  reading.language = program.language;
  const auto made = kinematics::open_program(SourceText(arguments.output, result.path.text), machine, reading, again);
  again.throw_if_errors();
  const nc::Program& new_program = made.text();
  const nc::Interpretation& new_moves = made.commanded();
  const auto measured = repath::measure_deviation(moves, new_moves, result.path.runs, arguments.tolerance_mm);
  const bool unchanged = result.path.runs.empty();
  const std::string runs =
      unchanged ? repath::why_unchanged(program, moves, repath::RunKind::with_arcs) : std::string();
  const std::string why = !unchanged ? ""
                          : result.tried.empty()
                              ? fmt::format("it is as near to its feed as its blocks allow ({})", runs)
                              : fmt::format("no length of segments is faster ({})", runs);
  const Report report{figures_of(program, moves),
                      figures_of(new_program, new_moves),
                      before,
                      result,
                      arguments.tolerance_mm,
                      measured,
                      why};
  write_file(arguments.output, result.path.text);
  if (!arguments.json.empty()) write_file(arguments.json, report.json());
  if (!arguments.report.empty()) {
    report::RewritePage page = rewrite_page_of(
        {moves, new_moves, result.path.runs, arguments.tolerance_mm, result.path.max_deviation_mm, measured},
        report.figures());
    page.title = "Segments of " + arguments.program;
    page.subtitle = rewrite_subtitle(arguments.program, arguments.output, arguments.tolerance_mm);
    page.tables.push_back(tried_table(result.tried));
    write_file(arguments.report, report::rewrite_page(page));
  }
  progress.clear();
  if (!options.quiet) fmt::print("{}", report.text());
  if (!options.quiet && !why.empty()) fmt::print("the program is unchanged: {}\n", why);
  if (result.within_limit) return kDone;
  fmt::print(stderr, "resegment: no length keeps the axes within {:.1f} um of the path; the closest one was written\n",
             1000 * result.limit.max_mm);
  return kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
