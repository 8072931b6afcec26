#include "report/fit_summary.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "machine/force_law.h"
#include "machine/job_tables.h"
#include "machine/material_reader.h"
#include "machine/number_key.h"
#include "report/html_report.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

using calib::FitPartsResult;
using calib::PartsResidual;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json parameters_json(const FitPartsResult& result) {
  Json out = Json::array();
  for (const auto& p : result.parameters)
    out.push_back(Json{{"name", p.name},
                       {"value", p.value},
                       {"unit", p.unit},
                       {"std_error", number(p.std_error)},
                       {"start", p.start},
                       {"note", p.note}});
  return out;
}

Json residuals_json(const FitPartsResult& result) {
  Json out = Json::array();
  for (const PartsResidual& r : result.residuals)
    out.push_back(Json{{"job", r.job},
                       {"feature", r.feature},
                       {"part", r.part},
                       {"tool", r.tool},
                       {"measured_mm", r.measured_mm},
                       {"predicted_mm", r.predicted_mm},
                       {"residual_um", r.residual_um()},
                       {"feed_mm_per_min", r.feed_mm_per_min},
                       {"spindle_rpm", r.spindle_rpm},
                       {"overhang_mm", r.overhang_mm},
                       {"held_out", r.held_out}});
  return out;
}

std::string in_um(const std::optional<double>& value) { return value ? fmt::format("{:.2f}", *value) : "-"; }

// --- page

constexpr double kWidth = 560, kHeight = 260, kLeft = 48, kRight = 12, kTop = 14, kBottom = 40;

/// Residuals over a condition, blue as fitted, red as held out.
std::string scatter_svg(const FitPartsResult& result, double PartsResidual::*condition, const std::string& axis) {
  double lo = 1e300, hi = -1e300, most = 1;
  for (const PartsResidual& r : result.residuals) {
    lo = std::min(lo, r.*condition), hi = std::max(hi, r.*condition);
    most = std::max(most, std::abs(r.residual_um()));
  }
  if (result.residuals.empty()) return {};
  const double span = std::max(hi - lo, 1e-9);
  const auto x = [&](double v) { return kLeft + (0.05 + 0.9 * (v - lo) / span) * (kWidth - kLeft - kRight); };
  const auto y = [&](double um) { return kTop + (0.5 - 0.5 * um / most) * (kHeight - kTop - kBottom); };
  std::string out = fmt::format(
      "<svg class=\"histogram\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"Residuals over {}\">\n", kWidth,
      kHeight, axis);
  for (const double um : {-most, 0.0, most})
    out += fmt::format(
        "<path stroke=\"#e3e8ee\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n<text x=\"{:.1f}\" y=\"{:.1f}\" "
        "text-anchor=\"end\">{}</text>\n",
        kLeft, y(um), kWidth - kRight, kLeft - 6, y(um) + 4, number_text(um, 1));
  for (const PartsResidual& r : result.residuals)
    out += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\" fill-opacity=\"0.7\"><title>{} {} "
        "{}</title></circle>\n",
        x(r.*condition), y(r.residual_um()), r.held_out ? "#c62828" : "#1668b8", html_text(r.job), html_text(r.feature),
        number_text(r.residual_um(), 2));
  for (const double v : {lo, hi})
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.6g}</text>\n", x(v),
                       kHeight - kBottom + 17, v);
  return out + fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n</svg>\n", kWidth / 2,
                           kHeight - 6, html_text(axis));
}

TextTable parameters_table(const FitPartsResult& result) {
  TextTable table{"Parameters", {"parameter", "value", "standard error", "unit", "start", ""}, {}, {}};
  for (const auto& p : result.parameters)
    table.rows.push_back({p.name, fmt::format("{:.6g}", p.value),
                          p.std_error ? fmt::format("{:.2g}", *p.std_error) : "–", p.unit,
                          fmt::format("{:.6g}", p.start), p.note});
  return table;
}

