#include "compensate/verdict.h"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace camber::compensate {
namespace {

constexpr double kWanted = 0.95;      // of the area
constexpr double kWorthNaming = 0.1;  // of the mean square
constexpr std::size_t kLinesNamed = 3;

struct CauseWords {
  const char* what;
  const char* remedy;
};

CauseWords words_of(const CauseFigure& figure) {
  switch (figure.cause) {
    case Cause::correctable:
      return {"could still be corrected by a shift", "more rounds (max_rounds) or a finer voxel_mm"};
    case Cause::guard:
      return {"is given up to keep the depth limit", "a lower feed or a wider band (profile_um)"};
    case Cause::limited:
      return {"is limited by max_shift_mm", "a larger max_shift_mm, a shorter tool or a lower feed"};
    case Cause::short_range:
      return {"changes along the path faster than a smooth shift can (entries, corners)", "a lower feed there"};
    case Cause::opposed:
      return {"is on opposite surfaces that one pass generates", "a finishing pass for each side"};
    case Cause::tip:
      return {"is near the axis of a round tip", "a tilted tool or another path there"};
    case Cause::bow:
      return {"differs along the cutter (helix bow)",
              figure.cut_twice ? "a shorter tool or a lower feed"
                               : "a second cut (lever \"passes\"), a shorter tool or a lower feed"};
    case Cause::not_compensated:
      break;
  }
  return {"is due to moves that are not compensated", "naming them in [compensation] operations"};
}

double part_of(const ErrorSplit& s, Cause cause) {
  switch (cause) {
    case Cause::correctable:
      return s.correctable_um;
    case Cause::guard:
      return s.guard_um;
    case Cause::limited:
      return s.limited_um;
    case Cause::short_range:
      return s.short_range_um;
    case Cause::opposed:
      return s.opposed_um;
    case Cause::tip:
      return s.tip_um;
    case Cause::bow:
      return s.bow_um;
    case Cause::not_compensated:
      break;
  }
  return s.not_compensated_um;
}

double fraction_in_band(const std::vector<double>& error_um, const std::vector<double>& area_mm2,
                        const machine::CompensationSettings& asked) {
  const std::array<double, 2> band = asked.profile_um.value_or(std::array{-asked.tolerance_um, asked.tolerance_um});
  double inside = 0, whole = 0;
  for (std::size_t i = 0; i < error_um.size(); ++i) {
    whole += area_mm2[i];
    if (error_um[i] >= band[0] && error_um[i] <= band[1]) inside += area_mm2[i];
  }
  return whole > 0 ? inside / whole : 1.0;
}

constexpr std::array kCauses{Cause::correctable, Cause::guard, Cause::limited, Cause::short_range,
                             Cause::opposed,     Cause::tip,   Cause::bow,     Cause::not_compensated};

}  // namespace

PlainFigures plain_figures(const std::vector<removal::SurfacePoint>& surface, const std::vector<double>& total_mm,
                           const Observed& observed, const machine::CompensationSettings& asked) {
  std::vector<double> error, deflection, contour, total, judged, area;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!observed.judged(i)) continue;
    const removal::SurfacePoint& p = surface[i];
    error.push_back(1000 * p.error_mm);
    deflection.push_back(1000 * (p.error_mm - p.contour_mm));
    contour.push_back(1000 * p.contour_mm);
    if (!total_mm.empty()) total.push_back(1000 * total_mm[i]);
    judged.push_back(1000 * judged_mm(p, asked.reference));
    area.push_back(p.area_mm2);
  }
  PlainFigures out{removal::error_figures(error, area), removal::error_figures(deflection, area),
                   removal::error_figures(contour, area), std::nullopt, fraction_in_band(judged, area, asked)};
  if (!total_mm.empty()) out.total_um = removal::error_figures(total, area);
  return out;
}

const removal::ErrorFigures& judged_of(const PlainFigures& figures, machine::Reference reference) {
  return reference == machine::Reference::machine ? figures.deflection_um : figures.error_um;
}

bool within_tolerance(const PlainFigures& figures, const machine::CompensationSettings& asked) {
  if (asked.profile_um) return figures.in_band_fraction >= kWanted;
  return judged_of(figures, asked.reference).p95 <= asked.tolerance_um;
}

bool within_tolerance(const std::vector<double>& error_um, const std::vector<double>& area_mm2,
                      const machine::CompensationSettings& asked) {
  if (asked.profile_um) return fraction_in_band(error_um, area_mm2, asked) >= kWanted;
  return removal::error_figures(error_um, area_mm2).p95 <= asked.tolerance_um;
}

std::vector<CauseFigure> causes_of(const ErrorSplit& split, const std::vector<PointCause>& points,
                                   const Observed& observed, const std::vector<std::size_t>& lines) {
  std::map<Cause, std::map<std::size_t, double>> of_lines;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (observed.judged(i) && lines[i] > 0)
      of_lines[points[i].cause][lines[i]] += observed.points[i].area_mm2 * points[i].error_mm * points[i].error_mm;
  // The guard's part has no points of its own: it lies where a shift could correct.
  of_lines[Cause::guard] = of_lines[Cause::correctable];
  double whole = 0;
  for (const Cause cause : kCauses) whole += part_of(split, cause) * part_of(split, cause);
  std::vector<CauseFigure> out;
  for (const Cause cause : kCauses) {
    const double rms = part_of(split, cause);
    if (rms * rms < kWorthNaming * whole || rms <= 0) continue;
    std::vector<std::pair<double, std::size_t>> worst;
    for (const auto& [line, sum] : of_lines[cause]) worst.emplace_back(-sum, line);
    std::sort(worst.begin(), worst.end());
    CauseFigure figure{cause, rms, {}};
    for (std::size_t i = 0; i < std::min(kLinesNamed, worst.size()); ++i) figure.lines.push_back(worst[i].second);
    std::sort(figure.lines.begin(), figure.lines.end());
    out.push_back(std::move(figure));
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.rms_um > b.rms_um; });
  return out;
}

std::string sentence(const CauseFigure& c) {
  const CauseWords words = words_of(c);
  const std::string where =
      c.lines.empty() ? ""
                      : fmt::format(", most in line{} {}", c.lines.size() > 1 ? "s" : "", fmt::join(c.lines, ", "));
  return fmt::format("{:.2f} um rms {}{}; {} would remove it", c.rms_um, words.what, where, words.remedy);
}

}  // namespace camber::compensate
