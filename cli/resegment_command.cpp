// camber resegment: runs of G1 laid out again in segments that are just long enough for the control; camber resegment
// --part: a finishing raster on the offset surface of a part.
#include "camber/resegment.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/numbers.h"
#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/program_options.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

constexpr double kFinestToleranceMm = 0.0005;

struct ResegmentArguments {
  std::string program;
  std::string machine;
  std::string json;    ///< empty: none
  std::string report;  ///< the page; empty: none
  ResegmentOptions options{};
  ReadOptions read{};
};

int say_within(bool within_limit, double limit_um) {
  if (within_limit) return kDone;
  fmt::print(stderr, "resegment: no length keeps the axes within {:.1f} um of the path; the closest one was written\n",
             limit_um);
  return kNumbersDidNotWorkOut;
}

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut where no length keeps the axes as near as asked for.
int run_resegment(const ResegmentArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "timing the old blocks");
  ResegmentOptions asked = arguments.options;
  asked.page = !arguments.report.empty();
  const Machine machine = read_machine(arguments.machine);
  const ResegmentResult result =
      resegment(read_program(arguments.program, arguments.read), machine, asked, run_options(progress, options));
  write_file(asked.output, result.program);
  if (!arguments.json.empty()) write_file(arguments.json, result.json);
  if (asked.page) write_file(arguments.report, result.page);
  if (!options.quiet) fmt::print("{}", result.printed);
  return say_within(result.within_limit, result.limit_um);
}

struct RasterArguments {
  std::string job;
  std::string json;    ///< empty: none
  std::string report;  ///< the page; empty: none
  RasterOptions options{};
};

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut where scallops stay higher than asked for, or no length
/// keeps the axes as near as asked for.
int run_raster(const RasterArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "reading");
  RasterOptions asked = arguments.options;
  asked.layout.page = !arguments.report.empty();
  const Job job = read_unprogrammed_job(arguments.job);
  std::vector<std::string> inputs = job.files();
  std::erase(inputs, job.program_path());
  inputs.push_back(asked.part);
  check_outputs({asked.layout.output, arguments.json, arguments.report}, inputs);
  const RasterResult result = raster(job, asked, run_options(progress, options));
  write_file(asked.layout.output, result.program);
  if (!arguments.json.empty()) write_file(arguments.json, result.json);
  if (asked.layout.page) write_file(arguments.report, result.page);
  if (!options.quiet) fmt::print("{}", result.printed);
  if (result.scallops_too_high)
    fmt::print(stderr,
               "resegment: scallops of up to {:.4f} mm remain where the surface is steep across the rows, which lie no "
               "closer than {:.3f} mm; another --direction-deg or --boundary may help\n",
               result.largest_scallop_mm, result.closest_rows_mm);
  return std::max(say_within(result.within_limit, result.limit_um),
                  static_cast<int>(result.scallops_too_high ? kNumbersDidNotWorkOut : kDone));
}

CLI::Validator rectangle_validator() {
  return CLI::Validator(
      [](std::string& text) {
        std::vector<double> corners;
        for (std::size_t at = 0; at <= text.size();) {
          const std::size_t end = std::min(text.find(',', at), text.size());
          const auto value = parse_number(text.substr(at, end - at));
          if (value && std::abs(*value) <= 1e6) corners.push_back(*value);
          at = end + 1;
        }
        const bool right = corners.size() == 4 && std::count(text.begin(), text.end(), ',') == 3 &&
                           corners[0] < corners[2] && corners[1] < corners[3];
        return right ? std::string() : text + ": X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1 was expected";
      },
      "");
}

int print_raster_job(const std::string& path, const GlobalOptions& options) {
  const Job job = read_unprogrammed_job(path);
  settle(job.diagnostics(), options);
  const Machine machine = job.machine();
  fmt::print("# {}\n{}\n# {}\n{}", path, job.to_toml(), machine.path(), machine.to_toml());
  return kDone;
}

/// The options of a raster on the command line.
class RasterCommand {
 public:
  /// Adds the options of rasters. Call it when the command has those of reading programs.
  RasterCommand(CLI::App& command, CLI::Option& program);
  /// --job or --part was given.
  bool asked_for() const;
  /// `shared`: the options that both kinds of resegment have. Throws CLI::RequiredError.
  Action action(const ResegmentArguments& shared, const GlobalOptions& options) const;

 private:
  RasterOptions options_;
  std::string job_path_;
  CLI::Option *part_, *job_;
  std::vector<CLI::Option*> required_;
};

