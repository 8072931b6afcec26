#include "cli/feed_page.h"

#include <fmt/format.h>

#include "base/units.h"
#include "report/machine_page.h"

namespace camber::cli {

std::string feed_page(const FeedPage& of, const nc::Interpretation& moves, const machine::Machine& machine,
                      const Diagnostics& found) {
  report::MachinePage page;
  page.title = "Feed of " + of.program;
  page.subtitle = fmt::format("on the machine {}, camber {}", of.machine, CAMBER_VERSION);
  const auto figure = [](const char* name, double value, const char* unit, int decimals, const char* key) {
    return report::Figure{name, value, std::nullopt, unit, decimals, key};
  };
  page.figures = {figure("time", of.summary.time_s, "s", 1, "time_s"),
                  figure("cutting", of.summary.cutting_time_s, "s", 1, "cutting_time_s"),
                  figure("blocks", static_cast<double>(of.summary.blocks), "", 0, "blocks")};
  if (const auto& c = of.summary.contour) {
    page.figures.push_back(
        figure("contour error of the tip, rms", 1000 * c->tip_rms_mm, "µm", 1, "contour.tip_rms_um"));
    page.figures.push_back(figure("at most", 1000 * c->tip_max_mm, "µm", 1, "contour.tip_max_um"));
    page.figures.push_back(
        figure("of the axis, at most", deg_from_rad(c->axis_max_rad), "degrees", 4, "contour.axis_max_deg"));
  }
  for (const Diagnostic& d : found.all()) page.warnings.push_back(to_string(d));
  page.time_label = "time, s";
  page.notes = {"Positions are the predicted actual axes, with look-ahead, limits of all axes and lag of the drives."};
  page.work_origin_mm = -moves.machine_origin_mm.value_or(Vec3::Zero());
  return report::machine_page(machine, of.track, page);
}

}  // namespace camber::cli
