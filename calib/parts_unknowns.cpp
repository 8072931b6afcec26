#include "calib/parts_unknowns.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include <fmt/format.h>

#include "machine/force_law.h"

namespace camber::calib {
namespace {

using machine::Job;
using machine::Tool;

/// Returns the key of a clamping: jobs whose tool tables are alike share it.
std::string clamping_key(const Tool& t) {
  return fmt::format("{} {:.6g} {:.6g} {:.6g} {:.6g}", t.number, t.diameter_mm, t.overhang_mm,
                     t.flute_length_mm.value_or(0), t.runout_mm);
}

std::map<std::string, std::size_t> clampings_of(const std::vector<Job>& jobs) {
  std::map<std::string, std::size_t> out;
  for (const Job& job : jobs)
    for (const auto& [number, tool] : job.tools) out.try_emplace(clamping_key(tool), out.size());
  return out;
}

bool held_out(const Job& job, const std::string& part, const std::vector<std::string>& names) {
  return std::ranges::any_of(names, [&](const std::string& n) { return n == job_name(job) || n == part; });
}

std::vector<bool> jobs_where(const std::vector<Job>& jobs, const std::function<bool(const Job&)>& test) {
  std::vector<bool> out;
  out.reserve(jobs.size());
  for (const Job& job : jobs) out.push_back(test(job));
  return out;
}

bool any(const std::vector<bool>& of_job) { return std::ranges::find(of_job, true) != of_job.end(); }

void scale_lag(Job& job, int axis, double factor) {
  job.machine.axis[static_cast<std::size_t>(axis)].position_gain_per_s /= std::sqrt(factor);
}

bool has_gains(const Job& job) {
  return std::isfinite(job.machine.axis[0].position_gain_per_s) &&
         std::isfinite(job.machine.axis[1].position_gain_per_s);
}

void scale_coefficients(Job& job, double factor, bool (*belongs)(const machine::Coefficient&)) {
  for (const auto& c : machine::description(job.material.law).coefficients)
    if (c.role != machine::CoefficientRole::shape && belongs(c)) job.material.*c.field *= factor;
}

bool any_coefficient(const machine::Coefficient&) { return true; }
bool is_edge(const machine::Coefficient& c) { return c.role == machine::CoefficientRole::edge; }
bool is_radial(const machine::Coefficient& c) { return c.component == machine::Component::radial; }

bool has_edges(const Job& job) {
  for (const auto& c : machine::description(job.material.law).coefficients)
    if (c.role == machine::CoefficientRole::edge && job.material.*c.field != 0) return true;
  return false;
}

/// Offsets of every clamping of every tool that made something.
void add_offsets(const std::vector<Job>& jobs, const std::vector<PartsRow>& rows, std::vector<PartsUnknown>& out) {
  const auto clampings = clampings_of(jobs);
  std::map<std::size_t, std::string> names;
  std::map<int, std::set<std::size_t>> of_tool;
  std::map<std::size_t, int> tools;
  for (const PartsRow& row : rows)
    if (row.size_per_diameter != 0 && row.tool != 0 && !row.held_out) {
      of_tool[row.tool].insert(row.clamping);
      tools[row.clamping] = row.tool;
      names[row.clamping] = fmt::format("{:.4g}", jobs[row.job].tools.at(row.tool).overhang_mm);
    }
  for (const auto& [clamping, overhang] : names) {
    const int tool = tools.at(clamping);
    PartsUnknown u{.kind = UnknownKind::offset,
                   .name = fmt::format("tool.{}.diameter_mm", tool),
                   .tool = tool,
                   .clamping = clamping,
                   .of_job = {}};
    u.of_job = jobs_where(jobs, [&, clamping = clamping](const Job& job) {
      return job.tools.contains(tool) && clampings.at(clamping_key(job.tools.at(tool))) == clamping;
    });
    u.apply = [tool](Job& job, double x) { job.tools.at(tool).diameter_mm += x; };
    if (of_tool[tool].size() > 1) u.name += fmt::format(" (overhang {})", overhang);
    out.push_back(std::move(u));
  }
}

void add_stiffness(const std::vector<Job>& jobs, bool rotational, std::vector<PartsUnknown>& out) {
  std::set<int> tools;
  for (const Job& job : jobs)
    for (const auto& [number, tool] : job.tools) tools.insert(number);
  for (const int number : tools) {
    double Tool::*const field =
        rotational ? &Tool::root_rotational_stiffness_Nmm_per_rad : &Tool::root_stiffness_N_per_mm;
    PartsUnknown u{.kind = rotational ? UnknownKind::root_rotation : UnknownKind::root,
                   .name = fmt::format("tool.{}.{}", number,
                                       rotational ? "root_rotational_stiffness_Nm_per_rad" : "root_stiffness_N_per_um"),
                   .tool = number,
                   .of_job = jobs_where(jobs, [&](const Job& job) {
                     return job.tools.contains(number) && std::isfinite(job.tools.at(number).*field);
                   })};
    u.apply = [number, field](Job& job, double x) {
      if (job.tools.contains(number)) job.tools.at(number).*field /= 1 + x;
    };
    if (any(u.of_job)) out.push_back(std::move(u));
  }
}

}  // namespace

int tool_of(const Job& job, const machine::Feature& feature) {
  if (feature.tool) return *feature.tool;
  if (job.operations.tools.size() == 1) return job.operations.tools.front();
  return job.tools.size() == 1 ? job.tools.begin()->first : 0;
}

std::optional<double> days_of(const std::string& date) {
  int y = 0, m = 0, d = 0, hour = 0, minute = 0;
  const int read = std::sscanf(date.c_str(), "%d-%d-%d%*1[T ]%d:%d", &y, &m, &d, &hour, &minute);
  if (read < 3 || m < 1 || m > 12 || d < 1 || d > 31) return std::nullopt;
  // Days from the civil calendar: Howard Hinnant, chrono-compatible low-level date algorithms.
  y -= m <= 2;
  const int era = (y >= 0 ? y : y - 399) / 400, yoe = y - era * 400;
  const int doy = (153 * (m + (m > 2 ? -3 : 9)) + 2) / 5 + d - 1, doe = yoe * 365 + yoe / 4 - yoe / 100 + doy;
  return era * 146097.0 + doe + (hour + minute / 60.0) / 24;
}

std::vector<PartsRow> rows_of(const std::vector<Job>& jobs, const std::vector<std::string>& hold_out) {
  const auto clampings = clampings_of(jobs);
  std::vector<PartsRow> out;
  std::optional<double> first;
  for (std::size_t j = 0; j < jobs.size(); ++j)
    for (std::size_t f = 0; f < jobs[j].features.size(); ++f) {
      const machine::Feature& feature = jobs[j].features[f];
      const int tool = tool_of(jobs[j], feature);
      const auto found = jobs[j].tools.find(tool);
      for (const machine::MeasuredValue& v : feature.measured) {
        PartsRow row{.job = j,
                     .feature = f,
                     .part = v.part,
                     .tool = found == jobs[j].tools.end() ? 0 : tool,
                     .measured_mm = v.value_mm,
                     .size_per_diameter = feature.size_per_diameter(),
                     .day = days_of(v.date),
                     .held_out = held_out(jobs[j], v.part, hold_out)};
        if (row.tool != 0) row.clamping = clampings.at(clamping_key(found->second));
        if (row.day && (!first || *row.day < *first)) first = row.day;
        out.push_back(std::move(row));
      }
    }
  for (PartsRow& row : out)
    if (row.day) *row.day -= *first;
  return out;
}

std::vector<PartsUnknown> unknowns_of(const std::vector<Job>& jobs, const std::vector<PartsRow>& rows) {
  std::vector<PartsUnknown> out;
  add_offsets(jobs, rows, out);
  const std::vector<bool> gains = jobs_where(jobs, has_gains), all(jobs.size(), true);
  if (any(gains))
    out.push_back(
        {.kind = UnknownKind::gain, .name = "position_gain_per_s", .of_job = gains, .apply = [](Job& job, double x) {
           for (const int axis : {0, 1}) scale_lag(job, axis, 1 + x);
         }});
  out.push_back({.kind = UnknownKind::force, .name = "force_scale", .of_job = all, .apply = [](Job& job, double x) {
                   scale_coefficients(job, 1 + x, any_coefficient);
                 }});
  out.push_back({.kind = UnknownKind::radial, .name = "radial_scale", .of_job = all, .apply = [](Job& job, double x) {
                   scale_coefficients(job, 1 + x, is_radial);
                 }});
  add_stiffness(jobs, false, out);
  if (const auto edges = jobs_where(jobs, has_edges); any(edges))
    out.push_back({.kind = UnknownKind::edge, .name = "edge_scale", .of_job = edges, .apply = [](Job& job, double x) {
                     scale_coefficients(job, 1 + x, is_edge);
                   }});
  if (any(gains))
    out.push_back(
        {.kind = UnknownKind::gain_ratio, .name = "gain of X over Y", .of_job = gains, .apply = [](Job& job, double x) {
           scale_lag(job, 0, 1 + x);
           scale_lag(job, 1, 1 - x);
         }});
  add_stiffness(jobs, true, out);
  const bool dated = std::ranges::any_of(rows, [](const PartsRow& r) { return r.day && *r.day > 0; });
  if (dated) out.push_back({.kind = UnknownKind::drift, .name = "drift", .of_job = {}});
  return out;
}

std::string suggestion_for(const PartsUnknown& u, const PartsUnknown* other) {
  const std::string from = other ? fmt::format(" from {}", other->name) : "";
  switch (u.kind) {
    case UnknownKind::offset:
      return fmt::format("{}{}: measure a bore or a slot of this tool in this clamping", u.name, from);
    case UnknownKind::gain:
      return fmt::format("{}{}: bores of one small radius at three feeds, a light cut with a short tool", u.name, from);
    case UnknownKind::gain_ratio:
      return "gain of X and Y apart: slot widths or distances along X and along Y, not round features alone";
    case UnknownKind::force:
      return fmt::format("{}{}: one slot or bore at three feeds with a long tool, in one clamping", u.name, from);
    case UnknownKind::radial:
      return "radial and tangential forces apart: walls cut with thin and with thick radial depths by a long tool";
    case UnknownKind::edge:
      return "edge and cutting forces apart: feeds per tooth over a range of three or more with a long tool";
    case UnknownKind::root:
      return fmt::format(
          "{}{}: the same feature with a short and a long stick-out, the short one with a heavy cut of a "
          "thick tool",
          u.name, from);
    case UnknownKind::root_rotation:
      return fmt::format("{}{}: three stick-outs of one tool", u.name, from);
    case UnknownKind::drift:
      return "drift: two parts with the same settings, hours apart";
  }
  return {};
}

}  // namespace camber::calib
