#include "cli/init_command.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "machine/material_presets.h"
#include "nc/program.h"
#include "report/job_proposal.h"

namespace camber::cli {
namespace {

namespace fs = std::filesystem;

/// A file's name as a job in another folder writes it.
std::string seen_from(const std::string& file, const std::string& job) {
  if (file.empty()) return {};
  const fs::path folder = fs::absolute(job).parent_path();
  return fs::absolute(file).lexically_normal().lexically_proximate(folder.lexically_normal()).string();
}

/// Comments of the program come first: they belong to it.
std::vector<machine::ToolProposal> all_tools(const SourceText& program, const InitArguments& arguments, bool inch,
                                             Diagnostics& diagnostics) {
  std::vector<machine::ToolProposal> out = machine::tools_in_comments(program, inch);
  for (const auto& path : arguments.tools) machine::add_tools(out, machine::read_tools(path, inch, diagnostics));
  return out;
}

}  // namespace

int run_init(const InitArguments& arguments, const GlobalOptions& options) {
  std::error_code ec;
  if (fs::exists(arguments.output, ec))
    fail_on_file(arguments.output, "already exists; a new name was expected", "file-exists");
  Diagnostics diagnostics;
  const nc::Program text = nc::read_program(SourceText::read(arguments.program), diagnostics);
  const nc::Interpretation moves = nc::interpret(text, arguments.interpreter, diagnostics);
  const nc::Summary summary = nc::summarize(text, moves);
  const auto tools = all_tools(text.source, arguments, summary.has_inch, diagnostics);
  settle(diagnostics, options);
  write_file(arguments.output, report::job_text({seen_from(arguments.program, arguments.output),
                                                 seen_from(arguments.machine, arguments.output), summary, tools, text,
                                                 moves, arguments.material, arguments.interpreter.inch}));
  if (!options.quiet) {
    const auto cutting =
        std::count_if(summary.tools.begin(), summary.tools.end(), [](const auto& t) { return t.cutting_moves > 0; });
    fmt::print("{}: {} tool{}; fill in the keys left as \"# key =\", check what is marked \"typical\"\n",
               arguments.output, cutting, cutting == 1 ? "" : "s");
  }
  return kDone;
}

void add_init_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("init", "write a draft job file from a program and tool tables");
  auto arguments = std::make_shared<InitArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  command->add_option("-o,--output", arguments->output, "the new job file")->required()->type_name("job.toml");
  command
      ->add_option(
          "--tools", arguments->tools,
          "a tool library of Fusion (.json, .tools, .csv), HSMWorks (.hsmlib), FreeCAD (.fctl), Vectric (.vtdb) or "
          "LinuxCNC (.tbl), or a folder of them; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("FILE|FOLDER");
  command->add_option("--machine", arguments->machine, "the machine that the job names")->type_name("M.toml");
  std::vector<std::string> presets;
  for (const auto& preset : machine::material_presets()) presets.emplace_back(preset.name);
  command->add_option("--material", arguments->material, "a material preset")
      ->check(CLI::IsMember(presets).description(""))
      ->type_name(fmt::format("{}", fmt::join(presets, "|")));
  command->add_option("--units", arguments->interpreter.inch, "unit of a program without G20 and G21")
      ->transform(CLI::CheckedTransformer(std::map<std::string, bool>{{"mm", false}, {"inch", true}}).description(""))
      ->type_name("mm|inch");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      check_outputs({arguments->output}, {});
      return run_init(*arguments, options);
    };
  });
}

}  // namespace camber::cli