TextTable correlations_table(const FitPartsResult& result) {
  constexpr double kWorthShowing = 0.5;
  TextTable table{"Correlations of half and more", {"", "", "correlation"}, {}, {}};
  for (const auto& c : result.correlations)
    if (std::abs(c.value) >= kWorthShowing) table.rows.push_back({c.a, c.b, number_text(c.value, 3)});
  return table;
}

TextTable groups_table(const FitPartsResult& result) {
  TextTable table{"Residuals by feature", {"feature", "tool", "rms, µm", "held out, rms, µm"}, {}, {}};
  for (const auto& g : result.groups)
    table.rows.push_back({g.feature, fmt::format("T{}", g.tool), in_um(g.rms_um), in_um(g.held_out_rms_um)});
  return table;
}

TextTable residuals_table(const FitPartsResult& result) {
  TextTable table{"All measured values",
                  {"job", "feature", "tool", "stick-out, mm", "speed, 1/min", "feed, mm/min", "measured, mm",
                   "model, mm", "residual, µm", ""},
                  {},
                  {}};
  for (const PartsResidual& r : result.residuals)
    table.rows.push_back({r.job, r.feature, fmt::format("T{}", r.tool), fmt::format("{:.4g}", r.overhang_mm),
                          fmt::format("{:.6g}", r.spindle_rpm), fmt::format("{:.5g}", r.feed_mm_per_min),
                          number_text(r.measured_mm, 4), number_text(r.predicted_mm, 4),
                          number_text(r.residual_um(), 2), r.held_out ? "held out" : ""});
  return table;
}

}  // namespace

std::string fit_parts_json(const FitPartsResult& result) {
  Json out;
  out["parameters"] = parameters_json(result);
  out["correlations"] = Json::array();
  for (const auto& c : result.correlations)
    out["correlations"].push_back(Json{{"a", c.a}, {"b", c.b}, {"value", c.value}});
  out["groups"] = Json::array();
  for (const auto& g : result.groups)
    out["groups"].push_back(Json{{"feature", g.feature},
                                 {"tool", g.tool},
                                 {"rms_um", number(g.rms_um)},
                                 {"held_out_rms_um", number(g.held_out_rms_um)}});
  out["confounded"] = result.confounded;
  out["suggestions"] = result.suggestions;
  out["left_out"] = result.left_out;
  out["model_error"] = Json{{"deflection_percent", 100 * result.error.deflection},
                            {"contour_percent", 100 * result.error.contour},
                            {"size_um", 1000 * result.error.size_mm}};
  out["rms_um"] = result.rms_um;
  out["rounds"] = result.rounds;
  out["predictions"] = result.predictions;
  out["converged"] = result.converged;
  out["message"] = result.message;
  out["residuals"] = residuals_json(result);
  return out.dump(2) + "\n";
}

std::string fit_parts_text(const FitPartsResult& result, bool suggest) {
  std::string out = fmt::format("{:<36} {:>12} {:>10} {:<7} {}\n", "parameter", "value", "std error", "unit", "");
  for (const auto& p : result.parameters)
    fmt::format_to(std::back_inserter(out), "{:<36} {:>12.6g} {:>10} {:<7} {}\n", p.name, p.value,
                   p.std_error ? fmt::format("{:.2g}", *p.std_error) : "-", p.unit, p.note);
  fmt::format_to(std::back_inserter(out), "{:<28} {:>5} {:>9} {:>13}\n", "residuals, um rms", "tool", "fitted",
                 "held out");
  for (const auto& g : result.groups)
    fmt::format_to(std::back_inserter(out), "{:<28} {:>5} {:>9} {:>13}\n", g.feature, fmt::format("T{}", g.tool),
                   in_um(g.rms_um), in_um(g.held_out_rms_um));
  for (const std::string& left : result.left_out) out += fmt::format("left out, no prediction: {}\n", left);
  if (suggest)
    for (const std::string& s : result.suggestions) out += fmt::format("suggested: {}\n", s);
  return out + fmt::format("residual {:.2f} um rms over all; {}; {} predictions\n", result.rms_um, result.message,
                           result.predictions);
}