RasterCommand::RasterCommand(CLI::App& command, CLI::Option& program) {
  for (const char* of_programs : {"--units", "--block-skip", "--skip-switch", "--dialect", "--least-increments"})
    command.get_option(of_programs)->needs(&program);
  const std::string group = "A raster on a part instead of a program";
  part_ = command.add_option("--part", options_.part, "the part as STL; default: the job's [part] mesh")
              ->type_name("part.stl")
              ->excludes(&program);
  job_ = command.add_option("--job", job_path_, "job.toml with machine, tool and stock")
             ->type_name("J.toml")
             ->excludes(&program);
  const auto with_job = [&](CLI::Option* option, const char* type) {
    return option->needs(job_)->group(group)->type_name(type);
  };
  part_->needs(job_)->group(group);
  job_->group(group);
  required_ = {
      with_job(command.add_option("--scallop-mm", options_.scallop_mm, "maximum scallop height between rows")
                   ->check(number_from_to(1e-5, 10)),
               "H"),
      with_job(command.add_option("--feed-mm-per-min", options_.feed_mm_per_min, "programmed feed")
                   ->check(number_from_to(0.1, 1e6)),
               "F"),
      with_job(
          command.add_option("--spindle-rpm", options_.spindle_rpm, "spindle speed")->check(number_from_to(1, 1e6)),
          "S")};
  with_job(command.add_option("--tool", options_.tool, "tool of the job; required if it has several")
               ->check(CLI::Range(0, 99999999)),
           "N");
  with_job(command.add_option("--direction-deg", options_.direction_deg, "direction of the rows, from +X; default 0")
               ->check(number_from_to(-360, 360)),
           "A");
  with_job(command
               .add_option_function<std::string>(
                   "--boundary",
                   [this](const std::string& text) {
                     options_.boundary_mm.clear();
                     for (std::size_t at = 0; at < text.size();) {
                       const std::size_t end = std::min(text.find(',', at), text.size());
                       options_.boundary_mm.push_back(parse_number(text.substr(at, end - at)).value_or(0));
                       at = end + 1;
                     }
                   },
                   "rectangle to machine; default: that of the part")
               ->check(rectangle_validator()),
           "X0,Y0,X1,Y1");
  with_job(command
               .add_option("--clearance-mm", options_.clearance_mm,
                           "Z of moves over the part; default 5 mm above stock and part")
               ->check(number_from_to(-1e6, 1e6)),
           "Z");
}

bool RasterCommand::asked_for() const { return !part_->empty() || !job_->empty(); }

Action RasterCommand::action(const ResegmentArguments& shared, const GlobalOptions& options) const {
  if (!options.effective_config)
    for (const CLI::Option* option : required_)
      if (option->empty()) throw CLI::RequiredError(option->get_name());
  if (shared.options.tolerance_mm < kFinestToleranceMm)
    throw CLI::ValidationError("--tolerance-mm",
                               fmt::format("{:g}: at least {:g} was expected for a raster, whose points are rounded to "
                                           "0.0001 mm",
                                           shared.options.tolerance_mm, kFinestToleranceMm));
  RasterArguments arguments{job_path_, shared.json, shared.report, options_};
  arguments.options.layout = shared.options;
  return [arguments, &options] {
    if (options.effective_config) return print_raster_job(arguments.job, options);
    check_outputs({arguments.options.layout.output, arguments.json, arguments.report}, {});
    return run_raster(arguments, options);
  };
}

}  // namespace

void add_resegment_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("resegment", "divide runs of G1 into segments just long enough for the control");
  auto arguments = std::make_shared<ResegmentArguments>();
  auto* program = command->add_option("program", arguments->program, "NC program")->type_name("P.nc");
  auto* machine =
      command->add_option("--machine", arguments->machine, "machine.toml")->type_name("M.toml")->needs(program);
  add_rewriting(*command, arguments->options.tolerance_mm, arguments->options.output, arguments->report);
  command->add_option("--length-mm", arguments->options.length_mm, "segment length; default: the fastest one")
      ->check(length_validator())
      ->type_name("L");
  command
      ->add_option("--contour-mm", arguments->options.contour_mm,
                   "maximum deviation of the predicted axes from the old path; default: maximum and rms not above "
                   "those of the old blocks, or the tolerance; for a raster no limit")
      ->check(length_validator())
      ->type_name("C");
  command->add_option("--json", arguments->json, "write the figures of all lengths tried")->type_name("R.json");
  add_reading_options(*command, arguments->read);
  add_language_options(*command, arguments->read);
  const auto raster = std::make_shared<RasterCommand>(*command, *program);
  command->callback([arguments, machine, raster, &options, &chosen] {
    if (raster->asked_for()) {
      chosen = raster->action(*arguments, options);
      return;
    }
    if (arguments->program.empty()) throw CLI::RequiredError("program, or --job with --part,");
    if (machine->empty()) throw CLI::RequiredError("--machine");
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->options.output, arguments->json, arguments->report},
                    {arguments->program, arguments->machine});
      return run_resegment(*arguments, options);
    };
  });
}

}  // namespace camber::cli
