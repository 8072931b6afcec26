#include "ui/commands.h"

#include <algorithm>
#include <filesystem>
#include <functional>

#include <fmt/format.h>

namespace camber::ui {
namespace {

namespace fs = std::filesystem;

/// The kind of value that an option takes.
enum class Value { none, text, file };

struct RunKind {
  std::string_view name;
  std::string_view ending;  ///< of the new program's name; empty: it writes none
  std::vector<std::pair<std::string_view, Value>> options;
};

const std::vector<RunKind>& run_kinds() {
  static const std::vector<RunKind> kinds{
      {"predict", "", {{"meshes", Value::none}, {"trace", Value::file}}},
      {"compensate",
       "_compensated",
       {{"time-budget", Value::text},
        {"measured", Value::file},
        {"uncertainty", Value::text},
        {"keep-anyway", Value::none},
        {"header", Value::none}}},
      {"adapt", "_adapted", {{"time-limit", Value::text}, {"sweep", Value::none}, {"keep-anyway", Value::none}}},
      {"feed", "", {}},
      {"time", "", {{"trace", Value::file}, {"sweep", Value::text}}},
      {"compress",
       "_compressed",
       {{"tolerance-mm", Value::text}, {"lines-only", Value::none}, {"helices", Value::none}}},
      {"fit-feed", "", {{"trace", Value::file}, {"columns", Value::file}, {"update", Value::none}}}};
  return kinds;
}

const RunKind& kind_of(std::string_view name) {
  const auto found = std::ranges::find(run_kinds(), name, &RunKind::name);
  if (found == run_kinds().end()) throw Refused{400, fmt::format("there is no run {}", name)};
  return *found;
}

/// With the value behind an equals sign: it may begin with a minus. A command that does not know the option says so.
void add_options(Command& command, const Folder& folder, const RunKind& kind, const Options& options) {
  for (const auto& [name, value] : options) {
    const auto known = std::ranges::find(kind.options, name, [](const auto& o) { return o.first; });
    if (known == kind.options.end()) throw Refused{400, fmt::format("{} has no option {} here", kind.name, name)};
    if (known->second == Value::none) {
      command.arguments.push_back("--" + name);
    } else {
      if (known->second == Value::file) folder.file(value);
      command.arguments.push_back("--" + name + "=" + value);
    }
  }
}

const std::string& only_program(const JobSummary& job) {
  if (job.programs.size() != 1)
    throw Refused{400, fmt::format("{} has {} programs; one was expected", job.name, job.programs.size())};
  return job.programs.front();
}

std::string new_name(const std::string& program, std::string_view ending) {
  const fs::path path(program);
  return path.stem().string() + std::string(ending) + path.extension().string();
}

void add_machine(Command& command, const JobSummary& job) {
  command.arguments.insert(command.arguments.end(), {"--machine", job.machine});
  if (!job.units.empty()) command.arguments.insert(command.arguments.end(), {"--units", job.units});
}

/// compensate of a job with several programs writes into a folder.
void add_new_program(Command& command, const JobSummary& job, const RunKind& kind, const std::string& results) {
  const bool several = kind.name == "compensate" && job.programs.size() > 1;
  const std::string output = results + (several ? "/programs" : "/" + new_name(only_program(job), kind.ending));
  if (!several) command.program = output;
  command.arguments.insert(command.arguments.end(), {"-o", output});
}

}  // namespace

const std::vector<std::string>& run_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const RunKind& kind : run_kinds()) out.emplace_back(kind.name);
    return out;
  }();
  return names;
}

std::string results_of(std::string_view job, std::string_view command) {
  return results_of(job) + "/" + std::string(command);
}

Command run_command(const Folder& folder, const JobSummary& job, const std::string& name, const Options& options) {
  const RunKind& kind = kind_of(name);
  const std::string results = results_of(job.name, name);
  Command out{{name}, {}, results + "/report.html", results + "/figures.json"};
  if (name == "predict") {
    out.arguments.insert(out.arguments.end(), {job.name, "-o", results});
  } else if (name == "compensate" || name == "adapt") {
    out.arguments.push_back(job.name);
    add_new_program(out, job, kind, results);
  } else if (name == "fit-feed") {
    out.report.clear();
    out.arguments.insert(out.arguments.end(), {"--program", only_program(job), "-o", results + "/fitted_machine.toml"});
    add_machine(out, job);
  } else {
    out.arguments.push_back(only_program(job));
    if (name == "feed") {
      out.report.clear();
      out.arguments.insert(out.arguments.end(), {"-o", results + "/feed.csv"});
    }
    if (name == "compress") add_new_program(out, job, kind, results);
    add_machine(out, job);
  }
  if (!out.report.empty() && name != "predict") out.arguments.insert(out.arguments.end(), {"--report", out.report});
  out.arguments.insert(out.arguments.end(), {"--json", out.figures});
  add_options(out, folder, kind, options);
  return out;
}

Command check_command(const JobSummary& job, const std::string& scratch, const std::string& stem) {
  const std::string at = scratch + "/" + stem;
  return {{"check", "--job", job.name, "--json", at + ".json", "--sheet", at + ".html", "--path", at + ".path",
           "--meshes", at},
          {},
          at + ".html",
          at + ".json"};
}

Command check_program_command(const std::string& program, const Options& options, const std::string& scratch,
                              const std::string& stem) {
  const std::string at = scratch + "/" + stem;
  Command out{{"check", program, "--json", at + ".json", "--path", at + ".path"}, {}, {}, at + ".json"};
  if (const auto units = options.find("units"); units != options.end())
    out.arguments.push_back("--units=" + units->second);
  return out;
}

Command init_command(const Folder& folder, const std::string& program, const std::string& job, const Options& options) {
  Command out{{"init", program, "-o", job}};
  for (const char* name : {"machine", "material", "units", "tools"})
    if (const auto given = options.find(name); given != options.end() && !given->second.empty()) {
      const bool is_file =
          given->first == "tools" || (given->first == "machine" && !given->second.starts_with("preset:"));
      if (is_file) folder.file(given->second);
      out.arguments.push_back("--" + given->first + "=" + given->second);
    }
  return out;
}

Command read_command(const std::string& job) { return {{"predict", job, "-o", results_of(job), "--effective-config"}}; }

}  // namespace camber::ui
