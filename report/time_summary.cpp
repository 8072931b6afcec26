#include "report/time_summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "base/units.h"

namespace camber::report {
namespace {

using calib::TimePair;
using feedmodel::CycleTime;
using feedmodel::CycleUse;
using feedmodel::kCycleKinds;

constexpr std::size_t kMaxPartsShown = 8;

// --- text ------------------------------------------------------------------------------------------------------

std::string kinds_text(const CycleTime& time) {
  const double total = time.all.time.total_s();
  std::string out;
  for (const auto& kind : kCycleKinds) {
    const double s = time.all.time.*kind.field;
    if (s == 0 && (kind.field == &feedmodel::CycleSplit::index_s || kind.field == &feedmodel::CycleSplit::pallet_s))
      continue;
    out += fmt::format("{:<14} {:>10.1f} s {:>6.1f} %\n", kind.name, s, total > 0 ? 100 * s / total : 0);
  }
  return out + fmt::format("{:<14} {:>10.1f} s\n", "total", total);
}

std::string head(const std::string& first) {
  return fmt::format("\n{} {:>9} {:>11} {:>8} {:>7} {:>7} {:>7} {:>9} {:>9} {:>9} {:>6} {:>7}\n", first, "cutting s",
                     "position. s", "spindle s", "tool s", "codes s", "dwell s", "total s", "F mm/min", "actual", "e",
                     "k");
}

/// Index table and pallet stand with the codes here: a line has only so much room.
std::string use_columns(const CycleUse& use) {
  const auto& t = use.time;
  return fmt::format(
      " {:>9.1f} {:>11.1f} {:>9.1f} {:>7.1f} {:>7.1f} {:>7.1f} {:>9.1f} {:>9.0f} {:>9.0f} {:>6.3f} {:>7.3f}",
      t.cutting_s, t.positioning_s, t.spindle_s, t.tool_change_s, t.m_code_s + t.index_s + t.pallet_s, t.dwell_s,
      t.total_s(), mm_per_min_from_mm_per_s(use.commanded_feed_mm_per_s()),
      mm_per_min_from_mm_per_s(use.average_feed_mm_per_s()), use.e(), use.k());
}

std::string tools_text(const CycleTime& time) {
  std::string out = head("  tool");
  for (const CycleUse& use : time.tools)
    out += fmt::format("{:>6}{}\n", fmt::format("T{}", use.tool), use_columns(use));
  return out + fmt::format("{:>6}{}\n", "all", use_columns(time.all)) +
         "F: mean commanded feed; actual: mean actual feed; e = actual / F, 1 is as programmed;\n"
         "k = F^2 / (a d) with acceleration a and mean block length d: the larger, the less of F is reached\n";
}

std::string histogram_text(const CycleTime& time) {
  std::string edges = "\ndistance mm, up to", g00 = "G0 positioning    ", g01 = "G1 cuts           ";
  for (std::size_t i = 0; i < time.g00.counts.size(); ++i) {
    const bool last = i == time.g00.edges_mm.size();
    edges += fmt::format(" {:>6}", last ? "longer" : format_trimmed(time.g00.edges_mm[i], 1));
    g00 += fmt::format(" {:>6}", time.g00.counts[i]);
    g01 += fmt::format(" {:>6}", time.g01.counts[i]);
  }
  return edges + "\n" + g00 + "\n" + g01 + "\n";
}

std::string rows_text(const TimeSummary& report) {
  std::size_t width = 4;
  for (const auto& row : report.rows) width = std::max(width, row.name.size());
  std::string out;
  if (!report.keys.empty()) {
    out = "swept:";
    for (const auto& key : report.keys) out += " " + key;
    out += "\n";
  }
  out += head(fmt::format("{:<{}}", report.keys.empty() ? "case" : "at", width));
  for (const auto& row : report.rows) out += fmt::format("{:<{}}{}\n", row.name, width, use_columns(row.time.all));
  return out;
}

std::string pair_text(const char* name, const TimePair& pair) {
  return fmt::format("{:<14} {:>10.2f} s {:>10.2f} s {:>+7.2f} %\n", name, pair.measured_s, pair.predicted_s,
                     pair.error_percent());
}

std::string accuracy_text(const calib::CycleAccuracy& a) {
  std::string out = fmt::format("\n{:<14} {:>12} {:>12} {:>9}\n", "against trace", "measured", "predicted", "error");
  if (a.has_lines) {
    out += pair_text("cutting", a.cutting) + pair_text("positioning", a.positioning);
    if (a.dwell.predicted_s > 0 || a.dwell.measured_s > 0) out += pair_text("dwell", a.dwell);
  }
  out += pair_text("total", a.total);
  if (a.parts.empty()) return out;
  std::vector<calib::MeasuredPart> worst = a.parts;
  std::stable_sort(worst.begin(), worst.end(), [](const auto& x, const auto& y) {
    return std::abs(x.time.predicted_s - x.time.measured_s) > std::abs(y.time.predicted_s - y.time.measured_s);
  });
  if (worst.size() > kMaxPartsShown) worst.resize(kMaxPartsShown);
  out += fmt::format("{} parts; those that differ most:\n", a.parts.size());
  for (const auto& part : worst)
    out += pair_text(fmt::format("{}-{}", part.line_first, part.line_last).c_str(), part.time);
  return out;
}

// --- JSON ------------------------------------------------------------------------------------------------------

/// JSON has no infinity.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json use_json(const CycleUse& use) {
  Json out;
  for (const auto& kind : kCycleKinds) out[std::string(kind.key)] = use.time.*kind.field;
  out["total_s"] = use.time.total_s();
  out["tool_changes"] = use.tool_changes;
  out["cutting_length_mm"] = use.cutting_mm;
  out["positioning_length_mm"] = use.positioning_mm;
  out["cutting_moves"] = use.cutting_moves;
  out["commanded_feed_mm_per_min"] = mm_per_min_from_mm_per_s(use.commanded_feed_mm_per_s());
  out["average_feed_mm_per_min"] = mm_per_min_from_mm_per_s(use.average_feed_mm_per_s());
  out["acceleration_mm_per_s2"] = number(use.acceleration_mm_per_s2());
  out["e"] = use.e();
  out["k"] = number(use.k());
  return out;
}

Json histogram_json(const feedmodel::DistanceHistogram& h) {
  return {{"up_to_mm", h.edges_mm}, {"counts", h.counts}, {"moves", h.moves}, {"length_mm", h.length_mm}};
}

Json time_of(const CycleTime& time) {
  Json out = use_json(time.all);
  out["dominant"] = std::string(feedmodel::dominant_kind(time.all.time).key);
  out["speed_changes"] = time.speed_changes;
  out["positionings_below_full_rapid"] = time.below_full_rapid;
  out["unplaced_moves"] = time.unplaced_moves;
  out["distances"] = {{"g00", histogram_json(time.g00)}, {"g01", histogram_json(time.g01)}};
  out["tools"] = Json::array();
  for (const CycleUse& use : time.tools) {
    Json tool = {{"tool", use.tool}};
    tool.update(use_json(use));
    out["tools"].push_back(tool);
  }
  return out;
}

Json pair_json(const TimePair& pair) {
  return {{"measured_s", pair.measured_s}, {"predicted_s", pair.predicted_s}, {"error_percent", pair.error_percent()}};
}

Json accuracy_json(const calib::CycleAccuracy& a) {
  Json out = {{"total", pair_json(a.total)}};
  if (!a.has_lines) return out;
  out["cutting"] = pair_json(a.cutting);
  out["positioning"] = pair_json(a.positioning);
  out["dwell"] = pair_json(a.dwell);
  out["parts"] = Json::array();
  for (const auto& part : a.parts) {
    Json row = {{"line_first", part.line_first}, {"line_last", part.line_last}};
    row.update(pair_json(part.time));
    out["parts"].push_back(row);
  }
  return out;
}

}  // namespace

