#include "report/verdict_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/figures_json.h"

namespace camber::report {
namespace {

using compensate::CompensationResult;
using compensate::Verification;
using machine::CompensationSettings;

std::string judged_name(const CompensationSettings& asked) {
  return asked.reference == machine::Reference::machine ? "deflection" : "form error";
}

/// "95 % of the form error is within 2.31 um, tolerance_um = 5".
std::string figure_sentence(double p95_um, double in_band_fraction, const CompensationSettings& asked) {
  if (asked.profile_um)
    return fmt::format("{:.1f} % of the area is within profile_um = [{:g}, {:g}]; 95 % was expected",
                       100 * in_band_fraction, (*asked.profile_um)[0], (*asked.profile_um)[1]);
  return fmt::format("the {} of the emitted program is {:.2f} um (95th percentile), tolerance_um = {:g}",
                     judged_name(asked), p95_um, asked.tolerance_um);
}

std::string figure_sentence(const CompensationResult& c, const CompensationSettings& asked) {
  return figure_sentence(c.figures.after_um.p95, c.figures.plain_after.in_band_fraction, asked);
}

std::string figure_sentence(const Verification& v, const CompensationSettings& asked) {
  return figure_sentence(compensate::judged_of(v.plain, asked.reference).p95, v.plain.in_band_fraction, asked);
}

std::string too_deep_sentence(const compensate::Depth& depth, double limit_um) {
  const Vec3& at = depth.place_mm;
  return fmt::format(
      "the gouge depth is {:.2f} um (exceeded by 0.1 % of the surface), deepest ({:.2f} um) at X{:.3f} Y{:.3f} "
      "Z{:.3f}{}; no more than {:.4g} um were expected",
      depth.gouge_depth_p999_um, depth.deepest_um, at.x(), at.y(), at.z(),
      depth.line.given > 0 ? " in " + compensate::lines_text({depth.line}) : "", limit_um);
}

std::string unused_sentence(const compensate::LeverOutlook& o, double given_s) {
  const char* of =
      o.lever == machine::Lever::passes ? "second cuts (lever \"passes\")" : "lower feeds (lever \"feed\")";
  return fmt::format("{} are expected to leave {:.1f} um (95th percentile) for {:.1f} s more ({:+.0f} %)", of, o.p95_um,
                     o.extra_s, given_s > 0 ? 100 * o.extra_s / given_s : 0);
}

std::vector<std::string> shortfalls(const CompensationResult& c, const CompensationSettings& asked) {
  std::vector<std::string> out = c.verdict.doubts;
  if (!c.verdict.settled) out.push_back(unsettled_sentence(c));
  if (!c.verdict.better)
    out.push_back(
        "no round was both better than the given program and within the limits, so the given program is judged");
  if (!c.safety.within_part) out.push_back(too_deep_sentence(c.safety.after, c.safety.depth_limit_um));
  if (c.verdict.within_tolerance) return out;
  out.push_back(figure_sentence(c, asked));
  if (!asked.profile_um && c.figures.outlook.achievable_p95_um > asked.tolerance_um)
    out.push_back(fmt::format("before the rounds, shifts alone were expected to leave {:.2f} um (95th percentile)",
                              c.figures.outlook.achievable_p95_um));
  for (const auto& cause : c.verdict.causes) out.push_back(compensate::sentence(cause));
  for (const auto& lever : c.verdict.unused) out.push_back(unused_sentence(lever, c.figures.feed_before.time_s));
  return out;
}

std::string headline(const CompensationResult& c, const CompensationSettings& asked) {
  if (!c.verdict.doubts.empty() || !c.verdict.settled) return "the figures are not reliable";
  if (!c.verdict.better) return "no better program was found";
  if (!c.safety.within_part) return "gouge too deep";
  return (c.verdict.within_tolerance ? "within the tolerance: " : "over the tolerance: ") + figure_sentence(c, asked);
}

std::string headline(const Verification& v, const CompensationSettings& asked) {
  if (!v.doubts.empty() || !v.settled) return "the figures are not reliable";
  if (!v.within_part) return "gouge too deep";
  return (v.within_tolerance ? "within the tolerance: " : "over the tolerance: ") + figure_sentence(v, asked);
}

std::vector<std::string> shortfalls(const Verification& v, const CompensationSettings& asked) {
  std::vector<std::string> out = v.doubts;
  if (!v.settled) out.push_back(unsettled_sentence(v));
  if (!v.within_part) out.push_back(too_deep_sentence(v.depth, v.depth_limit_um));
  if (!v.within_tolerance) out.push_back(figure_sentence(v, asked));
  return out;
}

template <class Result>
VerdictText verdict_of(const Result& c, const CompensationSettings& asked) {
  VerdictText out;
  out.headline = headline(c, asked);
  out.reasons = shortfalls(c, asked);
  out.success = out.reasons.empty();
  // What the headline says already.
  std::erase_if(out.reasons, [&](const std::string& reason) { return out.headline.ends_with(reason); });
  return out;
}

constexpr const char* kPlainHead = "surface in reach, um";

std::string plain_head() { return fmt::format("{:<25}{:>10}{:>10}{:>10}\n", kPlainHead, "rms", "p95", "largest"); }

std::string plain_row(const std::string& name, const removal::ErrorFigures& f) {
  return fmt::format("{:<25}{:>10.2f}{:>10.2f}{:>10.2f}\n", name, f.rms, f.p95,
                     std::max(std::abs(f.min), std::abs(f.max)));
}

std::string seen_text(double area_mm2, double unseen_mm2, const RegionFigures& region, machine::Reference reference) {
  std::string out = fmt::format("of {:.1f} mm2; without a figure, at the faces of the blank: about {:.1f} mm2\n",
                                area_mm2, unseen_mm2) +
                    region_text(region);
  if (reference == machine::Reference::machine)
    out += "judged by deflection_um: [compensation] reference = \"machine\"\n";
  return out;
}

}  // namespace

VerdictText verdict_text(const CompensationResult& c, const CompensationSettings& asked) {
  return verdict_of(c, asked);
}

VerdictText verdict_text(const Verification& v, const CompensationSettings& asked) { return verdict_of(v, asked); }

std::string outlook_sentence(const compensate::Outlook& outlook) {
  return fmt::format("95th percentile as given {:.2f} um; shifts are expected to leave {:.2f} um", outlook.given_p95_um,
                     outlook.achievable_p95_um);
}

std::string verify_text(const Verification& v, double compute_s) {
  std::string out = plain_head() + plain_row("error", v.plain.error_um) +
                    plain_row(" deflection", v.plain.deflection_um) + plain_row(" contour", v.plain.contour_um);
  if (v.plain.total_um) out += plain_row("against part", *v.plain.total_um);
  out += seen_text(v.plain.error_um.area_mm2, v.unseen_mm2, {v.border_mm2, v.not_judged_mm2, v.between}, v.reference);
  out += plain_row("judged, now", compensate::judged_of(v.plain, v.reference)) +
         plain_row("judged, by compensate", v.recorded_um);
  return out + fmt::format(
                   "gouge depth: {:.2f} um (single points {:.2f} um); limit {:.4g} um\n"
                   "machine time {:.1f} s; computed in {:.1f} s\n",
                   v.depth.gouge_depth_p999_um, v.depth.deepest_um, v.depth_limit_um, v.machine_time_s, compute_s);
}

std::string plain_figures_text(const CompensationResult& c) {
  std::string out = plain_head();
  const auto rows = [&](const std::string& name, auto part) {
    out += plain_row(name + ", before", part(c.figures.plain_before)) +
           plain_row(name + ", after", part(c.figures.plain_after));
  };
  rows("error", [](const auto& p) { return p.error_um; });
  rows(" deflection", [](const auto& p) { return p.deflection_um; });
  if (c.figures.plain_before.part_um && c.figures.plain_after.part_um) {
    rows("  tool", [](const auto& p) { return *p.tool_um; });
    rows("  workpiece", [](const auto& p) { return *p.part_um; });
  }
  out += plain_row(" contour", c.figures.plain_after.contour_um);
  if (c.figures.plain_after.total_um) rows("against part", [](const auto& p) { return *p.total_um; });
  return out + seen_text(c.figures.plain_after.error_um.area_mm2, c.figures.unseen_mm2,
                         {c.figures.border_mm2, c.figures.not_judged_mm2, c.figures.between}, c.scope.reference);
}

}  // namespace camber::report
