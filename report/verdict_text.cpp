#include "report/verdict_text.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "report/summary.h"

namespace camber::report {
namespace {

using compensate::CompensationResult;
using machine::CompensationSettings;

std::string judged_name(const CompensationSettings& asked) {
  return asked.reference == machine::Reference::machine ? "deflection" : "form error";
}

/// "95 % of the form error is within 2.31 um, tolerance_um = 5".
std::string figure_sentence(const CompensationResult& c, const CompensationSettings& asked) {
  if (asked.profile_um)
    return fmt::format("{:.1f} % of the area is within profile_um = [{:g}, {:g}], wanted are 95 %",
                       100 * c.plain_after.in_band_fraction, (*asked.profile_um)[0], (*asked.profile_um)[1]);
  return fmt::format("the {} of the emitted program is {:.2f} um (95th percentile), tolerance_um = {:g}",
                     judged_name(asked), c.after_um.p95, asked.tolerance_um);
}

std::string too_deep_sentence(const CompensationResult& c) {
  const Vec3& at = c.depth_after.place_mm;
  return fmt::format(
      "more than a thousandth of the surface lies {:.2f} um or more in the part, deepest ({:.2f} um) at X{:.3f} "
      "Y{:.3f} Z{:.3f}; no more than {:.4g} um were expected",
      c.depth_after.held_um, c.depth_after.deepest_um, at.x(), at.y(), at.z(), c.depth_limit_um);
}

std::vector<std::string> shortfalls(const CompensationResult& c, const CompensationSettings& asked) {
  std::vector<std::string> out = c.doubts;
  if (!c.settled) out.push_back(unsettled_sentence(c));
  if (!c.better)
    out.push_back("no round was better than the program as given and within the limits, so that program is judged");
  if (!c.within_part) out.push_back(too_deep_sentence(c));
  if (c.within_tolerance) return out;
  out.push_back(figure_sentence(c, asked));
  for (const auto& cause : c.causes) out.push_back(compensate::sentence(cause));
  return out;
}

std::string headline(const CompensationResult& c, const CompensationSettings& asked) {
  if (!c.doubts.empty() || !c.settled) return "the figures are not to be relied on";
  if (!c.better) return "no better program was found";
  if (!c.within_part) return "too deep in the part";
  return (c.within_tolerance ? "within the tolerance: " : "over the tolerance: ") + figure_sentence(c, asked);
}

}  // namespace

VerdictText verdict_text(const CompensationResult& c, const CompensationSettings& asked) {
  VerdictText out;
  out.headline = headline(c, asked);
  out.reasons = shortfalls(c, asked);
  out.success = out.reasons.empty();
  // What the headline says already.
  std::erase_if(out.reasons, [&](const std::string& reason) { return out.headline.ends_with(reason); });
  return out;
}

std::string plain_figures_text(const CompensationResult& c) {
  std::string out = fmt::format("{:<25}{:>10}{:>10}{:>10}\n", "surface in reach, um", "rms", "p95", "largest");
  const auto row = [&](const std::string& name, const removal::ErrorFigures& f) {
    fmt::format_to(std::back_inserter(out), "{:<25}{:>10.2f}{:>10.2f}{:>10.2f}\n", name, f.rms, f.p95,
                   std::max(std::abs(f.min), std::abs(f.max)));
  };
  const auto rows = [&](const std::string& name, auto part) {
    row(name + ", before", part(c.plain_before));
    row(name + ", after", part(c.plain_after));
  };
  rows("error", [](const auto& p) { return p.error_um; });
  rows(" deflection", [](const auto& p) { return p.deflection_um; });
  row(" contour", c.plain_after.contour_um);
  if (c.plain_after.total_um) rows("against part", [](const auto& p) { return *p.total_um; });
  fmt::format_to(std::back_inserter(out), "of {:.1f} mm2; without a figure, at the blank's faces: about {:.1f} mm2\n",
                 c.plain_after.error_um.area_mm2, c.unseen_mm2);
  if (c.reference == machine::Reference::machine)
    out += "judged by the deflection: [compensation] reference is the machine\n";
  return out;
}

}  // namespace camber::report
