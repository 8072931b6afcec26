// check, feed, time, compress, resegment, post, posture and fit-feed on the command line.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "api/commands/time.h"
#include "base/numbers.h"
#include "base/stage.h"
#include "base/units.h"
#include "cli/check_command.h"
#include "cli/command_line.h"
#include "cli/compress_command.h"
#include "cli/console.h"
#include "cli/feed_command.h"
#include "cli/fit_feed_command.h"
#include "cli/outputs.h"
#include "cli/post_command.h"
#include "cli/posture_command.h"
#include "cli/progress.h"
#include "cli/protocol_command.h"
#include "cli/raster_options.h"
#include "cli/resegment_command.h"
#include "cli/time_command.h"
#include "cli/validators.h"
#include "cli/work_offset_option.h"
#include "kinematics/control_options.h"
#include "machine/machine.h"

namespace camber::cli {
namespace {

void add_interpreter_options(CLI::App& command, nc::InterpreterOptions& interpreter) {
  command.add_option("--units", interpreter.inch, "unit of a program without G20 and G21")
      ->transform(CLI::CheckedTransformer(std::map<std::string, bool>{{"mm", false}, {"inch", true}}).description(""))
      ->type_name("mm|inch");
  command.add_flag("--block-skip", interpreter.skip_slash_blocks, "skip blocks that begin with / or /1 to /9");
  command
      .add_option_function<std::vector<int>>(
          "--skip-switch",
          [&interpreter](const std::vector<int>& switches) {
            for (const int n : switches) interpreter.skip_switches |= static_cast<std::uint16_t>(1u << n);
          },
          "skip blocks that begin with /N; / is /1")
      ->check(CLI::Range(1, 9))
      ->delimiter(',')
      ->expected(1)
      ->take_all()
      ->type_name("N");
}

/// --tool-length 1=80: the length of offset H1.
void add_tool_lengths(CLI::App& command, nc::InterpreterOptions& interpreter) {
  const auto parsed = [](const std::string& text) -> std::optional<std::pair<int, double>> {
    const std::size_t at = text.find('=');
    if (at == std::string::npos) return std::nullopt;
    const auto number = parse_number(text.substr(0, at)), length = parse_number(text.substr(at + 1));
    if (!number || !length || *number < 0 || *number > 9999 || *number != std::floor(*number)) return std::nullopt;
    return std::pair(static_cast<int>(*number), *length);
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--tool-length",
          [&interpreter, parsed](const std::vector<std::string>& given) {
            for (const std::string& text : given)
              if (const auto offset = parsed(text)) interpreter.tool_offsets[offset->first].length_mm = offset->second;
          },
          "length of tool offset H, gauge line to tip, mm; for programs with rotary axes")
      ->check(CLI::Validator(
          [parsed](std::string& text) {
            return parsed(text) ? std::string()
                                : text + ": a number of H and a length in mm were expected, such as 1=80";
          },
          ""))
      ->expected(1)
      ->take_all()
      ->type_name("H=MM");
}

/// Index of a control in the table: what --dialect maps a name to.
enum class ControlRow : std::uint8_t {};

std::map<std::string, ControlRow> rows_of_controls() {
  std::map<std::string, ControlRow> rows;
  for (const std::string_view name : machine::control_kind_names())
    rows.emplace(name, static_cast<ControlRow>(rows.size()));
  return rows;
}

std::string_view name_of_dialect_with(bool nc::Dialect::*fact) {
  return std::ranges::find(nc::dialects(), true, fact)->name;
}

void add_language_options(CLI::App& command, nc::InterpreterOptions& interpreter) {
  command
      .add_option_function<ControlRow>(
          "--dialect",
          [&interpreter](ControlRow row) {
            interpreter.dialect = kinematics::dialect_of(machine::control_kinds()[static_cast<std::size_t>(row)]);
          },
          fmt::format("control of the program; default: from its text (O-words: {}, M97: {}), else {}, with P of a "
                      "dwell in seconds",
                      name_of_dialect_with(&nc::Dialect::shown_by_o_words),
                      name_of_dialect_with(&nc::Dialect::shown_by_m97), nc::default_dialect().name))
      ->transform(CLI::CheckedTransformer(rows_of_controls()).description(""))
      ->type_name(fmt::format("{}", fmt::join(machine::control_kind_names(), "|")));
  command.add_flag_function(
      "--least-increments,!--no-least-increments",
      [&interpreter](std::int64_t count) { interpreter.whole_numbers_are_increments = count > 0; },
      "X1000 without a point is 1000 least increments (1 mm), not 1000 mm");
}

int print_effective_machine(const std::string& path, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Machine machine = machine::read_machine(path, diagnostics);
  settle(diagnostics, options);
  fmt::print("# {}\n{}", path, machine::to_toml(machine));
  return kDone;
}

/// What check finds is its result: it is printed, and what --strict makes errors ends it with 1.
int check(const CheckCommand& command, const GlobalOptions& options) {
  Diagnostics diagnostics;
  std::ostream silent(nullptr);
  std::ostream& out = options.quiet ? silent : std::cout;
  ProgressLine progress(options, "reading");
  const StageScope stages([&](const std::string& what, double share) { progress.show(what, share); });
  const auto clear = [&] { progress.clear(); };
  const int status = command.explain_kinematics.empty() ? run_check(command, diagnostics, out, clear)
                                                        : run_explain_kinematics(command, diagnostics, out);
  std::cout.flush();
  settle(diagnostics, options);
  return status;
}

void add_check(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("check", "read and interpret a program and report problems; change nothing");
  auto arguments = std::make_shared<CheckCommand>();
  auto* program =
      command->add_option("program", arguments->program, "NC program; default: the job's")->type_name("P.nc");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  auto* machine =
      command->add_option("--machine", arguments->machine, "machine.toml: also check axes, feeds and spindle speeds");
  machine->type_name("M.toml");
  command->add_option("--job", arguments->job, "job.toml: also check its machine, tools, stock and part")
      ->type_name("J.toml")
      ->excludes(machine);
  add_tool_lengths(*command, arguments->interpreter);
  add_work_offsets(*command, arguments->interpreter);
  auto* page = command->add_option("--report", arguments->report, "report page with a picture of the path");
  page->type_name("R.html");
  command->add_option("--path", arguments->path, "the path's points with line, tool and feed, as arrays for pictures")
      ->type_name("P.bin");
  auto* sheet = command->add_option("--sheet", arguments->sheet,
                                    "set-up sheet for A4: blank and zero, tools to scale, offsets, limits, times");
  sheet->type_name("OUT.html")->needs("--job");
  command
      ->add_option("--explain-kinematics", arguments->explain_kinematics,
                   "instead of a program: the axes of a machine from the part to the spindle, and what a positive word "
                   "of each turns which way")
      ->type_name("M.toml|J.toml")
      ->excludes(program)
      ->excludes(page)
      ->excludes(sheet)
      ->excludes("--machine")
      ->excludes("--job");
  add_interpreter_options(*command, arguments->interpreter);
  add_language_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    if (arguments->program.empty() && arguments->job.empty() && arguments->explain_kinematics.empty())
      throw CLI::RequiredError("program or --job");
    chosen = [arguments, &options] {
      check_outputs({arguments->json, arguments->report, arguments->sheet, arguments->path},
                    {arguments->program, arguments->machine, arguments->job, arguments->explain_kinematics});
      return check(*arguments, options);
    };
  });
}