std::string fit_parts_page(const FitPartsResult& result) {
  ReportData data;
  data.title = "Fit to measured parts";
  data.subtitle = fmt::format("{} measured values of {} jobs", result.residuals.size(), result.jobs.size());
  data.verdict = PageVerdict{result.converged, result.message, {}};
  data.figures.push_back({"residual, rms", result.rms_um, std::nullopt, "um", 2, "rms_um"});
  for (const auto& [condition, axis] : {std::pair{&PartsResidual::feed_mm_per_min, "feed, mm/min"},
                                        std::pair{&PartsResidual::overhang_mm, "stick-out, mm"},
                                        std::pair{&PartsResidual::spindle_rpm, "spindle speed, 1/min"}})
    data.pictures.push_back({fmt::format("Residuals over {}", axis), scatter_svg(result, condition, axis),
                             "µm, measured minus model; blue: fitted, red: held out."});
  data.tables = {parameters_table(result), groups_table(result), correlations_table(result), residuals_table(result)};
  for (const std::string& c : result.confounded) data.warnings.push_back(c);
  for (const std::string& left : result.left_out) data.warnings.push_back("left out, no prediction: " + left);
  for (const std::string& s : result.suggestions) data.notes.push_back("To determine " + s + ".");
  return html_report(data);
}

namespace {

/// Comments "# NAME: VALUE +- ERROR UNIT" of the parameters whose name `belongs`: what compensate --uncertainty reads.
std::string parameter_comments(const FitPartsResult& result, bool (*belongs)(const std::string& name)) {
  std::string out;
  for (const auto& p : result.parameters)
    if (p.std_error && belongs(p.name))
      out += fmt::format("# {}: {:.6g} +- {:.2g} {}\n", p.name, p.value, *p.std_error, p.unit);
  return out;
}

/// Tools as fitted, a table for each clamping: tools.toml of the folder.
std::string fitted_tools_toml(const FitPartsResult& result) {
  std::string out;
  std::map<int, std::set<std::string>> seen;
  for (const machine::Job& job : result.jobs)
    for (const auto& [number, tool] : job.tools) {
      std::string text = machine::tool_toml(tool);
      if (!seen[number].insert(text).second) continue;
      if (seen[number].size() > 1) {  // another clamping: by a name
        const std::string name = fmt::format("T{} {}", number, calib::job_name(job));
        const std::string head = fmt::format("[tool.{}]\n", number);
        text.replace(text.find(head), head.size(), fmt::format("[tool.{}]\n", machine::toml_text(name)));
      }
      out += text;
    }
  return out;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> fit_parts_files(const FitPartsResult& result,
                                                                 const std::vector<std::string>& jobs) {
  const std::string head = fmt::format("# Fitted by camber fit-parts to {}; residual {:.3g} um rms.\n",
                                       fmt::join(jobs, ", "), result.rms_um);
  const auto of_machine = [](const std::string& n) { return n.starts_with("axis."); };
  const auto of_tools = [](const std::string& n) { return n.starts_with("tool."); };
  const auto of_material = [](const std::string& n) { return machine::find_coefficient(n) != nullptr; };
  const machine::Job& first = result.jobs.front();
  return {{"machine.toml", head + parameter_comments(result, of_machine) + machine::to_toml(first.machine)},
          {"tools.toml",
           head + parameter_comments(result, of_tools) +
               fmt::format("# For the job, what the fit leaves uncertain:\n# [model_error]\n"
                           "# deflection_percent = {:.3g}\n# contour_percent = {:.3g}\n"
                           "# size_um = {:.3g}\n",
                           100 * result.error.deflection, 100 * result.error.contour, 1000 * result.error.size_mm) +
               fitted_tools_toml(result)},
          {"material.toml",
           head + parameter_comments(result, of_material) + "[material]\n" + machine::material_text(first.material)},
          {"report.html", fit_parts_page(result)}};
}

}  // namespace camber::report
