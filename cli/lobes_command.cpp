// camber lobes: stability lobes of a tool of a job.
#include "camber/lobes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/numbers.h"
#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/outputs.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct LobesArguments {
  std::string job;
  std::string method = "semi";                   ///< or "zero"
  std::string output = "lobes.csv", plot, json;  ///< plot, json: empty: none
  LobesOptions options{};
};

/// "FROM:TO:N": N speeds, the first and the last as given. Nothing where it is not.
std::optional<std::vector<double>> parse_speeds(const std::string& text) {
  std::vector<double> n;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    n.push_back(parse_number(std::string_view(text).substr(begin, end - begin)).value_or(-1));
    begin = end + 1;
  }
  constexpr double kMostSpeeds = 100000;
  if (n.size() != 3 || n[0] <= 0 || n[1] <= n[0] || n[2] < 2 || n[2] > kMostSpeeds || n[2] != std::floor(n[2]))
    return std::nullopt;
  std::vector<double> speeds;
  speeds.reserve(static_cast<std::size_t>(n[2]));
  for (int i = 0; i < n[2]; ++i) speeds.push_back(n[0] + (n[1] - n[0]) * i / (n[2] - 1));
  return speeds;
}

/// Throws InputError.
int run_lobes(const LobesArguments& a, const GlobalOptions& options) {
  const Job job = read_unprogrammed_job(a.job);
  check_outputs({a.output, a.plot, a.json}, {a.job});
  LobesOptions asked = a.options;
  asked.zero_order = a.method == "zero";
  ProgressLine progress(options, "lobes");
  const LobesResult result = lobes(job, asked, run_options(progress, options));
  if (!options.quiet) fmt::print("{}", result.printed);
  write_file(a.output, result.csv);
  if (!a.plot.empty()) write_file(a.plot, result.plot);
  if (!a.json.empty()) write_file(a.json, result.json);
  return kDone;
}

}  // namespace

void add_lobes_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("lobes", "critical depths of a tool over the spindle speed");
  auto a = std::make_shared<LobesArguments>();
  command->add_option("job", a->job, "job.toml; its program is not needed")->required()->type_name("J.toml");
  command->add_option("--tool", a->options.tool, "number of the tool; not needed where the job has one")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  command->add_option("--radial-mm", a->options.radial_mm, "radial depth of cut")
      ->required()
      ->check(CLI::PositiveNumber)
      ->type_name("A");
  auto rpm = std::make_shared<std::string>();
  command->add_option("--rpm", *rpm, "spindle speeds, as in 4000:12000:81")->required()->type_name("FROM:TO:N");
  auto* up = command->add_flag("--up", a->options.up, "up-milling");
  auto down = std::make_shared<bool>();
  command->add_flag("--down", *down, "down-milling; the default")->excludes(up);
  command
      ->add_option("--method", a->method,
                   "zero: mean directions, fast, without flip lobes; semi: semi-discretisation (default)")
      ->check(CLI::IsMember({"zero", "semi"}))
      ->type_name("zero|semi");
  command->add_option("--chip-mm", a->options.chip_mm, "chip thickness at which a law that is not linear counts; 0.05")
      ->check(CLI::PositiveNumber)
      ->type_name("H");
  command
      ->add_option("--process-damping", a->options.process_damping_N_per_mm,
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
    a->options.speeds_rpm = *speeds;
    chosen = [a, &options] { return run_lobes(*a, options); };
  });
}

}  // namespace camber::cli
