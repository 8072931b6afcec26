// camber plan PLAN.toml -o DIR [--operations T.toml] [--programs] [--json R.json]
#include "camber/plan.h"

#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct PlanArguments {
  std::string plan;
  std::string output_folder;
  std::string json;  ///< besides DIR/plan.json; empty: none
  bool cases_error = false;
  PlanOptions options{};
};

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut.
int run_plan(const PlanArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "reading");
  if (arguments.cases_error) {
    fmt::print("{}", cases_error(arguments.plan, run_options(progress, options)));
    return kDone;
  }
  PlanOptions asked = arguments.options;
  asked.page = true;
  const PlanResult result = v0::plan(arguments.plan, asked, run_options(progress, options));
  print_translation(result.translation, options);
  make_folder(arguments.output_folder);
  Diagnostics failed;
  const auto write = [&](const std::string& path, const std::string& text) {
    try_to_write([&] { write_file(path, text); }, failed);
  };
  for (const auto& [name, text] : result.files) write(arguments.output_folder + "/" + name, text);
  write(arguments.output_folder + "/plan.json", result.json);
  if (!arguments.json.empty()) write(arguments.json, result.json);
  write(arguments.output_folder + "/report.html", result.page);
  if (!options.quiet) fmt::print("{}", result.printed);
  if (result.learned) {
    if (result.learned->added > 0) write(result.learned->path, result.learned->text);
    if (!options.quiet) fmt::print("{} new cases in {}\n", result.learned->added, result.learned->path);
  }
  failed.throw_if_errors();
  for (const std::string& sentence : result.unmachined) print_error(sentence);
  return result.success ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace

void add_plan_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("plan", "operations, tools, conditions and order from a blank and a part");
  auto arguments = std::make_shared<PlanArguments>();
  command->add_option("plan", arguments->plan, "plan.toml: blank, part, machine, tools, case base")
      ->required()
      ->type_name("PLAN.toml");
  auto* output =
      command->add_option("-o,--output", arguments->output_folder, "folder for the results")->type_name("DIR");
  command
      ->add_option("--operations", arguments->options.operations,
                   "go on from this table of operations (DIR/operations.toml of an earlier run, edited)")
      ->type_name("T.toml");
  command->add_flag("--programs", arguments->options.programs,
                    "also the programs of the plan, by copy milling, and their times by the feed model");
  command->add_flag("--all-programs", arguments->options.all_programs,
                    "programs of all three plans; their times decide which plan is taken");
  command->add_option("--json", arguments->json, "also write the figures to this file")->type_name("R.json");
  auto* cases = command->add_flag("--cases-error", arguments->cases_error,
                                  "print how well the cases predict each other, and plan nothing");
  command->add_flag("--learn", arguments->options.learn, "add the conditions of the operations to the case base")
      ->excludes(cases);
  command->callback([arguments, output, &options, &chosen] {
    if (output->empty() && !arguments->cases_error) throw CLI::RequiredError("-o DIR or --cases-error");
    chosen = [arguments, &options] {
      if (!arguments->cases_error) {
        check_output_folder(arguments->output_folder);
        check_outputs({arguments->json}, {arguments->plan, arguments->options.operations});
      }
      return run_plan(*arguments, options);
    };
  });
}

}  // namespace camber::cli
