#include "ui/bench.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "base/output_file.h"
#include "camber/presets.h"
#include "camber/run.h"

namespace camber::ui {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json machines_json() {
  json out = json::array();
  for (const MachinePreset& m : machine_presets()) out.push_back({{"name", "preset:" + m.name}, {"what", m.what}});
  return out;
}

json materials_json() {
  json out = json::array();
  for (const MaterialPreset& m : material_presets()) {
    json coefficients = json::array();
    for (const PresetCoefficient& c : m.coefficients)
      coefficients.push_back({{"key", c.key}, {"unit", c.unit}, {"value", c.value}, {"low", c.low}, {"high", c.high}});
    out.push_back({{"name", m.name},
                   {"what", m.what},
                   {"source", m.source},
                   {"range", m.range},
                   {"names", m.names},
                   {"hardness_HB", m.hardness_HB},
                   {"scatter_percent", m.scatter_percent},
                   {"coefficients", coefficients}});
  }
  return out;
}

json field_json(const JobField& f) {
  return {{"table", f.table}, {"key", f.key},   {"value", f.value},           {"comment", f.comment},
          {"note", f.note},   {"line", f.line}, {"is_default", f.is_default}, {"guessed", f.guessed}};
}

/// A JSON file of the folder; null where there is none.
json read_json(const Folder& folder, const std::string& name) {
  try {
    return json::parse(folder.text(name), nullptr, false);
  } catch (const Refused&) {
    return nullptr;
  }
}

/// The first line of a file of arrays; {}: there is none.
json path_head(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::getline(file, line);
  const json out = json::parse(line, nullptr, false);
  return out.is_object() ? out : json::object();
}

/// Single figures and those of one group: what a table of jobs has room for.
json short_figures(const json& figures) {
  json out = json::object();
  for (const auto& [key, value] : figures.items()) {
    if (value.is_primitive()) out[key] = value;
    if (!value.is_object()) continue;
    for (const auto& [name, number] : value.items())
      if (number.is_primitive()) out[key][name] = number;
  }
  return out;
}

/// Lists the results of each command of a job: record, figures and files.
json results_json(const Folder& folder, const std::string& job) {
  json out = json::array();
  for (const std::string& command : run_names()) {
    const std::string at = results_of(job, command);
    json record = read_json(folder, at + "/run.json");
    if (!record.is_object()) continue;
    json files = json::array();
    for (const std::string& file : folder.files_beside(at + "/run.json"))
      if (file != "run.json") files.push_back(at + "/" + file);
    const json figures = read_json(folder, at + "/figures.json");
    out.push_back({{"command", command},
                   {"run", std::move(record)},
                   {"figures", figures.is_object() ? short_figures(figures) : json(nullptr)},
                   {"files", std::move(files)}});
  }
  return out;
}

std::vector<JobEdit> edits_of(std::string_view text) {
  const std::map<std::string_view, JobEdit::Kind> kinds{
      {"set", JobEdit::Kind::set}, {"remove", JobEdit::Kind::remove}, {"confirm", JobEdit::Kind::confirm}};
  std::vector<JobEdit> out;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    std::vector<std::string> cells;
    for (std::size_t end = 0; end != std::string_view::npos; line.remove_prefix(end == line.npos ? 0 : end + 1)) {
      end = cells.size() < 3 ? line.find('\t') : std::string_view::npos;
      cells.emplace_back(line.substr(0, end));
    }
    const auto kind = kinds.find(cells[0]);
    const bool set = kind != kinds.end() && kind->second == JobEdit::Kind::set;
    if (kind == kinds.end() || cells.size() != (set ? 4u : 3u))
      throw Refused{400, fmt::format("\"{}\" is no edit", cells[0])};
    out.push_back({kind->second, cells[1], cells[2], set ? cells[3] : ""});
  }
  return out;
}

/// The messages of a check speak of the file that is checked; the user knows the job.
void rename_file(json& messages, const std::string& from, const std::string& to) {
  for (json& m : messages)
    if (m.value("file", "") == from) m["file"] = to;
}

}  // namespace

Bench::Bench(const Folder& folder, std::string executable, std::function<void()> changed)
    : folder_(folder), executable_(std::move(executable)), runs_(executable_, folder, std::move(changed)) {
  std::error_code ec;
  if (fs::is_directory(folder.place(".camber"), ec)) fs::remove_all(folder.place(".camber"), ec);
}

Bench::~Bench() {
  const std::lock_guard lock(mutex_);
  for (auto& [key, process] : going_on_) process->stop();
}

json Bench::about() const {
  return {{"version", version()},
          {"folder", folder_.path()},
          {"commands", run_names()},
          {"machines", machines_json()},
          {"materials", materials_json()}};
}

json Bench::jobs() const {
  json out = json::array();
  for (const std::string& name : folder_.jobs()) {
    const JobSummary job = job_summary(folder_, name);
    out.push_back({{"job", name}, {"programs", job.programs}, {"results", results_json(folder_, name)}});
  }
  return out;
}

json Bench::job(const std::string& name) const {
  const JobSummary job = job_summary(folder_, name);
  json fields = json::array();
  for (const JobField& f : job.fields) fields.push_back(field_json(f));
  return {{"job", name},
          {"text", folder_.text(name)},
          {"programs", job.programs},
          {"machine", job.machine},
          {"fields", std::move(fields)},
          {"files", folder_.files_beside(name)},
          {"results", results_json(folder_, name)}};
}

