#include "cli/compress_command.h"

#include <optional>

#include <fmt/format.h>

#include "base/json.h"
#include "base/output_file.h"
#include "base/units.h"
#include "cli/console.h"
#include "cli/program_figures.h"
#include "cli/progress.h"
#include "cli/rewrite_report.h"
#include "feedmodel/cycle_time.h"
#include "kinematics/control_options.h"
#include "nc/language.h"
#include "nc/summary.h"
#include "repath/compress.h"

namespace camber::cli {
namespace {

struct Figures : ProgramFigures {
  std::optional<double> time_s;           ///< on the machine
  std::optional<double> time_at_feeds_s;  ///< of the cuts, at the feeds of lines and arcs
};

Figures with_time(const nc::Program& program, const nc::Interpretation& moves,
                  const std::optional<machine::Machine>& machine, const std::optional<repath::FeedsByKind>& feeds) {
  Figures f{figures_of(program, moves), std::nullopt, std::nullopt};
  if (machine) f.time_s = feedmodel::cycle_time(moves, *machine).all.time.total_s();
  if (feeds) f.time_at_feeds_s = repath::cutting_time_s(moves, *feeds);
  return f;
}

std::optional<repath::FeedsByKind> feeds_of(const CompressArguments& arguments) {
  if (!arguments.line_feed_mm_per_min) return std::nullopt;
  return repath::FeedsByKind{mm_per_s_from_mm_per_min(*arguments.line_feed_mm_per_min),
                             mm_per_s_from_mm_per_min(*arguments.arc_feed_mm_per_min), arguments.block_s};
}

std::string text_report(const Figures& before, const Figures& after, const repath::Compression& result,
                        const std::string& why) {
  std::string out =
      fmt::format("                before        after\nblocks     {:>11} {:>12}   / {:.2f}\n", before.blocks,
                  after.blocks, static_cast<double>(before.blocks) / static_cast<double>(after.blocks));
  out += fmt::format("lines      {:>11} {:>12}\narcs       {:>11} {:>12}\n", before.lines, after.lines, before.arcs,
                     after.arcs);
  out += fmt::format("length     {:>8.1f} mm {:>9.1f} mm\n", before.length_mm, after.length_mm);
  if (before.time_s) out += fmt::format("time       {:>9.1f} s {:>10.1f} s\n", *before.time_s, *after.time_s);
  if (before.time_at_feeds_s)
    out +=
        fmt::format("at the given feeds {:>5.1f} s {:>10.1f} s   / {:.2f}, without rapids\n", *before.time_at_feeds_s,
                    *after.time_at_feeds_s, *before.time_at_feeds_s / *after.time_at_feeds_s);
  if (result.runs.empty()) return out + fmt::format("nothing was rewritten: {}\n", why);
  out += fmt::format("largest deviation {:.4f} mm in {} rewritten runs; largest kink at an arc {:.1f} degrees",
                     result.max_deviation_mm, result.runs.size(), deg_from_rad(result.max_kink_rad));
  if (result.max_kink_rad > 0) out += fmt::format(", line {} of the new program", result.max_kink_block + 1);
  if (result.max_edge_rad > 0)
    out += fmt::format("; a kink of {:.1f} degrees that the given program has stays in line {}",
                       deg_from_rad(result.max_edge_rad), result.max_edge_block + 1);
  return out + "\n";
}

std::string json_report(const Figures& before, const Figures& after, const repath::Compression& result,
                        double tolerance_mm, const repath::DeviationFigures& measured, const std::string& why) {
  Json report = {{"blocks_before", before.blocks},
                 {"blocks_after", after.blocks},
                 {"lines", after.lines},
                 {"arcs", after.arcs},
                 {"lines_before", before.lines},
                 {"arcs_before", before.arcs},
                 {"length_before_mm", before.length_mm},
                 {"length_after_mm", after.length_mm},
                 {"tolerance_mm", tolerance_mm},
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
  if (!why.empty()) report["unchanged_because"] = why;
  if (before.time_s) {
    report["time_before_s"] = *before.time_s;
    report["time_after_s"] = *after.time_s;
  }
  if (before.time_at_feeds_s) {
    report["time_at_feeds_before_s"] = *before.time_at_feeds_s;
    report["time_at_feeds_after_s"] = *after.time_at_feeds_s;
  }
  return report.dump(2) + "\n";
}

std::vector<report::Figure> page_figures(const Figures& before, const Figures& after) {
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  std::vector<report::Figure> out = {
      {"blocks", count(before.blocks), count(after.blocks), "", 0, "blocks_{}"},
      {"straight cuts", count(before.lines), count(after.lines), "", 0, "lines_before", "lines"},
      {"arcs", count(before.arcs), count(after.arcs), "", 0, "arcs_before", "arcs"},
      {"cutting length", before.length_mm, after.length_mm, "mm", 1, "length_{}_mm"}};
  if (before.time_at_feeds_s)
    out.insert(out.begin() + 1, {"cuts at the given feeds", *before.time_at_feeds_s, *after.time_at_feeds_s, "s", 1,
                                 "time_at_feeds_{}_s"});
  if (before.time_s && after.time_s)
    out.insert(out.begin() + 1, {"time", *before.time_s, *after.time_s, "s", 1, "time_{}_s"});
  return out;
}

}  // namespace

int run_compress(const CompressArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  std::optional<machine::Machine> machine;
  nc::InterpreterOptions interpreter = arguments.interpreter;
  if (!arguments.machine.empty()) {
    machine = machine::read_machine(arguments.machine, diagnostics);
    interpreter = kinematics::interpreter_options(*machine, interpreter);
  }
  const nc::Program program =
      nc::read_program(SourceText::read(arguments.program), nc::language_asked_for(arguments.interpreter), diagnostics);
  const nc::Interpretation moves = nc::interpret(program, interpreter, diagnostics);
  settle(diagnostics, options);

  ProgressLine progress(options, "compressing");
  repath::CompressOptions compress_options;
  compress_options.tolerance_mm = arguments.tolerance_mm;
  compress_options.feeds = feeds_of(arguments);
  compress_options.switch_planes = arguments.switch_planes;
  compress_options.helices = arguments.helices;
  compress_options.fit.max_kink_rad = rad_from_deg(arguments.tangent_deg);
  compress_options.fit.arcs = !arguments.lines_only;
  compress_options.progress = [&](double fraction) { progress.show("compressing", fraction); };
  const repath::Compression result = repath::compress(program, moves, compress_options);
  const std::string why =
      result.runs.empty() ? repath::why_unchanged(program, moves, repath::RunKind::in_space) : std::string();

  Diagnostics again;  // what it says of the text was said above; an error is ours
  const nc::Program new_program = nc::read_program(SourceText(arguments.output, result.text), program.language, again);
  const nc::Interpretation new_moves = nc::interpret(new_program, interpreter, again);
  again.throw_if_errors();
  const Figures before = with_time(program, moves, machine, compress_options.feeds),
                after = with_time(new_program, new_moves, machine, compress_options.feeds);

  write_file(arguments.output, result.text);
  if (!arguments.json.empty() || !arguments.report.empty()) {
    const auto measured = repath::measure_deviation(moves, new_moves, result.runs, arguments.tolerance_mm);
    if (!arguments.json.empty())
      write_file(arguments.json, json_report(before, after, result, arguments.tolerance_mm, measured, why));
    if (!arguments.report.empty()) {
      report::RewritePage page =
          rewrite_page_of({moves, new_moves, result.runs, arguments.tolerance_mm, result.max_deviation_mm, measured},
                          page_figures(before, after));
      page.title = "Compression of " + arguments.program;
      page.subtitle = rewrite_subtitle(arguments.program, arguments.output, arguments.tolerance_mm);
      write_file(arguments.report, report::rewrite_page(page));
    }
  }
  progress.clear();
  if (!options.quiet) fmt::print("{}", text_report(before, after, result, why));
  return kDone;
}

}  // namespace camber::cli
