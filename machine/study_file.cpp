#include "machine/study_file.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "machine/toml_text.h"

namespace camber::machine {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxCases = 100000;
constexpr NumberRange kFeedPercent{.min = 1, .max = 1000};

/// Keys of a job that are paths of files.
constexpr std::string_view kFileKeys[] = {"program",    "machine",   "tools",     "material.file",
                                          "stock.mesh", "stock.vdb", "part.mesh", "part.program"};

bool is_file_key(std::string_view key) { return std::ranges::find(kFileKeys, key) != std::end(kFileKeys); }

void check_feeds(TomlTable& grid, const StudyKey& key) {
  for (const TomlNode& value : key.values)
    if (value.kind != TomlNode::Kind::number || !kFeedPercent.holds(value.number))
      return grid.error_at(key.key,
                           fmt::format("{} = {}: {} was expected", key.key, toml_value(value), kFeedPercent.wanted()),
                           "value-range");
}

/// Tables of the grid are walked through; arrays are the values of their key.
void read_grid(TomlTable grid, const TomlNode& node, const std::string& prefix, Study& study) {
  std::vector<const TomlNode::Entry*> entries;
  for (const auto& e : node.entries) entries.push_back(&e);
  std::ranges::stable_sort(entries, {}, &TomlNode::Entry::key_offset);
  for (const TomlNode::Entry* e : entries) {
    const std::string key = prefix + e->key;
    if (e->value.kind == TomlNode::Kind::table) {
      if (auto inner = grid.table(e->key)) read_grid(*inner, e->value, key + ".", study);
      continue;
    }
    grid.ignore(e->key);
    if (e->value.kind != TomlNode::Kind::array || e->value.items.empty()) {
      grid.error_at(e->key,
                    fmt::format("{} = {}: a list of one or more values was expected", key, toml_value(e->value)),
                    "study-values");
      continue;
    }
    study.keys.push_back({key, e->value.items, grid.place_of(e->key)});
    if (key == kFeedPercentKey) check_feeds(grid, study.keys.back());
  }
}

/// The path of a file key as it lies from `folder`.
std::string from_folder(const fs::path& base, const std::string& given, const std::string& folder) {
  if (folder == kNamesAlone) return fs::path(given).filename().string();
  if (fs::path(given).is_absolute()) return given;
  const fs::path absolute = fs::absolute(base / given).lexically_normal();
  return folder.empty() ? absolute.string()
                        : absolute.lexically_relative(fs::absolute(folder).lexically_normal()).string();
}

/// Paths of a value, which is set at `key`, are counted from `base`.
void move_paths(TomlNode& value, const std::string& key, const fs::path& base, const std::string& folder) {
  if (value.kind == TomlNode::Kind::table)
    for (auto& e : value.entries) move_paths(e.value, (key.empty() ? "" : key + ".") + e.key, base, folder);
  else if (value.kind == TomlNode::Kind::text && is_file_key(key))
    value.text = from_folder(base, value.text, folder);
}

void check_keys(const Study& study, Diagnostics& diagnostics) {
  std::size_t cases = 1;
  for (const StudyKey& key : study.keys) {
    cases *= key.values.size();
    Diagnostic problem = key.place;
    if (cases > kMaxCases) {
      problem.message = fmt::format("the grid has more than {} cases; fewer values were expected", kMaxCases);
      problem.check = "study-size";
      return diagnostics.add(problem);
    }
    if (key.key == kFeedPercentKey) continue;
    TomlNode job = study.base;
    for (const TomlNode& value : key.values)
      if (!set_value(job, key_parts(key.key), value)) {
        problem.message =
            fmt::format("{}: the job has no table for this key; a dotted key of {} was expected", key.key, study.job);
        problem.check = "study-key";
        diagnostics.add(problem);
        break;
      }
  }
}

}  // namespace

std::size_t Study::cases() const {
  std::size_t out = 1;
  for (const StudyKey& key : keys) out *= key.values.size();
  return out;
}

StudyCase study_case(const Study& study, std::size_t index) {
  StudyCase out;
  out.values.resize(study.keys.size());
  for (std::size_t k = study.keys.size(); k-- > 0;) {
    const std::size_t count = study.keys[k].values.size();
    out.values[k] = index % count;
    index /= count;
  }
  return out;
}

std::string shown_value(const TomlNode& value) {
  return value.kind == TomlNode::Kind::text ? value.text : toml_value(value);
}

Study read_study(const std::string& path, Diagnostics& diagnostics) {
  Study out;
  out.path = path;
  const auto file = read_toml(path, "a study (job, [grid])", diagnostics);
  if (diagnostics.has_errors()) return out;
  TomlTable top = TomlTable::top(*file, diagnostics);
  const fs::path folder = fs::path(path).parent_path();
  const std::string job = top.required_text("job");
  out.job = (folder / job).lexically_normal().string();
  out.command = static_cast<StudyCommand>(top.choice("command", kStudyCommandWords, 0));
  out.figures =
      top.text_list("figures", "a list of names from the command's JSON").value_or(std::vector<std::string>());
  if (auto grid = top.table("grid"))
    read_grid(*grid, *value_at(file->root, key_parts("grid")), "", out);
  else if (!top.has("grid"))
    top.missing("grid", "a table of keys of the job, each with a list of values");
  top.finish();
  if (diagnostics.has_errors()) return out;
  std::error_code ec;
  if (!fs::is_regular_file(out.job, ec)) {
    top.error_at("job", fmt::format("job: no such file: {} (paths are relative to the study's folder)", out.job),
                 "file-missing");
    return out;
  }
  out.base =
      read_toml(out.job, "a job description (program, machine, [tool.1], [material], [stock] ...)", diagnostics)->root;
  if (!diagnostics.has_errors()) check_keys(out, diagnostics);
  return out;
}

TomlNode study_job(const Study& study, const StudyCase& one, const std::string& folder) {
  TomlNode job = study.base;
  move_paths(job, "", fs::path(study.job).parent_path(), folder);
  for (std::size_t k = 0; k < study.keys.size(); ++k) {
    const StudyKey& key = study.keys[k];
    if (key.key == kFeedPercentKey) continue;
    TomlNode value = key.values[one.values[k]];
    move_paths(value, key.key, fs::path(study.path).parent_path(), folder);
    set_value(job, key_parts(key.key), value);
  }
  return job;
}

std::vector<std::string> study_files(const Study& study, const StudyCase& one) {
  const TomlNode job = study_job(study, one, "");
  std::vector<std::string> out;
  for (const std::string_view key : kFileKeys)
    if (const TomlNode* value = value_at(job, key_parts(key)); value && value->kind == TomlNode::Kind::text)
      out.push_back(value->text);
  return out;
}

double feed_percent(const Study& study, const StudyCase& one) {
  for (std::size_t k = 0; k < study.keys.size(); ++k)
    if (study.keys[k].key == kFeedPercentKey) return study.keys[k].values[one.values[k]].number;
  return 100;
}

}  // namespace camber::machine
