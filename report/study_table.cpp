#include "report/study_table.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/numbers.h"
#include "report/figures_json.h"

namespace camber::report {

using nlohmann::json;
using nlohmann::ordered_json;

namespace {

/// The member of `node` that one part of a dotted path names; null where there is none.
const json* study_member(const json& node, const std::string& part) {
  if (node.is_object()) {
    const auto found = node.find(part);
    return found == node.end() ? nullptr : &*found;
  }
  if (!node.is_array()) return nullptr;
  if (const auto number = parse_number(part); number && *number >= 0 && *number < static_cast<double>(node.size()))
    return &node[static_cast<std::size_t>(*number)];
  for (const json& one : node)
    if (one.is_object() && one.value("name", "") == part) return &one;
  return nullptr;
}

const json* study_figure(const json& root, const std::string& path) {
  const json* node = &root;
  for (std::size_t at = 0; node != nullptr && at <= path.size();) {
    const std::size_t dot = std::min(path.find('.', at), path.size());
    node = study_member(*node, path.substr(at, dot - at));
    at = dot + 1;
  }
  return node;
}

std::string study_cell(const json* value) {
  if (value == nullptr || value->is_null()) return {};
  if (value->is_string()) return value->get<std::string>();
  if (value->is_number_float()) return fmt::format("{:.6g}", value->get<double>());
  return value->dump();
}

bool has_doubts(const json& root) {
  if (const auto doubts = root.find("doubts"); doubts != root.end() && !doubts->empty()) return true;
  for (const char* key : {"within_limits", "within_time"})
    if (const auto found = root.find(key); found != root.end() && *found == false) return true;
  const json* success = study_figure(root, "verdict.success");
  return success != nullptr && *success == false;
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// Numbers and words keep their kind.
json typed(const std::string& text) {
  if (text.empty()) return nullptr;
  if (const auto number = parse_number(text)) return *number;
  return text;
}

std::vector<std::string> cells_of(const StudyRow& row) {
  std::vector<std::string> out{fmt::format("{}", row.number)};
  out.insert(out.end(), row.values.begin(), row.values.end());
  out.emplace_back(to_string(row.state));
  out.insert(out.end(), row.figures.begin(), row.figures.end());
  return out;
}

}  // namespace

std::string_view to_string(StudyState state) {
  switch (state) {
    case StudyState::open:
      return "open";
    case StudyState::done:
      return "done";
    case StudyState::doubtful:
      break;
  }
  return "doubtful";
}

std::size_t StudyTable::count(StudyState state) const {
  return static_cast<std::size_t>(std::ranges::count(rows, state, &StudyRow::state));
}

std::vector<std::string> default_study_figures(std::string_view command) {
  if (command == "compensate")
    return {"before_um.p95", "after_um.p95", "max_shift_um", "blocks.changed", "machine_time_s.after", "stop"};
  if (command == "adapt")
    return {"time_before_s", "time_after_s", "constant_feed.time_s", "loads.0.max_after", "over_limit_blocks"};
  return {"machine_time_s",    "force_N.max",       "form_error_um.p95",
          "form_error_um.min", "form_error_um.max", "deflection_um.p95"};
}

void read_figures(const std::string& text, const std::vector<std::string>& figures, StudyRow& row) {
  row.figures.assign(figures.size(), "");
  const json root = json::parse(text, nullptr, false);
  if (!root.is_object()) return;
  row.state = has_doubts(root) ? StudyState::doubtful : StudyState::done;
  for (std::size_t i = 0; i < figures.size(); ++i) row.figures[i] = study_cell(study_figure(root, figures[i]));
}

std::string study_csv(const StudyTable& table) {
  std::string out = "case,hash,state";
  for (const auto* names : {&table.keys, &table.figures})
    for (const std::string& name : *names) out += "," + csv_cell(name);
  for (const StudyRow& row : table.rows) {
    out += fmt::format("\n{},{},{}", row.number, row.hash, to_string(row.state));
    for (const auto* cells : {&row.values, &row.figures})
      for (const std::string& cell : *cells) out += "," + csv_cell(cell);
  }
  return out + "\n";
}

std::string study_json(const StudyTable& table) {
  ordered_json j;
  j["schema_version"] = kSchemaVersion;
  j["study"] = table.study;
  j["job"] = table.job;
  j["command"] = table.command;
  j["keys"] = table.keys;
  j["figures"] = table.figures;
  j["cases"] = ordered_json::array();
  for (const StudyRow& row : table.rows) {
    ordered_json values = ordered_json::object(), figures = ordered_json::object();
    for (std::size_t k = 0; k < table.keys.size(); ++k) values[table.keys[k]] = typed(row.values[k]);
    for (std::size_t k = 0; k < table.figures.size(); ++k) figures[table.figures[k]] = typed(row.figures[k]);
    j["cases"].push_back({{"case", row.number},
                          {"hash", row.hash},
                          {"folder", row.folder},
                          {"state", to_string(row.state)},
                          {"values", values},
                          {"results", figures}});
  }
  j["open"] = table.count(StudyState::open);
  j["doubtful"] = table.count(StudyState::doubtful);
  return j.dump(2) + "\n";
}

std::string study_text(const StudyTable& table) {
  std::vector<std::vector<std::string>> lines{{"case"}};
  lines[0].insert(lines[0].end(), table.keys.begin(), table.keys.end());
  lines[0].emplace_back("state");
  lines[0].insert(lines[0].end(), table.figures.begin(), table.figures.end());
  for (const StudyRow& row : table.rows) lines.push_back(cells_of(row));
  std::vector<std::size_t> width(lines[0].size(), 0);
  for (const auto& line : lines)
    for (std::size_t c = 0; c < line.size(); ++c) width[c] = std::max(width[c], line[c].size());
  std::string out;
  for (const auto& line : lines) {
    std::string text;
    for (std::size_t c = 0; c < line.size(); ++c)
      text += fmt::format("{}{:>{}}", c == 0 ? "" : "  ", line[c], width[c]);
    out += text + "\n";
  }
  return out + fmt::format("{} cases: {} done, {} doubtful, {} open\n", table.rows.size(),
                           table.count(StudyState::done), table.count(StudyState::doubtful),
                           table.count(StudyState::open));
}

}  // namespace camber::report