void add_feed(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("feed", "predict the actual feed along a program, and its time");
  auto arguments = std::make_shared<FeedArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  command->add_option("--machine", arguments->machine, "machine.toml")->required()->type_name("M.toml");
  command->add_option("-o,--output", arguments->output, "axis positions at every period")->type_name("feed.csv");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->add_option("--report", arguments->report, "page of a machine with rotary axes as it runs the program")
      ->type_name("R.html");
  add_tool_lengths(*command, arguments->interpreter);
  add_work_offsets(*command, arguments->interpreter);
  add_interpreter_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->output, arguments->json, arguments->report}, {arguments->program, arguments->machine});
      return run_feed(*arguments, options);
    };
  });
}

void add_time(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("time", "cycle time by kind of operation and by tool; what-if sweeps");
  auto arguments = std::make_shared<TimeArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  auto* machine = command->add_option("--machine", arguments->machine, "machine.toml")->type_name("M.toml");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  auto* trace = command->add_option("--trace", arguments->trace, "measured run to compare with");
  trace->type_name("T.csv");
  auto* sweep = command->add_option("--sweep", arguments->sweeps, "sweep a machine parameter over N values");
  sweep->expected(1)->take_all()->type_name("KEY=FROM:TO:N")->needs(machine)->excludes(trace);
  sweep->check(CLI::Validator(
      [](std::string& text) {
        try {
          api::parse_sweep(text);
        } catch (const std::invalid_argument& problem) {
          return std::string(problem.what());
        }
        return std::string();
      },
      ""));
  auto* cases = command->add_option("--case", arguments->cases, "machines to compare");
  cases->type_name("cases.toml")->excludes(trace)->excludes(sweep);
  command->add_option("--report", arguments->report, "report page")->type_name("R.html");
  add_tool_lengths(*command, arguments->interpreter);
  add_work_offsets(*command, arguments->interpreter);
  add_interpreter_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    if (arguments->machine.empty() && arguments->cases.empty())
      throw CLI::ValidationError("time", "--machine M.toml or --case cases.toml was expected");
    chosen = [arguments, &options] {
      if (options.effective_config && !arguments->machine.empty())
        return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->json, arguments->report},
                    {arguments->program, arguments->machine, arguments->trace, arguments->cases});
      return run_time(*arguments, options);
    };
  });
}

