#include "report/fit_summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "report/page_tables.h"
#include "report/plot_frame.h"

namespace camber::report {
namespace {

using calib::FitFeedResult;
using calib::PartAccuracy;

constexpr std::size_t kDrawnParts = 3, kListedParts = 20;  // of a run, those with the largest errors
constexpr const char *kMeasured = "#1668b8", *kModelled = "#c0392b";

std::string fit_tile(const std::string& name, const std::string& value) {
  return fmt::format("<div class=\"tile\"><div class=\"name\">{}</div><div class=\"value\">{}</div></div>\n",
                     html_text(name), html_text(value));
}

std::string fit_card(const std::string& title, const std::string& body) {
  return fmt::format("<div class=\"card\"><h2>{}</h2>\n{}</div>\n", html_text(title), body);
}

std::string fit_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  std::string out = "<div class=\"wide\"><table><thead><tr>";
  for (const auto& name : head) out += "<th>" + html_text(name) + "</th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& row : rows) {
    out += "<tr>";
    for (const auto& field : row) out += "<td>" + html_text(field) + "</td>";
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string percent_text(double value, int decimals) { return number_text(value, decimals) + " %"; }

std::string parameters_card(const FitFeedResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (const calib::FitParameter& p : result.parameters)
    rows.push_back({p.name, std::isfinite(p.value) ? fmt::format("{:.6g}", p.value) : "no limit", p.unit,
                    p.std_error ? fmt::format("{:.2g}", *p.std_error) : "",
                    p.stretches > 0 ? fmt::format("{}", p.stretches) : "",
                    p.changed_from ? fmt::format("{:.6g}", *p.changed_from) : "", p.note});
  return fit_card("Parameters",
                  fit_table({"parameter", "value", "unit", "standard error", "from parts", "before", "note"}, rows));
}

std::string laws_card(const FitFeedResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (const calib::JudgedCornerLaw& law : result.laws)
    rows.push_back({law.name, percent_text(law.held_out_percent, 3), fmt::format("{:.3f}", law.held_out_cost)});
  return fit_card(
      "Corner laws on the held-out parts",
      fit_table({"law", "time", "cost"}, rows) + "<p class=\"note\">Taken: " + html_text(result.law) + ".</p>\n");
}

/// Over all runs, each weighted by its stations.
template <std::size_t n>
std::array<calib::SpeedResidual, n> pooled(const FitFeedResult& result,
                                           std::array<calib::SpeedResidual, n> calib::FeedAccuracy::*field) {
  std::array<calib::SpeedResidual, n> all{};
  for (std::size_t i = 0; i < n; ++i) {
    double square = 0;
    for (const calib::RunAccuracy& run : result.runs) {
      const calib::SpeedResidual& r = (run.accuracy.*field)[i];
      all[i].stations += r.stations;
      square += static_cast<double>(r.stations) * r.rms_percent * r.rms_percent;
    }
    if (all[i].stations > 0) all[i].rms_percent = std::sqrt(square / static_cast<double>(all[i].stations));
  }
  return all;
}

std::string by_place_table(const FitFeedResult& result) {
  const auto residuals = pooled(result, &calib::FeedAccuracy::by_state);
  std::size_t stations = 0;
  for (const calib::SpeedResidual& r : residuals) stations += r.stations;
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (residuals[i].stations == 0) continue;
    const double share = static_cast<double>(residuals[i].stations) / static_cast<double>(stations);
    rows.push_back({calib::kPathStates[i], percent_text(100 * share, 1), percent_text(residuals[i].rms_percent, 2)});
  }
  return rows.empty() ? "" : fit_table({"where", "of the way", "speed rms, of F"}, rows);
}

std::string by_axis_table(const FitFeedResult& result) {
  const auto residuals = pooled(result, &calib::FeedAccuracy::by_axis);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (residuals[i].stations > 0)
      rows.push_back({std::string(1, "XYZ"[i]), percent_text(residuals[i].rms_percent, 2)});
  return rows.empty() ? "" : fit_table({"axis", "speed rms, of F"}, rows);
}

std::string residuals_card(const FitFeedResult& result) {
  const std::string body = by_place_table(result) + by_axis_table(result);
  return body.empty() ? "" : fit_card("Residuals of the speed", body);
}

std::vector<const PartAccuracy*> worst_parts(const calib::FeedAccuracy& accuracy, std::size_t count) {
  std::vector<const PartAccuracy*> parts;
  for (const PartAccuracy& part : accuracy.parts) parts.push_back(&part);
  std::ranges::stable_sort(parts, std::greater<>(), [](const PartAccuracy* p) { return p->speed_rms_percent; });
  parts.resize(std::min(parts.size(), count));
  return parts;
}

std::string lines_text(const calib::TracePart& part) { return fmt::format("{}-{}", part.line_first, part.line_last); }

std::string run_card(const calib::RunAccuracy& run) {
  std::string body =
      fmt::format("<p>{} s measured, {} s modelled ({} %); path speed rms {} % of F.</p>\n",
                  number_text(run.accuracy.time_trace_s, 2), number_text(run.accuracy.time_model_s, 2),
                  number_text(run.accuracy.time_error_percent, 2), number_text(run.accuracy.speed_rms_percent, 2));
  for (const PartAccuracy* part : worst_parts(run.accuracy, kDrawnParts)) body += part_speed_svg(*part);
  std::vector<std::vector<std::string>> rows;
  for (const PartAccuracy* p : worst_parts(run.accuracy, kListedParts))
    rows.push_back({lines_text(p->part), fmt::format("{:.0f}", mm_per_min_from_mm_per_s(p->part.feed_mm_per_s)),
                    fmt::format("{:.3f}", p->time_trace_s), fmt::format("{:.3f}", p->time_model_s),
                    percent_text(100 * (p->time_model_s / p->time_trace_s - 1), 2),
                    percent_text(p->speed_rms_percent, 2)});
  if (!rows.empty())
    body += fit_table({"lines", "F", "measured, s", "modelled, s", "time error", "speed rms, of F"}, rows);
  if (run.accuracy.parts.size() > kListedParts)
    body += fmt::format("<p class=\"note\">{} of {} parts: those with the largest errors of speed.</p>\n", kListedParts,
                        run.accuracy.parts.size());
  return fit_card(run.program_name, body);
}

}  // namespace

