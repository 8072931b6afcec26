#include "compensate/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/numbers.h"
#include "machine/force_law.h"
#include "machine/set_number.h"

namespace camber::compensate {
namespace {

std::string group_of(const std::string& name) {
  const machine::Coefficient* coefficient = machine::find_coefficient(name);
  if (coefficient != nullptr && coefficient->role == machine::CoefficientRole::edge) return "edge";
  if (name.find('.') == std::string::npos) return "cutting";
  for (const char* drive : {"position_gain", "velocity_lag", "filter", "exponential", "feed_forward"})
    if (name.find(drive) != std::string::npos) return "drives";
  return "limits";
}

[[noreturn]] void fail(const std::string& what, const std::string& message) {
  fail_on_file(what, message, "uncertainty");
}

std::vector<UncertainParameter> parameters_of_json(const std::string& path, const std::string& text) {
  std::vector<UncertainParameter> out;
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.contains("parameters") || !json["parameters"].is_array())
    fail(path, "is not a report of fit-force or fit-feed; \"parameters\" with name, value and std_error was expected");
  for (const auto& p : json["parameters"]) {
    if (!p.is_object() || !p.contains("name") || !p["name"].is_string()) continue;
    const auto value = p.find("value"), error = p.find("std_error");
    if (value == p.end() || error == p.end() || !value->is_number() || !error->is_number()) continue;
    out.push_back({p["name"], *value, *error});
  }
  return out;
}

constexpr std::size_t kLongestRow = 200;  // std::regex needs stack for each character

std::vector<UncertainParameter> parameters_of_toml(const std::string& text) {
  static const std::regex line(R"(^#\s*([\w.]+):\s*(\S+)\s*\+-\s*(\S+))");
  std::vector<UncertainParameter> out;
  std::size_t from = 0;
  while (from < text.size()) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string row = text.substr(from, end - from);
    std::smatch m;
    if (row.size() <= kLongestRow && std::regex_search(row, m, line)) {
      const auto value = parse_number(m[2].str()), error = parse_number(m[3].str());
      if (value && error) out.push_back({m[1], *value, *error});
    }
    from = end + 1;
  }
  return out;
}

}  // namespace

std::vector<ParameterGroup> read_uncertainty(const std::string& given) {
  std::string number = given;
  if (number.ends_with('%')) number.pop_back();
  while (number.ends_with(' ')) number.pop_back();
  if (const auto percent = parse_number(number)) {
    if (*percent <= 0 || *percent >= 100)
      fail("--uncertainty " + given, "is out of range; a percentage above 0 and below 100 was expected");
    return {{"force", {}, *percent / 100}, {"stiffness", {}, *percent / 100}};
  }
  const std::string text = SourceText::read(given).text();
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const auto parameters =
      first != std::string::npos && text[first] == '{' ? parameters_of_json(given, text) : parameters_of_toml(text);
  std::map<std::string, ParameterGroup> groups;
  for (const auto& p : parameters) {
    if (!(p.std_error > 0) || !std::isfinite(p.std_error)) continue;
    ParameterGroup& g = groups[group_of(p.name)];
    g.name = group_of(p.name);
    g.parameters.push_back(p);
  }
  if (groups.empty())
    fail(given,
         "has no standard error; output of fit-force or fit-feed (with -o or --json), or a percentage, was expected");
  std::vector<ParameterGroup> out;
  for (auto& [name, group] : groups) out.push_back(std::move(group));
  return out;
}

machine::Job moved(const machine::Job& job, const ParameterGroup& group, std::vector<std::string>& unknown) {
  machine::Job out = job;
  if (group.name == "force" && group.fraction > 0)
    for (const auto& c : machine::description(out.material.law).coefficients)
      if (c.role != machine::CoefficientRole::shape) out.material.*c.field *= 1 + group.fraction;
  if (group.name == "stiffness" && group.fraction > 0)
    for (auto& [number, tool] : out.tools) {
      tool.youngs_modulus_MPa /= 1 + group.fraction;
      tool.root_stiffness_N_per_mm /= 1 + group.fraction;
      tool.root_axial_stiffness_N_per_mm /= 1 + group.fraction;
      tool.root_rotational_stiffness_Nmm_per_rad /= 1 + group.fraction;
      if (tool.axial_stiffness_N_per_mm) *tool.axial_stiffness_N_per_mm /= 1 + group.fraction;
    }
  for (const auto& p : group.parameters) {
    if (const auto* coefficient = machine::find_coefficient(p.name))
      out.material.*coefficient->field += p.std_error;
    else if (!machine::set_number(out.machine, p.name, p.value + p.std_error).empty())
      unknown.push_back(p.name);
  }
  return out;
}

Band band_of(const std::vector<removal::SurfacePoint>& before, const std::vector<removal::SurfacePoint>& after,
             const std::vector<std::string>& names, const std::vector<std::vector<double>>& changes_mm,
             double tolerance_mm) {
  Band out;
  std::vector<double> area, sigma(after.size(), 0.0);
  for (const auto& p : after) area.push_back(p.area_mm2);
  for (std::size_t g = 0; g < changes_mm.size(); ++g) {
    out.groups.push_back({names[g], 1000 * removal::error_figures(changes_mm[g], area).rms});
    for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i] += changes_mm[g][i] * changes_mm[g][i];
  }
  std::vector<double> error, wide, deep;
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    sigma[i] = std::sqrt(sigma[i]);
    error.push_back(after[i].error_mm);
    wide.push_back(1000 * (std::abs(after[i].error_mm) + 1.96 * sigma[i]));
  }
  const double rms = removal::error_figures(error, area).rms, of_sigma = removal::error_figures(sigma, area).rms;
  out.sigma_rms_um = 1000 * of_sigma;
  out.rms_um = 1000 * std::hypot(rms, of_sigma);
  out.p95_um = removal::error_figures(wide, area).p95;

  constexpr double kOneSided = 1.645, kAreaAllowed = 0.05, kAreaDeepest = 0.01;
  double whole = 0;
  for (const double a : area) whole += a;
  std::vector<std::size_t> order(after.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto low = [&](std::size_t i) { return after[i].error_mm - kOneSided * sigma[i]; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return low(a) < low(b); });
  double passed = 0;
  for (const std::size_t i : order) {
    passed += area[i];
    out.deepest_um = std::max(0.0, -1000 * low(i));
    if (passed >= kAreaDeepest * whole) break;
  }
  const auto holds = [&](double fraction) {
    double over = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      const double e = (1 - fraction) * before[i].error_mm + fraction * after[i].error_mm;
      if (e - kOneSided * sigma[i] < -tolerance_mm) over += area[i];
    }
    return over <= kAreaAllowed * whole;
  };
  constexpr int kSteps = 100;
  out.safe_fraction = 0;
  for (int i = kSteps; i > 0; --i)
    if (holds(static_cast<double>(i) / kSteps)) {
      out.safe_fraction = static_cast<double>(i) / kSteps;
      break;
    }
  return out;
}

}  // namespace camber::compensate