std::string time_text(const TimeSummary& report) {
  std::string out = fmt::format("{} on {}\n", report.program, report.machine);
  const CycleTime& first = report.rows.front().time;
  if (report.rows.size() == 1 && report.keys.empty()) {
    out += "\n" + kinds_text(first) + dominance_sentence(first) + "\n" + tools_text(first) + kRatiosSentence + "\n" +
           histogram_text(first);
    if (report.accuracy) out += accuracy_text(*report.accuracy);
  } else {
    out += rows_text(report) + kRatiosSentence + "\n";
  }
  for (const auto& note : report.notes) out += "note: " + note + "\n";
  return out;
}

std::string time_json(const TimeSummary& report) {
  Json out = {{"program", report.program}, {"machine", report.machine}};
  out.update(time_of(report.rows.front().time));
  if (report.accuracy) out["trace"] = accuracy_json(*report.accuracy);
  if (report.rows.size() > 1 || !report.keys.empty()) {
    Json rows = Json::array();
    for (const auto& row : report.rows) {
      Json one = {{"name", row.name}};
      for (std::size_t k = 0; k < report.keys.size(); ++k) one["values"][report.keys[k]] = row.values[k];
      one.update(time_of(row.time));
      rows.push_back(one);
    }
    out[report.keys.empty() ? "cases" : "sweep"] = rows;
  }
  out["notes"] = report.notes;
  return out.dump(2) + "\n";
}

std::string time_page(const TimeSummary& report) {
  return cycle_page({.title = "Cycle time: " + report.program,
                     .subtitle = report.machine,
                     .keys = report.keys,
                     .rows = report.rows,
                     .picture = report.picture,
                     .machine = report.cards,
                     .notes = report.notes});
}

}  // namespace camber::report
