#include "compensate/verify_program.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "compensate/header.h"
#include "compensate/safety.h"
#include "compensate/trial.h"
#include "machine/machine_presets.h"
#include "plausibility/plausibility.h"
#include "simulate/verdict.h"

namespace camber::compensate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::string_view kEnding = ".record.json";

/// Ranges of the lines that compensated moves stand in; nothing: all simulated moves were compensated.
std::optional<machine::Operations> judged_lines(const std::vector<LineRole>& lines) {
  if (std::ranges::find(lines, LineRole::only_simulated) == lines.end()) return std::nullopt;
  machine::Operations out;
  bool open = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int line = static_cast<int>(i) + 1;
    if (lines[i] == LineRole::only_simulated) open = false;
    if (lines[i] != LineRole::compensated) continue;
    if (open)
      out.blocks.back()[1] = line;
    else
      out.blocks.push_back({line, line});
    open = true;
  }
  return out;
}

std::vector<LineRun> runs_of(const CompensationResult& c) {
  std::vector<LineRun> out;
  if (c.emitted.block_of_line.empty()) return {{1, 1, c.emitted.blocks_before}};
  for (std::size_t i = 0; i < c.emitted.block_of_line.size(); ++i) {
    if (c.emitted.block_of_line[i] == nc::Emission::kNoBlock) continue;
    const std::size_t given = c.emitted.block_of_line[i] + 1;
    const bool goes_on =
        !out.empty() && out.back().emitted + out.back().count == i + 1 && out.back().given + out.back().count == given;
    if (goes_on)
      ++out.back().count;
    else
      out.push_back({i + 1, given, 1});
  }
  return out;
}

[[noreturn]] void fail_on_record(const std::string& path) {
  fail_on_file(path, "is not a record of camber compensate; the record beside an emitted program was expected",
               "record-format");
}

void check_text(const std::string& path, const std::string& hash, const char* since) {
  if (hash_of(SourceText::read(path).text()) == hash) return;
  fail_on_file(path,
               fmt::format("has changed since {}, so the record no longer matches its lines; the unchanged program, or "
                           "a new run of camber compensate, was expected",
                           since),
               "program-edited");
}

}  // namespace

std::string record_path(const std::string& program) { return program + std::string(kEnding); }

machine::Job judging_job(const machine::Job& job, const CompensationResult& c, const std::string& output) {
  machine::Job out = job;
  out.program = output;
  if (out.part.program.empty()) out.part.program = job.program;
  if (job.operations.given()) {
    if (!c.emitted.block_of_line.empty()) out.operations = moved_ranges(c.scope.operations, c.emitted.block_of_line);
    if (!out.part.operations) out.part.operations = job.operations;
  }
  if (c.scope.own_target)
    if (auto judged = judged_lines(c.scope.lines)) out.part.judged = std::move(judged);
  out.compensation.operations = {};
  const fs::path folder = fs::absolute(output).parent_path();
  for (std::string* path :
       {&out.program, &out.machine_path, &out.stock.mesh, &out.stock.vdb, &out.part.mesh, &out.part.program})
    if (!path->empty() && !machine::is_preset(*path))
      *path = fs::absolute(*path).lexically_normal().lexically_proximate(folder).string();
  return out;
}

Record make_record(const machine::Job& job, const CompensationResult& c, const std::string& output) {
  const machine::Job judging = judging_job(job, c, output);
  Record out;
  out.program = fs::path(output).filename().string();
  out.program_hash = hash_of(c.emitted.text);
  out.given =
      fs::absolute(job.program).lexically_normal().lexically_proximate(fs::absolute(output).parent_path()).string();
  out.given_hash = hash_of(SourceText::read(job.program).text());
  out.job = fmt::format("# Judges {} as camber compensate did: camber predict THIS_FILE -o DIR\n", out.program) +
            machine::to_toml(judging);
  out.depth_limit_um = c.safety.depth_limit_um;
  out.judged_um = c.figures.after_um;
  out.lines = runs_of(c);
  return out;
}

std::string record_json(const Record& r) {
  ordered_json lines = ordered_json::array();
  for (const LineRun& run : r.lines) lines.push_back({run.emitted, run.given, run.count});
  const ordered_json j = {
      {"record_version", kVersion},
      {"program", {{"file", r.program}, {"hash", r.program_hash}}},
      {"given", {{"file", r.given}, {"hash", r.given_hash}}},
      {"depth_limit_um", r.depth_limit_um},
      {"judged_um",
       {{"rms", r.judged_um.rms}, {"p95", r.judged_um.p95}, {"min", r.judged_um.min}, {"max", r.judged_um.max}}},
      {"job", r.job},
      {"lines", lines}};
  return j.dump() + "\n";
}

