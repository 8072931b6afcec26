#include "camber/study.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "base/diagnostics.h"
#include "base/output_file.h"
#include "compensate/header.h"
#include "kinematics/control_options.h"
#include "kinematics/machine_program.h"
#include "machine/job_file.h"
#include "machine/study_file.h"
#include "machine/toml_text.h"
#include "nc/emit.h"
#include "nc/interpreter.h"
#include "report/study_table.h"

namespace camber {
namespace {

/// A case, ready for its command.
///
/// Its folder is named after a hash of all that the result depends on: version, command, job and the contents of the
/// files that the job reads. A case is done when its folder has the command's results, whoever ran the command.
struct PlannedCase {
  machine::StudyCase values;
  std::string hash;
  std::string folder;       ///< holds job.toml and, with other feeds, program.nc
  std::string job_path;     ///< job.toml
  std::string output;       ///< output of the command: a folder (predict) or a program
  std::string report_path;  ///< report.html
  std::string json_path;    ///< summary.json

  bool done() const {
    std::error_code ec;
    return std::filesystem::is_regular_file(json_path, ec) && std::filesystem::is_regular_file(report_path, ec);
  }
};

}  // namespace

struct Study::Impl {
  machine::Study study;
  std::string folder;  ///< folder of the whole study
  std::vector<PlannedCase> cases;
};

namespace {

namespace fs = std::filesystem;
using machine::StudyCommand;

std::string command_name(const machine::Study& study) {
  return std::string(machine::kStudyCommandWords[static_cast<std::size_t>(study.command)]);
}

std::string content_hash(const std::string& path, std::map<std::string, std::string>& known) {
  auto [at, is_new] = known.try_emplace(path);
  std::error_code ec;
  if (is_new && fs::is_regular_file(path, ec)) at->second = compensate::hash_of(SourceText::read(path).text());
  return at->second;
}

/// Hash of version, command, job and the contents of its files. Where the study lies does not count.
std::string case_hash(const machine::Study& study, const machine::StudyCase& one,
                      std::map<std::string, std::string>& known) {
  std::string all =
      fmt::format("camber {} {}\n{}\n{}\n", CAMBER_VERSION, command_name(study), machine::feed_percent(study, one),
                  machine::toml_text(machine::study_job(study, one, machine::kNamesAlone)));
  for (const std::string& path : machine::study_files(study, one)) all += content_hash(path, known) + "\n";
  std::string hash = compensate::hash_of(all);
  for (char& c : hash) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return hash;
}

/// In inverse time (G93) moves of rotary axes alone have a time and no feed along a path.
void warn_of_timed_turns(const machine::Job& job, const nc::Interpretation& moves, double percent,
                         Diagnostics& diagnostics) {
  const auto timed = [&](const nc::RotaryTarget& t) { return t.time_s > 0 && moves.moves[t.move].feed_mm_per_s <= 0; };
  const auto first = std::ranges::find_if(moves.rotary, timed);
  if (first == moves.rotary.end()) return;
  diagnostics.add({Severity::warning,
                   {job.program, moves.moves[first->move].block + 1, 0},
                   fmt::format("feed_percent = {}: the times (G93) of {} moves of rotary axes alone stay as programmed",
                               percent, std::ranges::count_if(moves.rotary, timed)),
                   "study-feed",
                   {}});
}

/// The program with all feeds of its cutting moves scaled. Warns of moves whose feed the text does not say alone.
std::string scaled_program(const machine::Job& job, double percent, Diagnostics& diagnostics) {
  Diagnostics ignored;  // said when the case itself is read
  const auto program =
      kinematics::open_program(SourceText::read(job.program), job.machine, kinematics::reading_of(job), ignored);
  ignored.throw_if_errors();
  const nc::Program& text = program.text();
  const nc::Interpretation& moves = program.commanded();
  std::vector<nc::MoveEdit> edits;
  for (std::uint32_t i = 0; i < moves.moves.size(); ++i) {
    const nc::Move& m = moves.moves[i];
    if ((m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc) && m.feed_mm_per_s > 0)
      edits.push_back({.move = i, .feed_mm_per_s = m.feed_mm_per_s * percent / 100});
  }
  warn_of_timed_turns(job, moves, percent, diagnostics);
  nc::Emission out = nc::emit_edits(text, moves, edits, kinematics::decimals_for(job.machine.control, text));
  if (!out.not_made.empty()) {
    const auto& first = out.not_made.front();
    diagnostics.add({Severity::warning,
                     {job.program, moves.moves[first.move].block + 1, 0},
                     fmt::format("feed_percent = {}: the feed of {} moves stays as programmed, the first is {}",
                                 percent, out.not_made.size(), nc::to_string(first.why)),
                     "study-feed",
                     {}});
  }
  return out.text;
}

/// Leaves a file that has this content already alone, with its time.
void write_if_new(const std::string& path, const std::string& content) {
  std::error_code ec;
  if (fs::is_regular_file(path, ec) && SourceText::read(path).text() == content) return;
  write_file(path, content);
}

std::string job_comment(const machine::Study& study, const PlannedCase& one) {
  std::string out = fmt::format("# A case of {}, made by camber study:\n", fs::path(study.path).filename().string());
  for (std::size_t k = 0; k < study.keys.size(); ++k)
    out +=
        fmt::format("# {} = {}\n", study.keys[k].key, machine::toml_value(study.keys[k].values[one.values.values[k]]));
  return out;
}

/// A case's folder is named by what it is made of, so files that are there are right.
void write_job(const machine::Study& study, const PlannedCase& one, Diagnostics& diagnostics) {
  make_folder(one.folder);
  const machine::TomlNode job = machine::study_job(study, one.values, one.folder);
  const std::string comment = job_comment(study, one);
  const double percent = machine::feed_percent(study, one.values);
  if (percent == 100) {
    write_if_new(one.job_path, comment + machine::toml_text(job));
    return;
  }
  machine::TomlNode name, own = job;
  name.kind = machine::TomlNode::Kind::text;
  name.text = "program.nc";
  machine::set_value(own, machine::key_parts("program"), name);
  const std::string text = comment + machine::toml_text(own), program = one.folder + "/" + name.text;
  std::error_code ec;
  if (fs::is_regular_file(program, ec) && fs::is_regular_file(one.job_path, ec) &&
      SourceText::read(one.job_path).text() == text)
    return;
  write_file(one.job_path, comment + machine::toml_text(job));
  Diagnostics of_job;
  const machine::Job read = machine::read_job(one.job_path, of_job);
  of_job.throw_if_errors();
  write_file(program, scaled_program(read, percent, diagnostics));
  write_file(one.job_path, text);
}

/// Whether the command could run at all.
void check_job(const machine::Study& study, const PlannedCase& one, Diagnostics& diagnostics) {
  Diagnostics found;
  const machine::Job job = machine::read_job(one.job_path, found);
  if (study.command == StudyCommand::adapt && !job.adapt && !found.has_errors())
    found.add({Severity::error,
               {one.job_path, 0, 0},
               "has no [adapt]; a table with limits was expected",
               "adapt-missing",
               {}});
  for (const Diagnostic& d : found.all())
    if (d.severity == Severity::error) diagnostics.add(d);
}

std::string shell_word(const std::string& text) {
  if (!text.empty() && text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=+") ==
                           std::string::npos)
    return text;
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Reads a study, writes the job of every case into `folder`, and reads them all: a wrong value is found before the
/// first case runs. Throws InputError.
Study::Impl plan_study(const std::string& path, const std::string& folder, Diagnostics& diagnostics) {
  Study::Impl out{machine::read_study(path, diagnostics), folder, {}};
  diagnostics.throw_if_errors();
  make_folder(folder);
  make_folder(folder + "/cases");
  std::map<std::string, std::string> known;
  std::map<std::string, std::size_t> numbers;
  for (std::size_t i = 0; i < out.study.cases(); ++i) {
    PlannedCase one;
    one.values = machine::study_case(out.study, i);
    one.hash = case_hash(out.study, one.values, known);
    if (const auto [first, is_new] = numbers.try_emplace(one.hash, i + 1); !is_new)
      fail_on_file(path,
                   fmt::format("cases {} and {} are the same; different values were expected", first->second, i + 1),
                   "study-twice");
    one.folder = folder + "/cases/" + one.hash;
    one.job_path = one.folder + "/job.toml";
    one.output = out.study.command == StudyCommand::predict ? one.folder : one.folder + "/new.nc";
    one.report_path = one.folder + "/report.html";
    one.json_path = one.folder + "/summary.json";
    write_job(out.study, one, diagnostics);
    check_job(out.study, one, diagnostics);
    out.cases.push_back(std::move(one));
  }
  diagnostics.throw_if_errors();
  return out;
}

std::string command_line(const Study::Impl& plan, const PlannedCase& one) {
  std::string command =
      fmt::format("camber -q {} {} -o {}", command_name(plan.study), shell_word(one.job_path), shell_word(one.output));
  if (plan.study.command == StudyCommand::predict) return command;
  return command + fmt::format(" --report {} --json {}", shell_word(one.report_path), shell_word(one.json_path));
}

report::StudyTable table_of(const Study::Impl& plan) {
  report::StudyTable out{plan.study.path, plan.study.job, command_name(plan.study), {}, plan.study.figures, {}};
  if (out.figures.empty()) out.figures = report::default_study_figures(out.command);
  for (const machine::StudyKey& key : plan.study.keys) out.keys.push_back(key.key);
  for (const PlannedCase& one : plan.cases) {
    report::StudyRow& row = out.rows.emplace_back();
    row.number = out.rows.size();
    row.hash = one.hash;
    row.folder = "cases/" + one.hash;
    row.figures.assign(out.figures.size(), "");
    for (std::size_t k = 0; k < plan.study.keys.size(); ++k)
      row.values.push_back(machine::shown_value(plan.study.keys[k].values[one.values.values[k]]));
    if (one.done()) report::read_figures(SourceText::read(one.json_path).text(), out.figures, row);
  }
  return out;
}

StudyCase case_of(const Study::Impl& plan, const PlannedCase& one) {
  return {.hash = one.hash,
          .job_path = one.job_path,
          .folder = one.folder,
          .output = one.output == one.folder ? "" : one.output,
          .report = one.report_path,
          .json = one.json_path,
          .command_line = command_line(plan, one)};
}

}  // namespace

void Study::read_results() {
  const report::StudyTable table = table_of(*impl);
  csv = report::study_csv(table);
  json = report::study_json(table);
  page = report::study_page(table);
  printed = report::study_text(table);
  doubtful = table.count(report::StudyState::doubtful);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    cases[i].values = table.rows[i].values;
    cases[i].done = impl->cases[i].done();
  }
}

Study v0::open_study(const std::string& path, const std::string& folder) {
  Diagnostics found;
  auto impl = std::make_shared<Study::Impl>(plan_study(path, folder, found));
  Study out{.command = command_name(impl->study), .diagnostics = found.all()};
  for (const machine::StudyKey& key : impl->study.keys) out.keys.push_back(key.key);
  for (const PlannedCase& one : impl->cases) out.cases.push_back(case_of(*impl, one));
  out.impl = std::move(impl);
  out.read_results();
  return out;
}

}  // namespace camber
