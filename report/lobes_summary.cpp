#include "report/lobes_summary.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "dynamics/tool_modes.h"

namespace camber::report {

using dynamics::LobePoint;
using dynamics::LobeRequest;

namespace {

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
std::vector<std::size_t> lobe_peaks(const std::vector<LobePoint>& lobes, std::size_t most) {
  std::vector<std::size_t> peaks;
  const auto depth = [&](std::size_t i) { return lobes[i].critical.depth_mm; };
  for (std::size_t i = 0; i < lobes.size(); ++i)
    if ((i == 0 || depth(i) > depth(i - 1)) && (i + 1 == lobes.size() || depth(i) >= depth(i + 1))) peaks.push_back(i);
  std::ranges::sort(peaks, std::greater{}, depth);
  if (peaks.size() > most) peaks.resize(most);
  return peaks;
}

std::string depth_text(double mm) { return std::isfinite(mm) ? fmt::format("{:.3g} mm", mm) : "no limit found"; }

std::string lobes_extremes(const std::vector<LobePoint>& lobes) {
  const auto lowest = std::ranges::min_element(lobes, {}, [](const LobePoint& p) { return p.critical.depth_mm; });
  std::string out = fmt::format("lowest critical depth: {}", depth_text(lowest->critical.depth_mm));
  if (std::isfinite(lowest->critical.depth_mm))
    out += fmt::format(" at S{:.0f}, {:.0f} Hz", lowest->speed_rpm, lowest->critical.chatter_hz);
  out += "\ndeepest between lobes:";
  for (const std::size_t i : lobe_peaks(lobes, 3))
    out += fmt::format(" S{:.0f} {};", lobes[i].speed_rpm, depth_text(lobes[i].critical.depth_mm));
  out.back() = '\n';
  return out;
}

}  // namespace

std::string lobes_csv(const std::vector<LobePoint>& lobes) {
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

std::string lobes_json(const LobeRequest& r, const std::vector<LobePoint>& lobes) {
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
  return out.dump(2) + "\n";
}

std::string lobes_text(const LobeRequest& request, const std::vector<LobePoint>& lobes) {
  return modes_lines(request) + lobes_extremes(lobes);
}

}  // namespace camber::report
