#include "report/time_summary.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/units.h"
#include "report/machine_page.h"

namespace camber::report {
namespace {

std::string contour_text(const feedmodel::PoseContourFigures& contour) {
  return fmt::format(
      "contour error of the tip   {:.1f} um rms, {:.1f} um at most\n"
      "contour error of the axis  {:.4f} degrees rms, {:.4f} degrees at most\n",
      1000 * contour.tip_rms_mm, 1000 * contour.tip_max_mm, deg_from_rad(contour.axis_rms_rad),
      deg_from_rad(contour.axis_max_rad));
}

}  // namespace

std::string feed_text(const feedmodel::FeedSummary& summary) {
  return fmt::format("time          {:.3f} s\ncutting time  {:.3f} s\nblocks        {}\n", summary.time_s,
                     summary.cutting_time_s, summary.blocks) +
         (summary.contour ? contour_text(*summary.contour) : std::string());
}

std::string feed_json(const feedmodel::FeedSummary& summary) {
  Json report = {{"time_s", summary.time_s}, {"cutting_time_s", summary.cutting_time_s}, {"blocks", summary.blocks}};
  if (summary.contour) {
    const feedmodel::PoseContourFigures& c = *summary.contour;
    report["contour"] = {{"tip_max_um", 1000 * c.tip_max_mm},
                         {"tip_rms_um", 1000 * c.tip_rms_mm},
                         {"axis_max_deg", deg_from_rad(c.axis_max_rad)},
                         {"axis_rms_deg", deg_from_rad(c.axis_rms_rad)}};
  }
  return report.dump(2) + "\n";
}

std::string feed_page(const FeedPage& of, const nc::Interpretation& moves, const machine::Machine& machine) {
  MachinePage page;
  page.title = "Feed of " + of.program;
  page.subtitle = fmt::format("on the machine {}, camber {}", machine.path, CAMBER_VERSION);
  const auto figure = [](const char* name, double value, const char* unit, int decimals, const char* key) {
    return Figure{name, value, std::nullopt, unit, decimals, key};
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
  page.warnings = of.warnings;
  page.time_label = "time, s";
  page.notes = {"Positions are the predicted actual axes, with look-ahead, limits of all axes and lag of the drives."};
  page.work_origin_mm = -moves.machine_origin_mm.value_or(Vec3::Zero());
  return machine_page(machine, of.track, page);
}

}  // namespace camber::report
