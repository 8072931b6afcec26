#include "cli/raster_options.h"

#include <cmath>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/numbers.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/validators.h"
#include "machine/job_file.h"

namespace camber::cli {
namespace {

constexpr double kFinestToleranceMm = 0.0005;

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

int print_job(const std::string& path, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Job job = machine::read_unprogrammed_job(path, diagnostics);
  settle(diagnostics, options);
  fmt::print("# {}\n{}\n# {}\n{}", path, machine::to_toml(job), job.machine_path, machine::to_toml(job.machine));
  return kDone;
}

}  // namespace

RasterOptions::RasterOptions(CLI::App& command, CLI::Option& program) {
  for (const char* of_programs : {"--units", "--block-skip", "--skip-switch", "--dialect", "--least-increments"})
    command.get_option(of_programs)->needs(&program);
  const std::string group = "A raster on a part instead of a program";
  part_ = command.add_option("--part", arguments_.part, "the part as STL; default: the job's [part] mesh")
              ->type_name("part.stl")
              ->excludes(&program);
  job_ = command.add_option("--job", arguments_.job, "job.toml with machine, tool and stock")
             ->type_name("J.toml")
             ->excludes(&program);
  const auto with_job = [&](CLI::Option* option, const char* type) {
    return option->needs(job_)->group(group)->type_name(type);
  };
  part_->needs(job_)->group(group);
  job_->group(group);
  required_ = {
      with_job(command.add_option("--scallop-mm", arguments_.scallop_mm, "maximum scallop height between rows")
                   ->check(number_from_to(1e-5, 10)),
               "H"),
      with_job(command.add_option("--feed-mm-per-min", arguments_.feed_mm_per_min, "programmed feed")
                   ->check(number_from_to(0.1, 1e6)),
               "F"),
      with_job(
          command.add_option("--spindle-rpm", arguments_.spindle_rpm, "spindle speed")->check(number_from_to(1, 1e6)),
          "S")};
  with_job(command.add_option("--tool", arguments_.tool, "tool of the job; required if it has several")
               ->check(CLI::Range(0, 99999999)),
           "N");
  with_job(command.add_option("--direction-deg", arguments_.direction_deg, "direction of the rows, from +X; default 0")
               ->check(number_from_to(-360, 360)),
           "A");
  with_job(command
               .add_option_function<std::string>(
                   "--boundary",
                   [this](const std::string& text) {
                     arguments_.boundary_mm.clear();
                     for (std::size_t at = 0; at < text.size();) {
                       const std::size_t end = std::min(text.find(',', at), text.size());
                       arguments_.boundary_mm.push_back(parse_number(text.substr(at, end - at)).value_or(0));
                       at = end + 1;
                     }
                   },
                   "rectangle to machine; default: that of the part")
               ->check(rectangle_validator()),
           "X0,Y0,X1,Y1");
  with_job(command
               .add_option("--clearance-mm", arguments_.clearance_mm,
                           "Z of moves over the part; default 5 mm above stock and part")
               ->check(number_from_to(-1e6, 1e6)),
           "Z");
}

bool RasterOptions::asked_for() const { return !part_->empty() || !job_->empty(); }

Action RasterOptions::action(const ResegmentArguments& shared, const GlobalOptions& options) const {
  if (!options.effective_config)
    for (const CLI::Option* option : required_)
      if (option->empty()) throw CLI::RequiredError(option->get_name());
  if (shared.tolerance_mm < kFinestToleranceMm)
    throw CLI::ValidationError("--tolerance-mm",
                               fmt::format("{:g}: at least {:g} was expected for a raster, whose points are rounded to "
                                           "0.0001 mm",
                                           shared.tolerance_mm, kFinestToleranceMm));
  RasterArguments arguments = arguments_;
  arguments.output = shared.output;
  arguments.json = shared.json;
  arguments.report = shared.report;
  arguments.tolerance_mm = shared.tolerance_mm;
  arguments.length_mm = shared.length_mm;
  arguments.contour_mm = shared.contour_mm;
  return [arguments, &options] {
    if (options.effective_config) return print_job(arguments.job, options);
    check_outputs({arguments.output, arguments.json, arguments.report}, {});
    return run_raster(arguments, options);
  };
}

std::shared_ptr<RasterOptions> add_raster_options(CLI::App& command, CLI::Option& program) {
  return std::make_shared<RasterOptions>(command, program);
}

}  // namespace camber::cli
