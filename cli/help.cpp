// What helps at the prompt: an example for each subcommand, and completion.
#include <memory>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/command_line.h"

namespace camber::cli {
namespace {

constexpr std::pair<const char*, const char*> kExamples[] = {
    {"check",
     "camber check finish.nc --units mm\n"
     "  camber check finish.nc --machine machine.toml --report finish.html"},
    {"feed", "camber feed finish.nc --machine machine.toml -o feed.csv"},
    {"time",
     "camber time finish.nc --machine machine.toml --report time.html\n"
     "  camber time finish.nc --machine machine.toml --sweep axis.x.acceleration_mm_per_s2=300:1200:4"},
    {"fit-feed", "camber fit-feed --program trace_program.nc --trace trace.csv --machine machine.toml -o fitted.toml"},
    {"fit-parts", "camber fit-parts plate_01.toml plate_07.toml -o fitted"},
    {"protocol",
     "camber protocol --machine machine.toml -o programs\n  camber protocol --machine machine.toml --part -o "
     "test_piece"},
    {"fit-force", "camber fit-force --log means.csv --job job.toml -o material.toml"},
    {"lobes", "camber lobes job.toml --tool 1 --radial-mm 2 --rpm 4000:16000:121 --plot lobes.svg"},
    {"fit-modes", "camber fit-modes tap_x.csv --tool 1 --direction x -o modes.toml --plot tap_x.svg"},
    {"init", "camber init finish.nc --machine machine.toml --material S55C -o first_job.toml"},
    {"predict",
     "camber predict job.toml -o predicted\n"
     "  camber predict job.toml -o parts --sections 4 --section 1 --stage sweep"},
    {"merge", "camber merge parts"},
    {"compensate",
     "camber compensate job.toml -o finish_compensated.nc --report report.html --json figures.json\n"
     "  camber compensate --verify finish_compensated.nc"},
    {"adapt",
     "camber adapt job.toml -o rough_adapted.nc --report report.html --json figures.json\n"
     "  camber adapt job.toml -o rough_adapted.nc --time-limit 22 --sweep"},
    {"study",
     "camber study study.toml -o study\n"
     "  camber study study.toml -o study --list > commands.txt"},
    {"copy",
     "camber copy slot.toml -o part.nc --stock left.vdb --json figures.json\n"
     "  camber copy slot.toml -o part.nc --stream ticks.csv --stop-after 10"},
    {"plan",
     "camber plan plan.toml -o planned\n"
     "  camber plan plan.toml --operations planned/operations.toml -o planned_again"},
    {"compress", "camber compress finish.nc --tolerance-mm 0.002 -o finish_arcs.nc"},
    {"resegment",
     "camber resegment finish.nc --machine machine.toml --tolerance-mm 0.002 -o finish_even.nc\n"
     "  camber resegment --part part.stl --job job.toml --scallop-mm 0.005 --tolerance-mm 0.005 --feed-mm-per-min 8000 "
     "--spindle-rpm 12000 -o raster.nc"},
    {"post",
     "camber post dome.nc --machine machine.toml -o dome_joints.nc\n"
     "  camber post dome_joints.nc --machine machine.toml --to tcp -o dome_tip.nc"},
    {"posture",
     "camber posture finish.nc --job job.toml -o finish_5x.nc\n"
     "  camber posture finish.nc --job job.toml -o finish_5x.nc --overhang 10 --json figures.json"},
    {"ui",
     "camber ui jobs\n"
     "  camber ui jobs --no-open --port 8123"},
    {"completion", "camber completion bash > ~/.local/share/bash-completion/completions/camber"}};

}  // namespace

void add_help(CLI::App& app, Action& chosen) {
  auto* completion = app.add_subcommand("completion", "print a completion script for a shell");
  auto shell = std::make_shared<std::string>();
  completion->add_option("shell", *shell, "the shell")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}).description(""))
      ->type_name("bash|zsh|fish");
  completion->callback([shell, &app, &chosen] {
    chosen = [shell, &app] {
      fmt::print("{}", completion_script(app, *shell));
      return kDone;
    };
  });
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    for (const auto& [name, example] : kExamples)
      if (command->get_name() == name) command->footer(fmt::format("Example:\n  {}", example));
}

}  // namespace camber::cli
