#include "report/chatter_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "dynamics/tool_modes.h"
#include "report/lobes_summary.h"
#include "simulate/chatter.h"

namespace camber::report {
namespace {

using simulate::ChatterOperation;

constexpr std::size_t kShownLobes = 3;  ///< pictures on a page

std::vector<const ChatterOperation*> by_margin(const simulate::ChatterMargins& margins) {
  std::vector<const ChatterOperation*> out;
  for (const ChatterOperation& o : margins.operations) out.push_back(&o);
  std::ranges::stable_sort(out, std::greater{}, &ChatterOperation::margin);
  return out;
}

TextTable chatter_table(const simulate::ChatterMargins& margins) {
  TextTable table{
      "Chatter",
      {"tool", "S, 1/min", "depth / critical depth", "line", "sound, Hz", "depth, mm", "engagement, deg",
       "probability, %", "stable at S, 1/min", "modes"},
      {},
      "The worst tooth passing of each tool and spindle speed; above 1 it is unstable. The probability "
      "counts frequency, damping and stiffness at their errors: 10 %, a factor of 1.8 and 25 % by the beam, "
      "1, 15 and 10 % where modes are given; and a process damping of 0.1 mm times the specific force, within a factor "
      "of 2.2."};
  for (const ChatterOperation& o : margins.operations)
    table.rows.push_back({fmt::format("T{}", o.tool), fmt::format("{:.0f}", o.speed_rpm),
                          fmt::format("{:.2f}", o.margin), std::to_string(o.line), fmt::format("{:.0f}", o.chatter_hz),
                          fmt::format("{:.2f}", o.depth_mm), fmt::format("{:.0f}", deg_from_rad(o.arc_rad)),
                          fmt::format("{:.0f}", 100 * o.probability),
                          o.stable_speed_rpm > 0 ? fmt::format("{:.0f}", o.stable_speed_rpm) : "",
                          o.measured ? "given" : "beam, usual damping"});
  return table;
}

}  // namespace

void add_chatter(ReportData& data, const machine::Job& job, const simulate::ChatterMargins& margins) {
  if (margins.operations.empty()) return;
  data.tables.push_back(chatter_table(margins));
  const auto worst = by_margin(margins);
  for (std::size_t i = 0; i < std::min(worst.size(), kShownLobes); ++i) {
    const ChatterOperation& o = *worst[i];
    const std::string title = fmt::format("line {}: {:.2f} mm at S{:.0f}", o.line, o.depth_mm, o.speed_rpm);
    data.pictures.push_back({fmt::format("Stability lobes of T{}", o.tool),
                             lobes_svg(simulate::lobes_of(job, o), {{o.speed_rpm, o.depth_mm, title}}),
                             fmt::format("Of the engagement of line {}, {:.0f} degrees; the dot is its depth.", o.line,
                                         deg_from_rad(o.arc_rad))});
  }
}

std::string chatter_text(const simulate::ChatterMargins& margins) {
  const auto worst = by_margin(margins);
  if (worst.empty()) return {};
  if (worst.front()->margin <= 1) return fmt::format("chatter: {}\n", simulate::chatter_sentence(*worst.front()));
  std::string out;
  for (const ChatterOperation* o : worst)
    if (o->margin > 1) out += fmt::format("chatter: {}\n", simulate::chatter_sentence(*o));
  return out;
}

namespace {

std::string percent_or_factor(double error) {
  return error < 0.3 ? fmt::format("{:.0f} %", 100 * error) : fmt::format("a factor of {:.1f}", std::exp(error));
}

std::string explained(const machine::Job& job, const ChatterOperation& o) {
  std::string out = fmt::format(
      "chatter of T{} at S{:.0f}, line {}: {:.2f} mm deep on an arc of {:.0f} deg, slopes of the force {:.0f} MPa "
      "tangential, {:.0f} MPa radial\n",
      o.tool, o.speed_rpm, o.line, o.depth_mm, deg_from_rad(o.arc_rad), o.kt_MPa, o.kr_MPa);
  for (const machine::Mode& m : dynamics::modes_of(job.tools.at(o.tool)))
    out += fmt::format("  mode along {}: {:.0f} Hz, damping {:.2g} %, {:.3g} N/um{}\n",
                       m.direction.x() != 0 ? "x" : "y", m.frequency_hz, 100 * m.damping_ratio,
                       m.stiffness_N_per_mm / 1000, o.measured ? "" : "; of the beam, with a usual damping");
  for (const machine::Mode& m : job.workpiece_modes)
    out += fmt::format("  mode of the work along {}: {:.0f} Hz, damping {:.2g} %, {:.3g} N/um\n",
                       m.direction.x() != 0 ? "x" : "y", m.frequency_hz, 100 * m.damping_ratio,
                       m.stiffness_N_per_mm / 1000);
  out +=
      fmt::format("  margin {:.2f}: critical depth {:.2g} mm, {:.0f} Hz\n", o.margin, o.stable_depth_mm, o.chatter_hz);
  for (const simulate::MarginEffect& e : simulate::margin_effects(job, o))
    out += fmt::format("  {:.2f} to {:.2f} with the {} off by {}\n", e.low, e.high, e.property,
                       percent_or_factor(e.error));
  return out + fmt::format(
                   "  {:.2f} to {:.2f} in eight of ten draws of all three and of process damping; probability of "
                   "chatter {:.0f} %\n",
                   o.margin_low, o.margin_high, 100 * o.probability);
}

}  // namespace

std::string chatter_explanation(const machine::Job& job, const simulate::ChatterMargins& margins) {
  if (margins.operations.empty()) return "chatter: nothing is milled\n";
  std::string out;
  for (const ChatterOperation* o : by_margin(margins)) out += explained(job, *o);
  return out;
}

}  // namespace camber::report
