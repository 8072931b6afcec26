// What helps at the prompt: an example for each subcommand, and completion for bash.
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/command_line.h"

namespace camber::cli {
namespace {

constexpr std::pair<const char*, const char*> kExamples[] = {
    {"check", "camber check finish.nc --units mm"},
    {"feed", "camber feed finish.nc --machine machine.toml -o feed.csv"},
    {"time", "camber time finish.nc --machine machine.toml --sweep axis.acceleration_mm_per_s2=300:1200:4"},
    {"fit-feed", "camber fit-feed --program axes.nc --trace axes.csv --machine machine.toml -o fitted.toml"},
    {"protocol", "camber protocol --machine machine.toml -o programs"},
    {"fit-force", "camber fit-force --log slots.csv --job slots.toml -o material.toml"},
    {"init", "camber init finish.nc --tools tool.tbl --machine fitted.toml -o job.toml"},
    {"predict", "camber predict job.toml -o predicted"},
    {"compensate", "camber compensate job.toml -o finish_compensated.nc --report report.html --json figures.json"},
    {"compress", "camber compress finish.nc --tolerance-mm 0.002 -o finish_arcs.nc"},
    {"resegment",
     "camber resegment finish.nc --machine machine.toml --tolerance-mm 0.002 -o finish_even.nc\n"
     "  camber resegment --part part.stl --job job.toml --scallop-mm 0.005 --tolerance-mm 0.005 --feed-mm-per-min 8000 "
     "--spindle-rpm 12000 -o raster.nc"},
    {"completion", "camber completion bash > ~/.local/share/bash-completion/completions/camber"}};

std::string names_of(const CLI::App& app) {
  std::string out;
  for (const CLI::Option* option : app.get_options()) {
    for (const auto& name : option->get_snames()) out += " -" + name;
    for (const auto& name : option->get_lnames()) out += " --" + name;
  }
  return out;
}

/// "mm|inch" as words; nothing for other types.
std::string words_of(const CLI::Option& option) {
  std::string type = option.get_type_name();
  if (type.find('|') == std::string::npos || type.find_first_of(" :[=") != std::string::npos) return {};
  for (char& c : type)
    if (c == '|') c = ' ';
  return type;
}

std::string completion_script(const CLI::App& app) {
  std::string commands, cases, values;
  for (const CLI::App* sub : app.get_subcommands({})) {
    commands += " " + sub->get_name();
    cases += fmt::format("    {}) words=\"{}\" ;;\n", sub->get_name(), names_of(*sub).substr(1));
    for (const CLI::Option* option : sub->get_options())
      if (const std::string words = words_of(*option); !words.empty() && !option->get_lnames().empty())
        values += fmt::format("    {}:--{}) COMPREPLY=($(compgen -W \"{}\" -- \"$current\")); return ;;\n",
                              sub->get_name(), option->get_lnames().front(), words);
  }
  return fmt::format(R"(# Completion of camber for bash; made by camber completion bash.
_camber() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" previous="${{COMP_WORDS[COMP_CWORD-1]}}" command="" words="" word
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case " {0} " in *" $word "*) command="$word"; break ;; esac
  done
  case "$command:$previous" in
{3}    completion:completion) COMPREPLY=($(compgen -W "bash" -- "$current")); return ;;
  esac
  case "$command" in
    "") words="{0}" ;;
{1}  esac
  case "$current" in
    -*) COMPREPLY=($(compgen -W "$words {2}" -- "$current")) ;;
    *) if [ -z "$command" ]; then COMPREPLY=($(compgen -W "$words" -- "$current"))
       else COMPREPLY=($(compgen -f -- "$current")); fi ;;
  esac
}}
complete -o filenames -F _camber camber
)",
                     commands.substr(1), cases, names_of(app).substr(1), values);
}

}  // namespace

void add_help(CLI::App& app, Action& chosen) {
  auto* completion = app.add_subcommand("completion", "a script that completes camber's words in a shell");
  auto shell = std::make_shared<std::string>();
  completion->add_option("shell", *shell, "for which shell")
      ->required()
      ->check(CLI::IsMember({"bash"}).description(""))
      ->type_name("bash");
  completion->callback([shell, &app, &chosen] {
    chosen = [&app] {
      fmt::print("{}", completion_script(app));
      return kDone;
    };
  });
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    for (const auto& [name, example] : kExamples)
      if (command->get_name() == name) command->footer(fmt::format("Example:\n  {}", example));
}

}  // namespace camber::cli