std::string part_speed_svg(const PartAccuracy& part) {
  const auto per_min = [](const std::vector<float>& speeds) {
    std::vector<double> out;
    for (const float v : speeds) out.push_back(mm_per_min_from_mm_per_s(static_cast<double>(v)));
    return out;
  };
  const std::vector<double> measured = per_min(part.speeds.traced), modelled = per_min(part.speeds.model);
  if (measured.empty()) return {};
  std::vector<double> at;
  for (std::size_t i = 0; i < measured.size(); ++i)
    at.push_back(100 * (static_cast<double>(i) + 0.5) / static_cast<double>(measured.size()));
  const double most = std::max(*std::ranges::max_element(measured), *std::ranges::max_element(modelled));
  const PlotFrame frame(0, 100, 0, most);
  return frame.begin("Speed along lines " + lines_text(part.part), "of the way, %",
                     fmt::format("lines {}: speed, mm/min (blue measured, red modelled)", lines_text(part.part))) +
         frame.line(at, measured, kMeasured) + frame.line(at, modelled, kModelled) + PlotFrame::end();
}

std::string fit_feed_page(const FitFeedResult& result) {
  std::string out = page_head("Fitted machine", result.message) + "<div class=\"tiles\">\n";
  out += fit_tile("held-out parts", fmt::format("{}", result.held_out.parts));
  out += fit_tile("time, held out", percent_text(result.held_out.part_time_percent, 2));
  out += fit_tile("speed rms, held out", percent_text(result.held_out.speed_rms_percent, 2));
  if (result.promise)
    out += fit_tile("time of a next program", fmt::format("{} to {} %", number_text(result.promise->low_percent, 2),
                                                          number_text(result.promise->high_percent, 2)));
  out += "</div>\n" + residuals_card(result);
  for (const calib::RunAccuracy& run : result.runs) out += run_card(run);
  out += parameters_card(result) + laws_card(result);
  return out + "</main>\n</body>\n</html>\n";
}

}  // namespace camber::report
