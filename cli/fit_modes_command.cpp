// camber fit-modes: natural modes of a tool from a tap test.
#include "camber/fit_modes.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/numbers.h"
#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "dynamics/modal_fit.h"

namespace camber::cli {
namespace {

struct FitModesArguments {
  std::string response;
  std::string output = "modes.toml", plot, json;  ///< plot, json: empty: none
  FitModesOptions options{};
};

/// "FROM:TO", Hz, into the band. False where it is not.
bool parse_band(const std::string& text, FitModesOptions& into) {
  const auto colon = std::min(text.find(':'), text.size());
  const auto from = parse_number(std::string_view(text).substr(0, colon));
  const auto to = colon < text.size() ? parse_number(std::string_view(text).substr(colon + 1)) : std::nullopt;
  if (!from || !to || *from < 0 || *to <= *from) return false;
  into.from_hz = *from, into.to_hz = *to;
  return true;
}

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut where no mode was found; then nothing is written.
int run_fit_modes(const FitModesArguments& a, const GlobalOptions& options) {
  const FitModesResult result = fit_modes(a.response, a.options);
  if (result.modes.empty()) {
    print_error(
        fmt::format("{}: no mode stands out of the noise{}; a band (--band) around the resonances or another "
                    "number of modes (--modes) was expected",
                    a.response, a.options.modes ? fmt::format(" with {} of them", *a.options.modes) : ""));
    return kNumbersDidNotWorkOut;
  }
  if (!options.quiet) fmt::print("{}", result.printed);
  write_file(a.output, result.tables);
  if (!a.plot.empty()) write_file(a.plot, result.plot);
  if (!a.json.empty()) write_file(a.json, result.json);
  return kDone;
}

}  // namespace

void add_fit_modes_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("fit-modes", "fit natural modes of a tool to a tap test");
  auto a = std::make_shared<FitModesArguments>();
  command->add_option("response", a->response, "frequency response at the tip: CSV, or universal file (58)")
      ->required()
      ->type_name("TAP.csv");
  command->add_option("--tool", a->options.tool, "number of the tool; 1")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  command
      ->add_option("--direction", a->options.direction, "of the tap: x (default) or y; xy: the tool is alike in both")
      ->check(CLI::IsMember({"x", "y", "xy"}))
      ->type_name("x|y|xy");
  command->add_option("--modes", a->options.modes, "number of modes; by the response itself where it is not given")
      ->check(CLI::Range(1, dynamics::kMostModes))
      ->type_name("N");
  auto band = std::make_shared<std::string>();
  command->add_option("--band", *band, "frequencies that count, Hz, as in 200:4000")->type_name("FROM:TO");
  command->add_option("-o,--output", a->output, "[[tool.N.mode]] tables for a job; modes.toml")
      ->type_name("MODES.toml");
  command->add_option("--plot", a->plot, "a picture of response and fit")->type_name("P.svg");
  command->add_option("--json", a->json, "the figures, with standard errors")->type_name("R.json");
  command->callback([a, band, &options, &chosen] {
    if (!band->empty() && !parse_band(*band, a->options))
      throw CLI::ValidationError("--band", fmt::format("{}: FROM:TO in Hz, as in 200:4000, was expected", *band));
    chosen = [a, &options] {
      check_outputs({a->output, a->plot, a->json}, {a->response});
      return run_fit_modes(*a, options);
    };
  });
}

}  // namespace camber::cli