std::string Bench::next_stem() {
  const std::lock_guard lock(mutex_);
  return fmt::format("check-{}", ++last_stem_);
}

Bench::Outcome Bench::do_now(const Command& command, const std::string& key) {
  const auto process = std::make_shared<Process>(command_line(executable_, command), folder_.path());
  if (!key.empty()) {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<Process>& before = going_on_[key];
    if (before) before->stop();
    before = process;
  }
  Outcome out;
  out.ended = process->wait([&](std::string_view line) { take_event(line, out.messages); });
  const std::lock_guard lock(mutex_);
  if (const auto mine = going_on_.find(key); mine != going_on_.end() && mine->second == process) going_on_.erase(mine);
  return out;
}

json Bench::begin(const std::string& program, const Options& options) {
  const std::string job = folder_of(program) + "job.toml";
  const Outcome made = do_now(init_command(folder_, program, job, options));
  return {
      {"program", program}, {"job", made.ended.status == 0 ? json(job) : json(nullptr)}, {"messages", made.messages}};
}

json Bench::init(const std::string& job, const Options& options) {
  const JobSummary old = job_summary(folder_, job);
  if (old.programs.empty()) throw Refused{400, job + " names no program"};
  const std::string proposal = folder_of(job) + fmt::format("proposal-{}.toml", next_stem());
  const std::string path = folder_.place(proposal);
  const Outcome made = do_now(init_command(folder_, old.programs.front(), proposal, options));
  std::error_code ec, removal;
  if (made.ended.status == 0) fs::rename(path, folder_.place(job), ec);
  fs::remove(path, removal);
  if (ec) throw Refused{500, fmt::format("{} cannot be written: {}", job, ec.message())};
  if (made.ended.status != 0) return {{"job", nullptr}, {"messages", made.messages}};
  json out = this->job(job);
  out["messages"] = made.messages;
  return out;
}

json Bench::save(const std::string& job, const std::string& text) {
  const std::string draft = folder_of(job) + fmt::format("draft-{}.toml", next_stem());
  folder_.write(draft, text);
  Outcome read;
  std::error_code ec;
  try {
    read = do_now(read_command(draft));
  } catch (...) {
    fs::remove(folder_.place(draft), ec);
    throw;
  }
  rename_file(read.messages, draft, job);
  if (read.ended.status != 0) {
    fs::remove(folder_.place(draft), ec);
    return {{"saved", false}, {"messages", read.messages}};
  }
  fs::rename(folder_.place(draft), folder_.place(job), ec);
  if (ec) {
    std::error_code removal;
    fs::remove(folder_.place(draft), removal);
    throw Refused{500, fmt::format("{} cannot be written: {}", job, ec.message())};
  }
  json out = this->job(job);
  out["saved"] = true, out["messages"] = read.messages;
  return out;
}

json Bench::edit(const std::string& job, const std::string& edits) {
  const std::lock_guard lock(saving_);
  return save(job, with_edits(folder_.text(job), edits_of(edits)));
}

json Bench::replace(const std::string& job, const std::string& text) {
  const std::lock_guard lock(saving_);
  folder_.file(job);
  return save(job, text);
}

json Bench::checked(const Command& command, const std::string& stem, const std::string& key) {
  const Outcome done = do_now(command, key);
  const auto there = [&](const std::string& name) -> json {
    std::error_code ec;
    return fs::exists(folder_.place(name), ec) ? json(name) : json(nullptr);
  };
  const std::string at = folder_.scratch() + "/" + stem;
  return {{"status", done.ended.status},
          {"stopped", done.ended.stopped},
          {"signal", done.ended.signal},
          {"messages", done.messages},
          {"figures", read_json(folder_, command.figures)},
          {"path", there(at + ".path")},
          {"path_in_part", path_head(folder_.place(at + ".path")).value("in_part", false)},
          {"part", there(at + "-part.stl")},
          {"blank", there(at + "-blank.stl")},
          {"sheet", there(at + ".html")}};
}

json Bench::check(const std::string& job) {
  const std::string stem = next_stem();
  return checked(check_command(job_summary(folder_, job), folder_.scratch(), stem), stem, job);
}

json Bench::check_program(const std::string& program, const Options& options) {
  folder_.file(program);
  const std::string stem = next_stem();
  return checked(check_program_command(program, options, folder_.scratch(), stem), stem, program);
}

json Bench::run(const std::string& job, const std::string& command, const Options& options) {
  const int id = runs_.add(job, command, run_command(folder_, job_summary(folder_, job), command, options));
  return {{"run", id}};
}

json Bench::runs() const {
  json out = json::array();
  for (const CommandRun& run : runs_.all()) out.push_back(json_of(run, false));
  return out;
}

json Bench::run(int id) const {
  const auto run = runs_.find(id);
  if (!run) throw Refused{404, fmt::format("there is no run {}", id)};
  return json_of(*run, true);
}

json Bench::cancel(int id) {
  if (!runs_.cancel(id)) throw Refused{409, fmt::format("run {} does not go on", id)};
  return {{"run", id}};
}

json Bench::difference(const std::string& before, const std::string& after) const {
  json out = json::array();
  for (const Hunk& h : ui::difference(folder_.text(before), folder_.text(after)))
    out.push_back({h.before, h.before_lines, h.after, h.after_lines});
  return out;
}

}  // namespace camber::ui
