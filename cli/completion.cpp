#include "cli/command_line.h"

#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace camber::cli {
namespace {

struct Choice {
  std::vector<std::string> names;  ///< "-o", "--output"
  std::string about;
  std::string values;     ///< "mm inch"; empty where any word or file may follow
  bool has_value = true;  ///< false for flags
};

struct Command {
  std::string name, about;
  std::vector<Choice> choices;
  std::string values;  ///< of what it takes without a name
};

/// "mm|inch" as words; nothing for other types.
std::string words_of(const CLI::Option& option) {
  std::string type = option.get_type_name();
  if (type.find('|') == std::string::npos || type.find_first_of(" :[=") != std::string::npos) return {};
  for (char& c : type) {
    if (c == '|') c = ' ';
    if (c == '.' || (c >= 'A' && c <= 'Z')) return {};  // FILE|PERCENT
  }
  return type;
}

Command command_of(const CLI::App& app) {
  Command out{app.get_name(), app.get_description(), {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    Choice choice{{}, option->get_description(), words_of(*option), option->get_items_expected_max() > 0};
    for (const auto& name : option->get_snames()) choice.names.push_back("-" + name);
    for (const auto& name : option->get_lnames()) choice.names.push_back("--" + name);
    if (choice.names.empty())
      out.values = choice.values;
    else
      out.choices.push_back(std::move(choice));
  }
  return out;
}

std::vector<Command> commands_of(const CLI::App& app) {
  std::vector<Command> out;
  for (const CLI::App* sub : app.get_subcommands({})) out.push_back(command_of(*sub));
  return out;
}

std::string joined(const std::vector<std::string>& words, const char* between = " ") {
  return fmt::format("{}", fmt::join(words, between));
}

std::string names_of(const std::vector<Command>& commands, const char* between = " ") {
  std::vector<std::string> names;
  for (const auto& c : commands) names.push_back(c.name);
  return joined(names, between);
}

std::string options_of(const Command& command) {
  std::vector<std::string> names;
  for (const auto& c : command.choices) names.insert(names.end(), c.names.begin(), c.names.end());
  return joined(names);
}

/// Returns the text in single quotes, as all three shells take it.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

/// One case a place where only certain words may stand; `offer` is how the shell is given them.
template <class Offer>
std::string value_cases(const std::vector<Command>& commands, Offer offer) {
  std::string out;
  for (const auto& command : commands) {
    for (const auto& choice : command.choices)
      if (!choice.values.empty())
        for (const auto& name : choice.names)
          out += fmt::format("    {}:{}) {}; return ;;\n", command.name, name, offer(choice.values));
    if (!command.values.empty())
      out += fmt::format("    {0}:{0}) {1}; return ;;\n", command.name, offer(command.values));
  }
  return out;
}

std::string bash_script(const Command& all, const std::vector<Command>& commands) {
  std::string cases;
  for (const auto& c : commands) cases += fmt::format("    {}) words=\"{}\" ;;\n", c.name, options_of(c));
  const std::string values = value_cases(commands, [](const std::string& words) {
    return fmt::format("COMPREPLY=($(compgen -W \"{}\" -- \"$current\"))", words);
  });
  return fmt::format(R"(# Completion of camber for bash; made by camber completion bash.
_camber() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" previous="${{COMP_WORDS[COMP_CWORD-1]}}" command="" words="" word
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case " {0} " in *" $word "*) command="$word"; break ;; esac
  done
  case "$command:$previous" in
{3}  esac
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
                     names_of(commands), cases, options_of(all), values);
}

std::string zsh_script(const Command& all, const std::vector<Command>& commands) {
  std::string cases, described;
  for (const auto& c : commands) {
    cases += fmt::format("    {}) options=({}) ;;\n", c.name, options_of(c));
    described += fmt::format("    {}\n", quoted(c.name + ":" + c.about));
  }
  const std::string values =
      value_cases(commands, [](const std::string& words) { return fmt::format("compadd -- {}", words); });
  return fmt::format(R"(#compdef camber
# Completion of camber for zsh; made by camber completion zsh.
_camber() {{
  local command="" word
  local -a options commands
  commands=(
{1}  )
  for word in ${{words[2,CURRENT-1]}}; do
    case $word in {0}) command=$word; break ;; esac
  done
  case "$command:${{words[CURRENT-1]}}" in
{4}  esac
  case $command in
{2}  esac
  if [[ ${{words[CURRENT]}} == -* ]]; then compadd -- $options {3}
  elif [[ -z $command ]]; then _describe 'command' commands
  else _files; fi
}}
if [[ $funcstack[1] == _camber ]]; then _camber "$@"; else compdef _camber camber; fi
)",
                     names_of(commands, "|"), described, cases, options_of(all), values);
}

std::string fish_option(const std::string& when, const Choice& choice) {
  std::string out = "complete -c camber" + (when.empty() ? when : " -n " + quoted(when));
  for (const auto& name : choice.names)
    out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!choice.values.empty())
    out += " -x -a " + quoted(choice.values);
  else if (choice.has_value)
    out += " -r";
  return out + " -d " + quoted(choice.about) + "\n";
}

std::string fish_script(const Command& all, const std::vector<Command>& commands) {
  std::string out = "# Completion of camber for fish; made by camber completion fish.\n";
  const std::string none = "not __fish_seen_subcommand_from " + names_of(commands);
  for (const auto& c : commands)
    out += fmt::format("complete -c camber -f -n {} -a {} -d {}\n", quoted(none), c.name, quoted(c.about));
  for (const Choice& choice : all.choices) out += fish_option({}, choice);
  for (const auto& c : commands) {
    const std::string when = "__fish_seen_subcommand_from " + c.name;
    for (const Choice& choice : c.choices) out += fish_option(when, choice);
    if (!c.values.empty()) out += fmt::format("complete -c camber -f -n {} -a {}\n", quoted(when), quoted(c.values));
  }
  return out;
}

}  // namespace

std::string completion_script(const CLI::App& app, const std::string& shell) {
  const Command all = command_of(app);
  const std::vector<Command> commands = commands_of(app);
  if (shell == "zsh") return zsh_script(all, commands);
  return shell == "fish" ? fish_script(all, commands) : bash_script(all, commands);
}

}  // namespace camber::cli