void add_fit_feed(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("fit-feed", "fit a machine's feed model to servo traces");
  auto arguments = std::make_shared<FitFeedArguments>();
  command->add_option("--program", arguments->programs, "a program that was run; once for each trace")
      ->required()
      ->expected(1)
      ->take_all()
      ->type_name("P.nc");
  command->add_option("--trace", arguments->traces, "servo trace, MTConnect log or table of stretch times of that run")
      ->required()
      ->expected(1)
      ->take_all()
      ->type_name("T");
  command->add_option("--columns", arguments->columns, "column map of servo traces in another format")
      ->type_name("C.toml");
  command->add_option("--machine", arguments->machine, "machine to start from")->required()->type_name("M.toml");
  command->add_option("-o,--output", arguments->output, "the fitted machine")->required()->type_name("fitted.toml");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command
      ->add_option("--block-time-plot", arguments->block_time_plot, "speed against block length of the saturated runs")
      ->type_name("P.svg");
  command->add_option("--report", arguments->report, "page: measured and modelled speed, residuals, parameters")
      ->type_name("R.html");
  command->add_flag(
      "--update", arguments->update,
      "refine the machine file: its corner law stands, its numbers change where the traces determine them");
  command->add_flag("--leave-one-out", arguments->leave_one_out,
                    "also predict each servo trace by a fit on the others (one fit per trace)");
  add_tool_lengths(*command, arguments->interpreter);
  add_work_offsets(*command, arguments->interpreter);
  add_interpreter_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    if (arguments->programs.size() != arguments->traces.size())
      throw CLI::ValidationError("--trace",
                                 fmt::format("{} programs and {} traces; the same number of both was expected",
                                             arguments->programs.size(), arguments->traces.size()));
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      std::vector<std::string> inputs = arguments->programs;  // a machine file may be fitted in its place
      inputs.insert(inputs.end(), arguments->traces.begin(), arguments->traces.end());
      check_outputs({arguments->output, arguments->json, arguments->block_time_plot, arguments->report}, inputs);
      return run_fit_feed(*arguments, options);
    };
  });
}

/// A length in mm; "nan" is none.
CLI::Validator length_validator() {
  return CLI::Validator(
      [](std::string& text) {
        const auto value = parse_number(text);
        return value && *value >= 1e-5 && *value <= 10 ? "" : text + ": a number from 0.00001 to 10 was expected";
      },
      "");
}

/// What every command takes that writes a path anew.
template <class Arguments>
void add_rewriting(CLI::App& command, Arguments& arguments) {
  command.add_option("--tolerance-mm", arguments.tolerance_mm, "maximum distance between the new and the old path")
      ->required()
      ->check(length_validator())
      ->type_name("X");
  command.add_option("-o,--output", arguments.output, "the new program")->required()->type_name("OUT.nc");
  command.add_option("--report", arguments.report, "the page: before and after, deviation, picture")
      ->type_name("R.html");
}

