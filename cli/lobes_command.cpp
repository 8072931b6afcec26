#include "cli/lobes_command.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "base/output_file.h"
#include "base/units.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "dynamics/tool_lobes.h"
#include "dynamics/tool_modes.h"
#include "machine/job_file.h"
#include "report/lobes_svg.h"

namespace camber::cli {
namespace {

using dynamics::LobePoint;
using dynamics::LobeRequest;

const machine::Tool& tool_of(const machine::Job& job, int number) {
  if (number < 0 && job.tools.size() == 1) return job.tools.begin()->second;
  const auto found = job.tools.find(number);
  if (number < 0) fail_on_file(job.path, "has several tools; --tool N was expected", "tool-missing");
  if (found == job.tools.end()) fail_on_file(job.path, fmt::format("has no [tool.{}]", number), "tool-missing");
  return found->second;
}

LobeRequest request_of(const LobesArguments& a, const machine::Job& job) {
  LobeRequest r;
  r.tool = tool_of(job, a.tool);
  if (a.radial_mm > r.tool.diameter_mm)
    fail_on_file("--radial-mm",
                 fmt::format("{:g}: at most the diameter of T{}, {:g}, was expected", a.radial_mm, r.tool.number,
                             r.tool.diameter_mm),
                 "value-range");
  r.modes = dynamics::modes_of(r.tool);
  r.modes.insert(r.modes.end(), job.workpiece_modes.begin(), job.workpiece_modes.end());
  r.material = job.material;
  r.chip_mm = a.chip_mm;
  r.radial_mm = a.radial_mm;
  r.milling = a.up ? dynamics::Milling::up : dynamics::Milling::down;
  r.method = a.method == "zero" ? dynamics::LobeMethod::zero_order : dynamics::LobeMethod::semi_discretisation;
  r.process_damping_N_per_mm = a.process_damping_N_per_mm;
  return r;
}

std::string csv_of(const std::vector<LobePoint>& lobes) {
  std::string out = "speed_rpm,depth_mm,chatter_Hz,border\n";
  for (const LobePoint& p : lobes) {
    append_cells(out, 3, {p.speed_rpm});
    if (std::isfinite(p.critical.depth_mm))
      out += fmt::format("{:.5f},{:.2f},{}\n", p.critical.depth_mm, p.critical.chatter_hz, name_of(p.border));
    else
      out += ",,none\n";
  }
  return out;
}

std::string modes_lines(const LobeRequest& r) {
  std::string out =
      r.tool.modes.empty()
          ? fmt::format("modes of T{} by its beam, alike in x and y; damping of {:g} % is a usual value\n",
                        r.tool.number, 100 * dynamics::kUsualDamping)
          : fmt::format("modes of T{} as given\n", r.tool.number);
  for (const auto& m : r.modes)
    out += fmt::format("  {}  {:9.1f} Hz  {:6.2f} %  {:9.3f} N/um\n", m.direction.x() != 0 ? "x" : "y", m.frequency_hz,
                       100 * m.damping_ratio, m.stiffness_N_per_mm / 1000);
  if (!r.tool.modes.empty()) return out;
  const double top = std::min(r.tool.flute_length_mm.value_or(r.tool.overhang_mm), r.tool.overhang_mm);
  out += "modal stiffness along the flutes, N/um, at";
  for (int i = 0; i <= 4; ++i) out += fmt::format(" {:.1f}", top * i / 4);
  out += " mm from the tip\n";
  for (const auto& m : dynamics::beam_modes_of(r.tool)) {
    out += fmt::format("  {:9.1f} Hz", m.frequency_hz);
    for (int i = 0; i <= 4; ++i) out += fmt::format("  {:.4g}", m.stiffness_N_per_mm(top * i / 4) / 1000);
    out += "\n";
  }
  return out;
}

/// Indices of the deepest stable depths, at most `most`, each a peak between two lobes.
std::vector<std::size_t> peaks_of(const std::vector<LobePoint>& lobes, std::size_t most) {
  std::vector<std::size_t> peaks;
  const auto depth = [&](std::size_t i) { return lobes[i].critical.depth_mm; };
  for (std::size_t i = 0; i < lobes.size(); ++i)
    if ((i == 0 || depth(i) > depth(i - 1)) && (i + 1 == lobes.size() || depth(i) >= depth(i + 1))) peaks.push_back(i);
  std::ranges::sort(peaks, std::greater{}, depth);
  if (peaks.size() > most) peaks.resize(most);
  return peaks;
}

std::string depth_text(double mm) { return std::isfinite(mm) ? fmt::format("{:.3g} mm", mm) : "no limit found"; }

std::string summary_of(const std::vector<LobePoint>& lobes) {
  const auto lowest = std::ranges::min_element(lobes, {}, [](const LobePoint& p) { return p.critical.depth_mm; });
  std::string out = fmt::format("lowest critical depth: {}", depth_text(lowest->critical.depth_mm));
  if (std::isfinite(lowest->critical.depth_mm))
    out += fmt::format(" at S{:.0f}, {:.0f} Hz", lowest->speed_rpm, lowest->critical.chatter_hz);
  out += "\ndeepest between lobes:";
  for (const std::size_t i : peaks_of(lobes, 3))
    out += fmt::format(" S{:.0f} {};", lobes[i].speed_rpm, depth_text(lobes[i].critical.depth_mm));
  out.back() = '\n';
  return out;
}

Json json_of(const LobeRequest& r, const std::vector<LobePoint>& lobes) {
  Json out = {{"tool", r.tool.number}, {"radial_mm", r.radial_mm}, {"modes", Json::array()}, {"lobes", Json::array()}};
  for (const auto& m : r.modes)
    out["modes"].push_back({{"direction", m.direction.x() != 0 ? "x" : "y"},
                            {"frequency_Hz", m.frequency_hz},
                            {"damping_percent", 100 * m.damping_ratio},
                            {"stiffness_N_per_um", m.stiffness_N_per_mm / 1000}});
  for (const LobePoint& p : lobes) {
    const bool found = std::isfinite(p.critical.depth_mm);
    out["lobes"].push_back({{"speed_rpm", p.speed_rpm},
                            {"depth_mm", found ? Json(p.critical.depth_mm) : Json(nullptr)},
                            {"chatter_Hz", found ? Json(p.critical.chatter_hz) : Json(nullptr)},
                            {"border", name_of(p.border)}});
  }
  return out;
}

}  // namespace

std::optional<std::vector<double>> parse_speeds(const std::string& text) {
  std::vector<double> n;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    n.push_back(parse_number(std::string_view(text).substr(begin, end - begin)).value_or(-1));
    begin = end + 1;
  }
  constexpr double kMostSpeeds = 100000;
  if (n.size() != 3 || n[0] <= 0 || n[1] <= n[0] || n[2] < 2 || n[2] > kMostSpeeds || n[2] != std::floor(n[2]))
    return std::nullopt;
  std::vector<double> speeds;
  speeds.reserve(static_cast<std::size_t>(n[2]));
  for (int i = 0; i < n[2]; ++i) speeds.push_back(n[0] + (n[1] - n[0]) * i / (n[2] - 1));
  return speeds;
}

int run_lobes(const LobesArguments& a, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Job job = machine::read_unprogrammed_job(a.job, diagnostics);
  settle(diagnostics, options);
  check_outputs({a.output, a.plot, a.json}, {a.job});
  const LobeRequest request = request_of(a, job);
  const auto lobes = dynamics::tool_lobes(request, a.speeds_rpm);
  if (!options.quiet) fmt::print("{}{}", modes_lines(request), summary_of(lobes));
  write_file(a.output, csv_of(lobes));
  if (!a.plot.empty()) write_file(a.plot, report::lobes_svg(lobes));
  if (!a.json.empty()) write_file(a.json, json_of(request, lobes).dump(2) + "\n");
  return kDone;
}

}  // namespace camber::cli
