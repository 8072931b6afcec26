#include "cli/init_command.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <regex>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "kinematics/control_options.h"
#include "kinematics/travel_check.h"
#include "machine/assumptions.h"
#include "machine/machine_model.h"
#include "machine/machine_presets.h"
#include "machine/material_presets.h"
#include "nc/program_text.h"
#include "nc/tool_names.h"
#include "report/job_proposal.h"

namespace camber::cli {
namespace {

namespace fs = std::filesystem;

/// A file's name as a job in another folder writes it.
std::string seen_from(const std::string& file, const std::string& job) {
  if (file.empty() || machine::is_preset(file)) return file;
  const fs::path folder = fs::absolute(job).parent_path();
  return fs::absolute(file).lexically_normal().lexically_proximate(folder.lexically_normal()).string();
}

/// Comments of the program come first: they belong to it; then the names by which it calls its tools.
std::vector<machine::ToolProposal> all_tools(const SourceText& program, const nc::Interpretation& moves,
                                             const InitArguments& arguments, bool inch, Diagnostics& diagnostics) {
  static const std::regex diameter("(^|[^A-Za-z])[Dd][0-9]");  // a number alone may be any
  std::vector<machine::ToolProposal> out = machine::tools_in_comments(program, inch), named;
  for (const auto& [number, name] : moves.tool_names) {
    machine::ToolProposal tool = machine::tool_of_words(name, inch);
    tool.number = number;
    tool.from = "its name";
    if (tool.type || std::regex_search(name, diameter)) named.push_back(std::move(tool));
  }
  machine::add_tools(out, named);
  for (const auto& path : arguments.tools) machine::add_tools(out, machine::read_tools(path, inch, diagnostics));
  return out;
}

/// A preset as a machine file to start from.
int write_machine(const InitArguments& arguments, const GlobalOptions& options) {
  const machine::MachinePreset* preset = machine::find_machine_preset(arguments.machine);
  write_file(arguments.output, machine::machine_preset_text(*preset));
  if (!options.quiet)
    fmt::print("{}: {}; all values are typical of the class: docs/guide/machine-file.md\n", arguments.output,
               preset->what);
  return kDone;
}

/// A preset that is there, or a file.
CLI::Validator machine_name() {
  return CLI::Validator(
      [](std::string& name) {
        return machine::is_preset(name) && !machine::find_machine_preset(name) ? machine::unknown_machine_preset(name)
                                                                               : std::string();
      },
      "");
}

CLI::Validator material_name() {
  return CLI::Validator(
      [](std::string& name) {
        return machine::find_material(name).preset ? std::string() : machine::unknown_material(name);
      },
      "");
}

/// Machines of which a program that turns rotary axes takes the first that has them.
constexpr std::array kFiveAxisPresets{"preset:five-axis-trunnion", "preset:five-axis-trunnion-bc"};

/// Returns `options` as the named machine reads programs: with words of rotary axes where it has some.
nc::InterpreterOptions interpreter_of(const std::string& machine_path, nc::InterpreterOptions options) {
  if (machine_path.empty()) return options;
  Diagnostics of_machine;
  options.rotary_axes = kinematics::rotary_options(machine::read_machine(machine_path, of_machine));
  constexpr int kG54 = 54;
  if (machine::is_preset(machine_path)) options.work_offsets_mm.try_emplace(kG54, Vec3::Zero());
  return options;
}

bool turns_the_tool(const nc::Summary& summary) { return summary.rotary > 0 || summary.tilted_frame > 0; }

struct ReadForJob {
  nc::Interpretation moves;
  std::string machine;  ///< as the arguments name it; else one with the rotary axes that the program turns, or empty
  std::map<int, double> cutters_mm{};  ///< see JobProposal
};

bool wants_axes(const Diagnostic& d) {
  return d.check == "rotary-axis" || d.check == "tilted-plane" || d.check == "not-read";
}

bool asks_for_cutter(const Diagnostics& found) {
  return found.has_errors() && std::ranges::any_of(found.all(), [](const Diagnostic& d) {
           return d.check == "radius-unknown" || d.check == "unknown-parameter";
         });
}

/// The moves. Where cycles ask for the diameter of cutters that nothing tells: the largest of some usual ones with
/// which most of them fit; `cutters_mm` gets them by tool.
nc::Interpretation moves_of(const nc::Program& text, const InitArguments& arguments, nc::InterpreterOptions options,
                            std::map<int, double>& cutters_mm, Diagnostics& diagnostics) {
  const auto read = [&](Diagnostics& found) {
    found = diagnostics;
    return nc::interpret(text, options, found);
  };
  Diagnostics found;
  nc::Interpretation moves = read(found);
  if (asks_for_cutter(found)) {
    std::map<int, double> told;
    Diagnostics ignored;
    for (const auto& t : all_tools(text.source, moves, arguments, nc::summarize(text, moves).has_inch, ignored))
      if (t.number && t.diameter_mm) told[*t.number] = *t.diameter_mm;
    std::set<int> tools;
    for (const nc::ModalState& state : moves.states) tools.insert(state.tool);
    for (const nc::Event& e : moves.events)
      if (e.kind == nc::EventKind::tool_change) tools.insert(static_cast<int>(e.value));
    const auto set = [&](int tool, double diameter_mm) {
      nc::set_cutter_radius(options.tool_offsets, tool, diameter_mm / 2);
    };
    for (const int tool : tools) set(tool, told.contains(tool) ? told[tool] : report::kUsualDiameter_mm);
    for (const int tool : tools) {
      if (told.contains(tool)) continue;
      set(tool, 0);
      read(found);
      set(tool, report::kUsualDiameter_mm);
      if (!asks_for_cutter(found)) continue;
      std::ptrdiff_t least = std::numeric_limits<std::ptrdiff_t>::max();
      for (const double diameter_mm : {report::kUsualDiameter_mm, 8.0, 6.0, 5.0, 4.0, 3.0, 2.0}) {
        set(tool, diameter_mm);
        read(found);
        const auto unfit =
            std::ranges::count_if(found.all(), [](const Diagnostic& d) { return d.check == "cutter-too-large"; });
        if (unfit < least) least = unfit, cutters_mm[tool] = diameter_mm;
        if (unfit == 0) break;
      }
      set(tool, cutters_mm[tool]);
    }
    moves = read(found);
  }
  diagnostics = std::move(found);
  return moves;
}

/// The moves; where no machine is named and the program turns rotary axes, those of a machine that has them. What such
/// a machine cannot read either is said of it, not that rotary axes are missing.
ReadForJob read_moves(const InitArguments& arguments, const nc::Program& text, Diagnostics& diagnostics) {
  Diagnostics upright = diagnostics;
  std::map<int, double> cutters;
  ReadForJob out{moves_of(text, arguments, interpreter_of(arguments.machine, arguments.interpreter), cutters, upright),
                 arguments.machine, cutters};
  const bool turns = std::ranges::any_of(upright.all(), wants_axes);
  if (turns && arguments.machine.empty())
    for (const char* preset : kFiveAxisPresets) {
      Diagnostics tilted = diagnostics;
      nc::Interpretation with_axes =
          moves_of(text, arguments, interpreter_of(preset, arguments.interpreter), cutters, tilted);
      if (tilted.has_errors()) {
        if (upright.has_errors() && std::ranges::none_of(tilted.all(), wants_axes)) upright = std::move(tilted);
        continue;
      }
      if (!turns_the_tool(nc::summarize(text, with_axes))) continue;
      Diagnostics of_axes;  // a plane that this machine's axes turn to the other side
      kinematics::check_travel(machine::read_machine(preset, of_axes), text, with_axes, of_axes);
      if (of_axes.has_errors()) continue;
      diagnostics = std::move(tilted);
      return {std::move(with_axes), preset, cutters};
    }
  diagnostics = std::move(upright);
  return out;
}

}  // namespace

int run_init(const InitArguments& arguments, const GlobalOptions& options) {
  std::error_code ec;
  if (fs::exists(arguments.output, ec))
    fail_on_file(arguments.output, "already exists; a new name was expected", "file-exists");
  if (arguments.program.empty()) return write_machine(arguments, options);
  Diagnostics diagnostics;
  const nc::Program text = nc::read_program(SourceText::read(arguments.program), diagnostics);
  const auto [moves, machine, cutters] = read_moves(arguments, text, diagnostics);
  if (moves.moves.empty() && !diagnostics.has_errors())
    diagnostics.add(text.source.diagnostic(
        Severity::error, 0, "the program has no moves; one that cuts was expected for a job", "no-moves"));
  const nc::Summary summary = nc::summarize(text, moves);
  const auto tools = all_tools(text.source, moves, arguments, summary.has_inch, diagnostics);
  settle(diagnostics, options);
  write_file(arguments.output,
             report::job_text({seen_from(arguments.program, arguments.output), seen_from(machine, arguments.output),
                               summary, tools, text, moves, arguments.material, arguments.interpreter.inch, cutters}));
  if (options.quiet) return kDone;
  const auto cutting =
      std::count_if(summary.tools.begin(), summary.tools.end(), [](const auto& t) { return t.cutting_moves > 0; });
  Diagnostics of_job;
  fmt::print("{}{}: {} tool{}; what is assumed is marked \"typical\" or CHECK in it\n",
             machine::assumptions_text(machine::assumptions(machine::read_job(arguments.output, of_job))),
             arguments.output, cutting, cutting == 1 ? "" : "s");
  return kDone;
}

void add_init_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("init", "write a job that runs, from a program and tool tables");
  auto arguments = std::make_shared<InitArguments>();
  auto* program = command->add_option("program", arguments->program, "NC program")->type_name("P.nc");
  command->add_option("-o,--output", arguments->output, "the new job file; without a program the new machine file")
      ->required()
      ->type_name("job.toml");
  command
      ->add_option(
          "--tools", arguments->tools,
          "a tool library of Fusion (.json, .tools, .csv), HSMWorks (.hsmlib), FreeCAD (.fctl), Vectric (.vtdb) or "
          "LinuxCNC (.tbl), or a folder of them; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("FILE|FOLDER");
  std::vector<std::string_view> presets;
  for (const auto& preset : machine::machine_presets()) presets.push_back(preset.name);
  command
      ->add_option("--machine", arguments->machine,
                   fmt::format("the machine that the job names: a file, or typical values of a class, preset:{}",
                               fmt::join(presets, ", preset:")))
      ->check(machine_name())
      ->type_name("M.toml|preset:NAME");
  command
      ->add_option(
          "--material", arguments->material,
          "by number or name (1.2343, 42CrMo4, 4140, SKD61, Al6082-T6 ...), with a hardness where it is not as "
          "supplied: \"1.2379 60 HRC\"; default: C45, or aluminium at the speeds that only it is cut with")
      ->check(material_name())
      ->type_name("NAME");
  command->add_option("--units", arguments->interpreter.inch, "unit of a program without G20 and G21")
      ->transform(CLI::CheckedTransformer(std::map<std::string, bool>{{"mm", false}, {"inch", true}}).description(""))
      ->type_name("mm|inch");
  command->callback([arguments, program, &options, &chosen] {
    if (program->empty() && !machine::is_preset(arguments->machine))
      throw CLI::RequiredError("P.nc or --machine preset:NAME");
    chosen = [arguments, &options] {
      check_outputs({arguments->output}, {});
      return run_init(*arguments, options);
    };
  });
}

}  // namespace camber::cli