void add_feeds_by_kind(CLI::App& command, CompressArguments& arguments, CLI::Option* lines_only) {
  auto* line =
      command
          .add_option("--line-feed-mm-per-min", arguments.line_feed_mm_per_min,
                      "feed that the control reaches on lines, if it runs arcs faster: minimize time instead of blocks")
          ->check(number_from_to(0.1, 1e6))
          ->excludes(lines_only)
          ->type_name("V");
  auto* arc =
      command.add_option("--arc-feed-mm-per-min", arguments.arc_feed_mm_per_min, "feed that it reaches on arcs")
          ->check(number_from_to(0.1, 1e6))
          ->needs(line)
          ->type_name("W");
  line->needs(arc);
  command.add_option("--block-s", arguments.block_s, "additional time per block; default 0.005")
      ->check(number_from_to(0, 10))
      ->needs(line)
      ->type_name("S");
}

void add_compress(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("compress", "replace many G1 by few G1, G2 and G3 within a tolerance");
  auto arguments = std::make_shared<CompressArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  add_rewriting(*command, *arguments);
  command->add_option("--machine", arguments->machine, "machine.toml: also predict the times before and after")
      ->type_name("M.toml");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  auto* lines_only = command->add_flag("--lines-only", arguments->lines_only, "no arcs");
  command
      ->add_option(
          "--tangent-deg", arguments->tangent_deg,
          "maximum kink between an arc and its neighbour where the program is smooth; default 1; 180: any kink")
      ->check(number_from_to(0.05, 180))
      ->type_name("A");
  command->add_flag("--helices", arguments->helices, "also use helical arcs where the path is three-dimensional")
      ->excludes(lines_only);
  add_feeds_by_kind(*command, *arguments, lines_only);
  command->add_flag("--switch-planes", arguments->switch_planes,
                    "also use arcs in other planes than the program's, with G17 G18 G19 around them");
  add_interpreter_options(*command, arguments->interpreter);
  add_language_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    if (arguments->line_feed_mm_per_min && *arguments->arc_feed_mm_per_min <= *arguments->line_feed_mm_per_min)
      throw CLI::ValidationError("--arc-feed-mm-per-min",
                                 fmt::format("{:g}: more than --line-feed-mm-per-min {:g} was "
                                             "expected",
                                             *arguments->arc_feed_mm_per_min, *arguments->line_feed_mm_per_min));
    chosen = [arguments, &options] {
      if (options.effective_config && !arguments->machine.empty())
        return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->output, arguments->json, arguments->report}, {arguments->program, arguments->machine});
      return run_compress(*arguments, options);
    };
  });
}

void add_resegment(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("resegment", "divide runs of G1 into segments just long enough for the control");
  auto arguments = std::make_shared<ResegmentArguments>();
  auto* program = command->add_option("program", arguments->program, "NC program")->type_name("P.nc");
  auto* machine =
      command->add_option("--machine", arguments->machine, "machine.toml")->type_name("M.toml")->needs(program);
  add_rewriting(*command, *arguments);
  command->add_option("--length-mm", arguments->length_mm, "segment length; default: the fastest one")
      ->check(length_validator())
      ->type_name("L");
  command
      ->add_option("--contour-mm", arguments->contour_mm,
                   "maximum deviation of the predicted axes from the old path; default: maximum and rms not above "
                   "those of the old blocks, or the tolerance; for a raster no limit")
      ->check(length_validator())
      ->type_name("C");
  command->add_option("--json", arguments->json, "write the figures of all lengths tried")->type_name("R.json");
  add_interpreter_options(*command, arguments->interpreter);
  add_language_options(*command, arguments->interpreter);
  const auto raster = add_raster_options(*command, *program);
  command->callback([arguments, machine, raster, &options, &chosen] {
    if (raster->asked_for()) {
      chosen = raster->action(*arguments, options);
      return;
    }
    if (arguments->program.empty()) throw CLI::RequiredError("program, or --job with --part,");
    if (machine->empty()) throw CLI::RequiredError("--machine");
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->output, arguments->json, arguments->report}, {arguments->program, arguments->machine});
      return run_resegment(*arguments, options);
    };
  });
}