Record read_record(const std::string& path) {
  const SourceText text = SourceText::read(path);
  Record out;
  try {
    const auto j = nlohmann::json::parse(text.text());
    if (j.at("record_version") != kVersion) fail_on_record(path);
    out.program = j.at("program").at("file");
    out.program_hash = j.at("program").at("hash");
    out.given = j.at("given").at("file");
    out.given_hash = j.at("given").at("hash");
    out.depth_limit_um = j.at("depth_limit_um");
    const auto& judged = j.at("judged_um");
    out.judged_um.rms = judged.at("rms");
    out.judged_um.p95 = judged.at("p95");
    out.judged_um.min = judged.at("min");
    out.judged_um.max = judged.at("max");
    out.job = j.at("job");
    for (const auto& run : j.at("lines")) out.lines.push_back({run.at(0), run.at(1), run.at(2)});
  } catch (const nlohmann::json::exception&) {
    fail_on_record(path);
  }
  return out;
}

std::string find_record(const std::string& place) {
  std::error_code ec;
  if (!fs::exists(place, ec))
    fail_on_file(place, "no such folder or program; the folder of a program that camber compensate wrote was expected",
                 "file-missing");
  if (!fs::is_directory(place, ec)) {
    if (const std::string path = record_path(place); fs::exists(path, ec)) return path;
    fail_on_file(place, "has no record beside it; a program that camber compensate wrote was expected",
                 "record-missing");
  }
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(place, ec))
    if (entry.path().filename().string().ends_with(kEnding)) found.push_back(entry.path().string());
  std::ranges::sort(found);
  if (found.size() == 1) return found.front();
  if (found.empty())
    fail_on_file(place,
                 "has no record (*.record.json); the folder of a program that camber compensate wrote was expected",
                 "record-missing");
  for (std::string& path : found) path.resize(path.size() - kEnding.size());
  fail_on_file(
      place,
      fmt::format("has the records of {} programs; one of them was expected: {}", found.size(), fmt::join(found, ", ")),
      "record-several");
}

void check_record(const Record& record, const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  check_text((folder / record.program).string(), record.program_hash, "camber compensate wrote it");
  check_text((folder / record.given).lexically_normal().string(), record.given_hash, "it was compensated");
}

Verification verify(const machine::Job& job, const Record& record, Diagnostics& diagnostics,
                    const simulate::Progress& progress) {
  Diagnostics of_given;  // it was warned of when it was compensated
  const auto check = [&](const simulate::SimulatedProgram& emitted) {
    plausibility::check_program(job, emitted, diagnostics);
  };
  const simulate::Setup setup = simulate::set_up(job, {.check = check, .clearance = true},
                                                 {.program = diagnostics, .original = of_given, .target = diagnostics});
  simulate::check_clearance(job, setup, diagnostics);
  diagnostics.throw_if_errors();
  const simulate::Prediction p =
      simulate::predict_surface(setup.predictor, job, setup.target, setup.program, progress, "the emitted program");
  Verification out;
  out.doubts = simulate::doubts(job, setup.program, p);
  if (simulate::beyond_model(p)) throw BeyondModel(fmt::format("{}", fmt::join(out.doubts, "; ")));
  out.reference = job.compensation.reference;
  out.plain = plain_figures(p.surface, p.total_error_mm, {}, job.compensation);
  out.within_tolerance = within_tolerance(out.plain, job.compensation);
  out.depth_limit_um = record.depth_limit_um;
  out.depth = depth_of(p.surface, out.reference, p.not_judged_mm2, out.depth_limit_um);
  if (out.depth.stamp >= 0) {
    const auto& stamp = setup.program.path.stamps[static_cast<std::size_t>(out.depth.stamp)];
    const std::size_t line = setup.program.moves_in_part().moves[stamp.move].block + std::size_t{1};
    out.depth.line = {line, line};
  }
  out.within_part = out.depth.gouge_depth_p999_um <= out.depth_limit_um;
  out.settled = p.cut.unsettled == 0;
  out.unseen_mm2 = p.unseen_mm2;
  out.border_mm2 = p.border_mm2;
  out.not_judged_mm2 = p.not_judged_mm2;
  out.between = p.between;
  out.recorded_um = record.judged_um;
  out.machine_time_s = setup.program.feed.time_s;
  return out;
}

}  // namespace camber::compensate
