// camber posture: a three-axis finishing program made one of five axes.
#include "camber/posture.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/outputs.h"
#include "cli/program_options.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct PostureArguments {
  std::string program, job;
  std::string json, report;  ///< empty: none
  PostureOptions options{};
  ReadOptions read{};
};

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut where the tool is not clear everywhere.
int run_posture(const PostureArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "reading");
  PostureOptions asked = arguments.options;
  asked.page = !arguments.report.empty();
  const Job job = read_unprogrammed_job(arguments.job);
  const PostureResult result =
      posture(read_program(arguments.program, arguments.read), job, asked, run_options(progress, options));
  if (!arguments.json.empty()) write_file(arguments.json, result.json);
  if (result.blocked_line > 0) {
    fmt::print(stderr, "posture: no direction of the tool is clear of {} by {:g} mm in line {}; nothing was written\n",
               asked.stock ? "part, stock and fixtures" : "part and fixtures", asked.clearance_mm, result.blocked_line);
    return kNumbersDidNotWorkOut;
  }
  write_file(asked.output, result.text);
  if (!arguments.report.empty()) write_file(arguments.report, result.page);
  if (!options.quiet) fmt::print("{}", result.printed);
  if (result.success) return kDone;
  fmt::print(
      stderr,
      "posture: the tool is nearer than {:g} mm, or swings, at {} of {} points, first in line {}; the program was "
      "written\n",
      asked.clearance_mm, result.figures.unclear, result.figures.points, result.unclear_line);
  return kNumbersDidNotWorkOut;
}

enum class Mode : std::uint8_t { chosen, normal, lead_tilt, seed };
constexpr std::array<const char*, 4> kModes{"chosen", "normal", "lead-tilt", "seed"};

enum class OneDirection : std::uint8_t { tip, tilted, dynamic, joints };
constexpr std::array<const char*, 4> kWrittenAs{"tip", "tilted", "dynamic", "joints"};

void add_posture_rules(CLI::App& command, PostureOptions& options) {
  command
      .add_option_function<Mode>(
          "--mode", [&options](const Mode& mode) { options.mode = kModes[static_cast<std::size_t>(mode)]; },
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
  const auto angle = [&command](const char* name, double& deg, double least, double most, const char* text) {
    command
        .add_option_function<double>(
            name, [&deg](const double& given) { deg = given; }, text)
        ->check(number_from_to(least, most))
        ->type_name("A");
  };
  angle("--lead-deg", options.lead_deg, -60, 60, "lead-tilt: forward; default 10");
  angle("--tilt-deg", options.tilt_deg, -60, 60, "lead-tilt: to the left of the motion; default 0");
  angle("--max-tilt-deg", options.max_tilt_deg, 0, 90, "from Z of the program; default 75");
  angle("--least-angle-deg", options.least_angle_deg, 0, 45,
        "chosen: of tool and normal, so that the tip does not cut; default 10");
}

void add_one_direction(CLI::App& command, PostureOptions& options) {
  auto* indexed =
      command.add_flag("--indexed", options.indexed, "one direction for the whole operation (3+2) instead of --mode");
  command
      .add_option_function<OneDirection>(
          "--write-as",
          [&options](const OneDirection& written) { options.write_as = kWrittenAs[static_cast<std::size_t>(written)]; },
          "indexed: in a tilted frame (G68.2, PLANE SPATIAL, CYCLE800), under the dynamic work offset (G254), in "
          "joints, "
          "or under tool-centre-point control (tip); default: as the control has it")
      ->transform(CLI::CheckedTransformer(std::map<std::string, OneDirection>{{"tilted", OneDirection::tilted},
                                                                              {"dynamic", OneDirection::dynamic},
                                                                              {"joints", OneDirection::joints},
                                                                              {"tip", OneDirection::tip}})
                      .description(""))
      ->needs(indexed)
      ->type_name("tilted|dynamic|joints|tip");
}

}  // namespace

void add_posture_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command =
      app.add_subcommand("posture", "tilt the tool of a three-axis finishing program, clear of part and stock");
  auto arguments = std::make_shared<PostureArguments>();
  command->add_option("program", arguments->program, "NC program of three axes")->required()->type_name("P.nc");
  command->add_option("--job", arguments->job, "job.toml: machine with [kinematics], tool, part")
      ->required()
      ->type_name("J.toml");
  command->add_option("-o,--output", arguments->options.output, "the new program, under tool-centre-point control")
      ->required()
      ->type_name("OUT.nc");
  add_posture_rules(*command, arguments->options);
  add_one_direction(*command, arguments->options);
  command->add_option("--tool", arguments->options.tool, "number of the tool; default: the only one of the job")
      ->type_name("N");
  command->add_option("--step-mm", arguments->options.step_mm, "between the points of the path; default 1")
      ->check(number_from_to(0.05, 20))
      ->type_name("X");
  CLI::Option* overhang =
      command
          ->add_option("--overhang", arguments->options.overhang_step_mm,
                       "look for the shortest overhang that stays clear, in steps of so many mm from that of the job")
          ->check(number_from_to(0.1, 50))
          ->type_name("STEP");
  command
      ->add_flag("--least-error", arguments->options.least_error,
                 "write the program of the overhang whose expected error is least, instead of the shortest")
      ->needs(overhang);
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->add_option("--report", arguments->report, "a page that shows the machine along the new program")
      ->type_name("R.html");
  add_tool_lengths(*command, arguments->read);
  add_work_offsets(*command, arguments->read);
  add_reading_options(*command, arguments->read);
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      check_outputs({arguments->options.output, arguments->json, arguments->report},
                    {arguments->program, arguments->job});
      return run_posture(*arguments, options);
    };
  });
}

}  // namespace camber::cli
