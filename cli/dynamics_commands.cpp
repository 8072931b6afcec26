// lobes and fit-modes on the command line.
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/command_line.h"
#include "cli/fit_modes_command.h"
#include "cli/lobes_command.h"
#include "cli/outputs.h"
#include "dynamics/fit_modes.h"

namespace camber::cli {
namespace {

void add_lobes(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("lobes", "critical depths of a tool over the spindle speed");
  auto a = std::make_shared<LobesArguments>();
  command->add_option("job", a->job, "job.toml; its program is not needed")->required()->type_name("J.toml");
  command->add_option("--tool", a->tool, "number of the tool; not needed where the job has one")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  command->add_option("--radial-mm", a->radial_mm, "radial depth of cut")
      ->required()
      ->check(CLI::PositiveNumber)
      ->type_name("A");
  auto rpm = std::make_shared<std::string>();
  command->add_option("--rpm", *rpm, "spindle speeds, as in 4000:12000:81")->required()->type_name("FROM:TO:N");
  auto* up = command->add_flag("--up", a->up, "up-milling");
  auto down = std::make_shared<bool>();
  command->add_flag("--down", *down, "down-milling; the default")->excludes(up);
  command
      ->add_option("--method", a->method,
                   "zero: mean directions, fast, without flip lobes; semi: semi-discretisation (default)")
      ->check(CLI::IsMember({"zero", "semi"}))
      ->type_name("zero|semi");
  command->add_option("--chip-mm", a->chip_mm, "chip thickness at which a law that is not linear counts; 0.05")
      ->check(CLI::PositiveNumber)
      ->type_name("H");
  command
      ->add_option("--process-damping", a->process_damping_N_per_mm,
                   "process damping C, N/mm: force C b v / cutting speed; a guess unless measured, 50 to 1000; 0: none")
      ->check(CLI::NonNegativeNumber)
      ->type_name("C");
  command->add_option("-o,--output", a->output, "the table; lobes.csv")->type_name("LOBES.csv");
  command->add_option("--plot", a->plot, "a picture of the lobes")->type_name("P.svg");
  command->add_option("--json", a->json, "modes and lobes")->type_name("R.json");
  command->callback([a, rpm, down, &options, &chosen] {
    const auto speeds = parse_speeds(*rpm);
    if (!speeds)
      throw CLI::ValidationError(
          "--rpm", fmt::format("{}: FROM:TO:N, two speeds and how many, as in 4000:12000:81, was expected", *rpm));
    a->speeds_rpm = *speeds;
    chosen = [a, &options] { return run_lobes(*a, options); };
  });
}

void add_fit_modes(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("fit-modes", "fit natural modes of a tool to a tap test");
  auto a = std::make_shared<FitModesArguments>();
  command->add_option("response", a->response, "frequency response at the tip: CSV, or universal file (58)")
      ->required()
      ->type_name("TAP.csv");
  command->add_option("--tool", a->tool, "number of the tool; 1")->check(CLI::NonNegativeNumber)->type_name("N");
  command->add_option("--direction", a->direction, "of the tap: x (default) or y; xy: the tool is alike in both")
      ->check(CLI::IsMember({"x", "y", "xy"}))
      ->type_name("x|y|xy");
  command->add_option("--modes", a->modes, "number of modes; by the response itself where it is not given")
      ->check(CLI::Range(1, dynamics::kMostModes))
      ->type_name("N");
  auto band = std::make_shared<std::string>();
  command->add_option("--band", *band, "frequencies that count, Hz, as in 200:4000")->type_name("FROM:TO");
  command->add_option("-o,--output", a->output, "[[tool.N.mode]] tables for a job; modes.toml")
      ->type_name("MODES.toml");
  command->add_option("--plot", a->plot, "a picture of response and fit")->type_name("P.svg");
  command->add_option("--json", a->json, "the figures, with standard errors")->type_name("R.json");
  command->callback([a, band, &options, &chosen] {
    if (!band->empty() && !parse_band(*band, *a))
      throw CLI::ValidationError("--band", fmt::format("{}: FROM:TO in Hz, as in 200:4000, was expected", *band));
    chosen = [a, &options] {
      check_outputs({a->output, a->plot, a->json}, {a->response});
      return run_fit_modes(*a, options);
    };
  });
}

}  // namespace

void add_dynamics_commands(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  add_lobes(app, options, chosen);
  add_fit_modes(app, options, chosen);
}

}  // namespace camber::cli