void add_post_rules(CLI::App& command, repath::PostOptions& options) {
  command.add_option("--to", options.target, "joints: X Y Z of the linear axes (default); tcp: the tip")
      ->transform(CLI::CheckedTransformer(std::map<std::string, repath::PostTarget>{
                                              {"joints", repath::PostTarget::joints}, {"tcp", repath::PostTarget::tcp}})
                      .description(""))
      ->type_name("joints|tcp");
  command
      .add_option("--tolerance-mm", options.tolerance_mm,
                  "maximum deviation of the tip in feed moves, rounding included; default 0.005")
      ->check(number_from_to(1e-5, 10))
      ->type_name("X");
  command
      .add_option("--rapid-tolerance-mm", options.rapid_tolerance_mm,
                  "the same in rapids and where axes turn back; default 0.1")
      ->check(number_from_to(1e-5, 1000))
      ->type_name("X");
  command
      .add_option_function<std::string>(
          "--rule", [&options](const std::string& rule) { options.one_degree = rule == "one-degree"; },
          "divide blocks by the tolerance (default), or so that no axis turns by a degree or more")
      ->check(CLI::IsMember({"tolerance", "one-degree"}).description(""))
      ->type_name("tolerance|one-degree");
  command.add_flag("--inverse-time", options.inverse_time, "G93: F of each rewritten feed block is 1/min");
  command
      .add_option("--retract-mm", options.retract_mm,
                  "how far the tool goes off along its axis where axes turn back; default 50")
      ->check(number_from_to(0, 1000))
      ->type_name("L");
  command
      .add_option_function<int>(
          "--decimals", [&options](const int& n) { options.decimals = n; },
          "of lengths and angles in rewritten blocks; default: as the program's coordinates, at least 4")
      ->check(CLI::Range(1, 8).description(""))
      ->type_name("N");
}

void add_post(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command =
      app.add_subcommand("post", "rewrite a program with rotary axes in joint coordinates, or back to the tool's tip");
  auto arguments = std::make_shared<PostArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  command->add_option("-o,--output", arguments->output, "the new program")->required()->type_name("OUT.nc");
  auto* machine = command->add_option("--machine", arguments->machine, "machine.toml with [kinematics]");
  machine->type_name("M.toml");
  command->add_option("--job", arguments->job, "job.toml: its machine, and collisions of its tools with [[body]]")
      ->type_name("J.toml")
      ->excludes(machine);
  add_post_rules(*command, arguments->options);
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  add_tool_lengths(*command, arguments->interpreter);
  add_work_offsets(*command, arguments->interpreter);
  add_interpreter_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    if (arguments->machine.empty() && arguments->job.empty()) throw CLI::RequiredError("--machine or --job");
    chosen = [arguments, &options] {
      if (options.effective_config && !arguments->machine.empty())
        return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->output, arguments->json}, {arguments->program, arguments->machine, arguments->job});
      return run_post(*arguments, options);
    };
  });
}

void add_posture_rules(CLI::App& command, posture::PostureOptions& options) {
  using posture::Mode;
  command
      .add_option(
          "--mode", options.mode,
          "chosen: least error and rotary motion (default); normal to the part; lead-tilt: at constant angles to "
          "the normal; seed: normal, and away from what interferes")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Mode>{{"chosen", Mode::chosen},
                                                                      {"normal", Mode::normal},
                                                                      {"lead-tilt", Mode::lead_tilt},
                                                                      {"seed", Mode::seed}})
                      .description(""))
      ->type_name("chosen|normal|lead-tilt|seed");
  command
      .add_option("--clearance-mm", options.clearance_mm,
                  "of neck, shank, holder and spindle to part, stock and fixtures; default 1")
      ->check(number_from_to(0, 100))
      ->type_name("X");
  command.add_flag("!--no-stock", options.stock, "the stock of the job is no obstacle");
  const auto angle = [&command](const char* name, double& rad, double least, double most, const char* text) {
    command
        .add_option_function<double>(
            name, [&rad](const double& deg) { rad = rad_from_deg(deg); }, text)
        ->check(number_from_to(least, most))
        ->type_name("A");
  };
  angle("--lead-deg", options.lead_rad, -60, 60, "lead-tilt: forward; default 10");
  angle("--tilt-deg", options.tilt_rad, -60, 60, "lead-tilt: to the left of the motion; default 0");
  angle("--max-tilt-deg", options.max_tilt_rad, 0, 90, "from Z of the program; default 75");
  angle("--least-angle-deg", options.least_angle_rad, 0, 45,
        "chosen: of tool and normal, so that the tip does not cut; default 10");
}

