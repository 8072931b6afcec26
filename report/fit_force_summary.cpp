#include "report/fit_summary.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/units.h"
#include "machine/force_law.h"
#include "machine/material_reader.h"

namespace camber::report {

using calib::FitForceResult;

namespace {

std::string component_text(bool has, double value) {
  return has ? fmt::format("{:>9.2f}", value) : fmt::format("{:>9}", "-");
}

Json force_components(const std::array<bool, 3>& has, const Vec3& f) {
  Json out = Json::array();
  for (int a = 0; a < 3; ++a) out.push_back(has[static_cast<std::size_t>(a)] ? Json(f[a]) : Json(nullptr));
  return out;
}

}  // namespace

std::string fit_force_text(const FitForceResult& result) {
  std::string out = fmt::format("{:<20} {:>14} {:<6} {:>11}\n", "parameter", "value", "unit", "std error");
  for (const auto& p : result.parameters)
    out += fmt::format("{:<20} {:>14.6g} {:<6} {:>11}  {}\n", p.name, p.value, p.unit,
                       p.std_error ? fmt::format("{:.2g}", *p.std_error) : "-", p.note);
  for (const auto& r : result.run_out)
    if (!r.note.empty()) out += fmt::format("run-out of {}: {}\n", r.log, r.note);
  out +=
      fmt::format("mean force on the tool, N: x feed, y left of it, z up\n{:>27} {:>28}  cut\n", "measured", "fitted");
  for (const auto& c : result.cuts) {
    for (const Vec3* f : {&c.measured_N, &c.model_N})
      for (int a = 0; a < 3; ++a)
        out += fmt::format("{}{}", component_text(c.has[static_cast<std::size_t>(a)], (*f)[a]), a == 2 ? " " : "");
    out += fmt::format(" {}\n", c.name);
  }
  out += fmt::format("residual {:.3g} N rms", result.residual_rms_N);
  if (result.held_out_rms_N) out += fmt::format(", held out {:.3g} N rms", *result.held_out_rms_N);
  out += fmt::format("; {}\n", result.message);
  return out;
}

std::string fit_force_json(const FitForceResult& result) {
  Json report;
  for (const auto& p : result.parameters)
    report["parameters"].push_back({{"name", p.name},
                                    {"value", p.value},
                                    {"unit", p.unit},
                                    {"std_error", p.std_error ? Json(*p.std_error) : Json(nullptr)},
                                    {"note", p.note}});
  report["held_out"] = {{"rms_N", result.held_out_rms_N ? Json(*result.held_out_rms_N) : Json(nullptr)}};
  report["fitted"] = {{"rms_N", result.residual_rms_N}};
  report["run_out"] = Json::array();
  for (const auto& r : result.run_out)
    report["run_out"].push_back({{"log", r.log},
                                 {"offset_um", 1000 * r.offset_mm},
                                 {"angle_deg", deg_from_rad(r.angle_rad)},
                                 {"offset_std_error_um", 1000 * r.offset_std_error_mm},
                                 {"note", r.note}});
  for (const auto& c : result.cuts)
    report["cuts"].push_back({{"cut", c.name},
                              {"measured_mean_N", force_components(c.has, c.measured_N)},
                              {"fitted_mean_N", force_components(c.has, c.model_N)}});
  report["converged"] = result.converged;
  report["plausible"] = result.plausible;
  report["message"] = result.message;
  return report.dump(2) + "\n";
}

std::string material_file(const FitForceResult& result, const std::vector<std::string>& logs) {
  std::string out = fmt::format("# Fitted by camber fit-force to {}; residual {:.3g} N rms.\n", fmt::join(logs, ", "),
                                result.residual_rms_N);
  for (const auto& p : result.parameters)
    if (p.std_error) out += fmt::format("# {}: {:.6g} +- {:.2g} {}\n", p.name, p.value, *p.std_error, p.unit);
  // More digits than the fit can know would only hide it.
  machine::Material rounded = result.material;
  for (const auto& c : machine::description(rounded.law).coefficients)
    rounded.*c.field = std::stod(fmt::format("{:.6g}", rounded.*c.field));
  return out + "[material]\n" + machine::material_text(rounded);
}

}  // namespace camber::report
