// camber merge DIR [--json R.json]
#include <memory>

#include <CLI/CLI.hpp>

#include "camber/sections.h"
#include "cli/job_commands.h"
#include "cli/outputs.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct MergeArguments {
  std::string folder;
  std::string json;  ///< empty: only summary.json in the folder
};

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut.
int run_merge(const MergeArguments& arguments, const GlobalOptions& options) {
  std::size_t settled = 0;
  PredictResult result;
  {
    ProgressLine progress(options, "merging");
    result =
        merge(arguments.folder, {.rows = false, .throw_if_unwritten = false}, run_options(progress, options, &settled));
  }
  return finish_prediction(result, settled, arguments.json, options);
}

}  // namespace

void add_merge_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("merge", "join the parts that predict --sections has written");
  auto arguments = std::make_shared<MergeArguments>();
  command->add_option("folder", arguments->folder, "folder of the parts, and for the results")
      ->required()
      ->check(CLI::ExistingDirectory.description(""))
      ->type_name("DIR");
  command->add_option("--json", arguments->json, "also write the figures to this file")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      check_output_folder(arguments->folder);
      check_outputs({arguments->json}, {});
      return run_merge(*arguments, options);
    };
  });
}

}  // namespace camber::cli