void add_one_direction(CLI::App& command, PostureArguments& arguments) {
  using nc::OneDirection;
  auto* indexed = command.add_flag("--indexed", arguments.options.indexed,
                                   "one direction for the whole operation (3+2) instead of --mode");
  command
      .add_option_function<OneDirection>(
          "--write-as", [&arguments](const OneDirection& written) { arguments.written = written; },
          "indexed: in a tilted frame (G68.2), under the dynamic work offset (G254), in joints, or under "
          "tool-centre-point control (tip); default: as the control has it")
      ->transform(CLI::CheckedTransformer(std::map<std::string, OneDirection>{{"tilted", OneDirection::tilted},
                                                                              {"dynamic", OneDirection::dynamic},
                                                                              {"joints", OneDirection::joints},
                                                                              {"tip", OneDirection::tip}})
                      .description(""))
      ->needs(indexed)
      ->type_name("tilted|dynamic|joints|tip");
}

void add_posture(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command =
      app.add_subcommand("posture", "tilt the tool of a three-axis finishing program, clear of part and stock");
  auto arguments = std::make_shared<PostureArguments>();
  command->add_option("program", arguments->program, "NC program of three axes")->required()->type_name("P.nc");
  command->add_option("--job", arguments->job, "job.toml: machine with [kinematics], tool, part")
      ->required()
      ->type_name("J.toml");
  command->add_option("-o,--output", arguments->output, "the new program, under tool-centre-point control")
      ->required()
      ->type_name("OUT.nc");
  add_posture_rules(*command, arguments->options);
  add_one_direction(*command, *arguments);
  command->add_option("--tool", arguments->tool, "number of the tool; default: the only one of the job")
      ->type_name("N");
  command->add_option("--step-mm", arguments->step_mm, "between the points of the path; default 1")
      ->check(number_from_to(0.05, 20))
      ->type_name("X");
  CLI::Option* overhang =
      command
          ->add_option("--overhang", arguments->overhang_step_mm,
                       "look for the shortest overhang that stays clear, in steps of so many mm from that of the job")
          ->check(number_from_to(0.1, 50))
          ->type_name("STEP");
  command
      ->add_flag("--least-error", arguments->least_error,
                 "write the program of the overhang whose expected error is least, instead of the shortest")
      ->needs(overhang);
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->add_option("--report", arguments->report, "a page that shows the machine along the new program")
      ->type_name("R.html");
  add_tool_lengths(*command, arguments->interpreter);
  add_work_offsets(*command, arguments->interpreter);
  add_interpreter_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      check_outputs({arguments->output, arguments->json, arguments->report}, {arguments->program, arguments->job});
      return run_posture(*arguments, options);
    };
  });
}

void add_protocol(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("protocol", "write programs that provide fit-feed with the data it needs");
  auto arguments = std::make_shared<ProtocolArguments>();
  command->add_option("--machine", arguments->machine, "machine.toml")->required()->type_name("M.toml");
  command->add_option("-o,--output", arguments->folder, "folder for the programs")->required()->type_name("DIR");
  auto* part = command->add_flag("--part", arguments->part, "a test piece to cut and measure, for fit-parts");
  command->add_option("--diameter-mm", arguments->diameter_mm, "of its end mill")
      ->check(CLI::Range(1.0, 50.0))
      ->type_name("D")
      ->needs(part);
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      check_output_folder(arguments->folder);
      return run_protocol(*arguments, options);
    };
  });
}

}  // namespace

void add_program_commands(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  add_check(app, options, chosen);
  add_feed(app, options, chosen);
  add_time(app, options, chosen);
  add_fit_feed(app, options, chosen);
  add_protocol(app, options, chosen);
  add_compress(app, options, chosen);
  add_resegment(app, options, chosen);
  add_post(app, options, chosen);
  add_posture(app, options, chosen);
}

}  // namespace camber::cli
