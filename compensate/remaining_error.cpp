#include "compensate/remaining_error.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace camber::compensate {
namespace {

constexpr double kWanted = 0.95;      // of the area
constexpr double kWorthNaming = 0.1;  // of the mean square
constexpr std::size_t kLinesNamed = 3;

const char* words_of(ContourCause cause) {
  switch (cause) {
    case ContourCause::none:
      break;
    case ContourCause::lag:
      return "changes along the path faster than a smooth shift can: servo lag";
    case ContourCause::path_tolerance:
      return "changes along the path faster than a smooth shift can: the control's path tolerance";
    case ContourCause::corner_law:
      return "changes along the path faster than a smooth shift can: corners that are passed without a stop";
  }
  return "changes along the path faster than a smooth shift can (entries, corners)";
}

const char* words_of(const CauseFigure& figure) {
  switch (figure.cause) {
    case Cause::correctable:
      return "could still be corrected by a shift";
    case Cause::guard:
      return "is given up to keep the depth limit";
    case Cause::bounded:
      return "is given up so that no place becomes worse than given";
    case Cause::limited:
      return "is limited by max_shift_mm";
    case Cause::short_range:
      return words_of(figure.contour);
    case Cause::opposed:
      return "is on opposite surfaces that one pass generates";
    case Cause::tip:
      return "is near the axis of a round tip";
    case Cause::bow:
      return "differs along the cutter (helix bow)";
    case Cause::not_compensated:
      break;
  }
  return "is due to moves that are not compensated";
}

double part_of(const ErrorSplit& s, Cause cause) {
  switch (cause) {
    case Cause::correctable:
      return s.correctable_um;
    case Cause::guard:
      return s.guard_um;
    case Cause::bounded:
      return s.bounded_um;
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

constexpr std::array kCauses{Cause::correctable, Cause::guard,       Cause::bounded,
                             Cause::limited,     Cause::short_range, Cause::opposed,
                             Cause::tip,         Cause::bow,         Cause::not_compensated};

}  // namespace

PlainFigures plain_figures(const std::vector<removal::SurfacePoint>& surface, const std::vector<double>& total_mm,
                           const Observed& observed, const machine::CompensationSettings& asked) {
  std::vector<double> error, deflection, contour, total, judged, area, tool, part;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!observed.judged(i)) continue;
    const removal::SurfacePoint& p = surface[i];
    if (!p.valid) continue;
    error.push_back(1000 * p.error_mm);
    deflection.push_back(1000 * (p.error_mm - p.contour_mm));
    contour.push_back(1000 * p.contour_mm);
    part.push_back(1000 * static_cast<double>(p.part_mm));
    tool.push_back(deflection.back() - part.back());
    if (!total_mm.empty()) total.push_back(1000 * total_mm[i]);
    judged.push_back(1000 * judged_mm(p, asked.reference));
    area.push_back(p.area_mm2);
  }
  PlainFigures out;
  out.error_um = removal::error_figures(error, area);
  out.deflection_um = removal::error_figures(deflection, area);
  out.contour_um = removal::error_figures(contour, area);
  out.in_band_fraction = fraction_in_band(judged, area, asked);
  if (std::ranges::any_of(part, [](double v) { return v != 0; })) {
    out.tool_um = removal::error_figures(tool, area);
    out.part_um = removal::error_figures(part, area);
  }
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

double p95_of(const std::vector<double>& error_um, const std::vector<double>& area_mm2) {
  return error_um.empty() ? 0 : removal::error_figures(error_um, area_mm2).p95;
}

ContourCause contour_cause_of(Cause cause, const std::vector<PointCause>& points,
                              const std::vector<removal::SurfacePoint>& surface) {
  constexpr double kMost = 0.5;
  double error = 0, lag = 0, tolerance = 0, corner = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const removal::SurfacePoint& p = surface[i];
    if (points[i].cause != cause || !p.valid) continue;
    const double of_lag = static_cast<double>(p.lag_mm), of_tolerance = static_cast<double>(p.path_tolerance_mm),
                 rest = p.contour_mm - of_lag - of_tolerance;
    error += p.area_mm2 * points[i].error_mm * points[i].error_mm;
    lag += p.area_mm2 * of_lag * of_lag;
    tolerance += p.area_mm2 * of_tolerance * of_tolerance;
    corner += p.area_mm2 * rest * rest;
  }
  const double most = std::max({lag, tolerance, corner});
  if (most <= 0 || most < kMost * error) return ContourCause::none;
  return most == lag ? ContourCause::lag : most == tolerance ? ContourCause::path_tolerance : ContourCause::corner_law;
}

std::vector<CauseFigure> causes_of(const ErrorSplit& split, const std::vector<PointCause>& points,
                                   const Observed& observed, const std::vector<ProgramLine>& lines) {
  struct OfLine {
    double sum = 0, worst = 0;
    std::size_t emitted = 0;  ///< where the worst point is
  };
  std::map<Cause, std::map<std::size_t, OfLine>> of_lines;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!observed.judged(i) || lines[i].given == 0) continue;
    const double square = observed.points[i].area_mm2 * points[i].error_mm * points[i].error_mm;
    OfLine& of = of_lines[points[i].cause][lines[i].given];
    of.sum += square;
    if (square <= of.worst && of.emitted > 0) continue;
    of.worst = square;
    of.emitted = lines[i].emitted;
  }
  // The guard's part has no points of its own: it lies where a shift could correct.
  of_lines[Cause::guard] = of_lines[Cause::correctable];
  double whole = 0;
  for (const Cause cause : kCauses) whole += part_of(split, cause) * part_of(split, cause);
  std::vector<CauseFigure> out;
  for (const Cause cause : kCauses) {
    const double rms = part_of(split, cause);
    if (rms * rms < kWorthNaming * whole || rms <= 0) continue;
    std::vector<std::pair<double, ProgramLine>> worst;
    for (const auto& [line, of] : of_lines[cause]) worst.push_back({of.sum, {line, of.emitted}});
    std::ranges::stable_sort(worst, std::greater<>(), &std::pair<double, ProgramLine>::first);
    CauseFigure figure{cause, rms};
    for (std::size_t i = 0; i < std::min(kLinesNamed, worst.size()); ++i) figure.lines.push_back(worst[i].second);
    std::ranges::sort(figure.lines, {}, &ProgramLine::given);
    out.push_back(std::move(figure));
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.rms_um > b.rms_um; });
  return out;
}

namespace {

std::string larger(const BindingLimit& limit) {
  return fmt::format("{} = {:.3g}{}", limit.key, limit.binds_no_more_at,
                     limit.own ? fmt::format(" ({:.3g} now)", limit.value) : "");
}

}  // namespace

std::vector<std::string> remedies_of(const CauseFigure& figure, const Tried& tried) {
  std::vector<std::string> out;
  const auto limits = [&](auto... keys) {
    for (const BindingLimit& limit : tried.limits)
      if (((limit.key == keys) || ...) && limit.larger_helps()) out.push_back(larger(limit));
  };
  const auto lower_feed = [&](const char* words) {
    if (!tried.feeds) out.push_back(words);
  };
  switch (figure.cause) {
    case Cause::correctable:
      if (!tried.rounds) out.push_back("more rounds (max_rounds)");
      limits(kAngleGrowthKey);
      break;
    case Cause::guard:
      limits(kOvercutKey, kProfileKey);
      lower_feed("a lower feed");
      break;
    case Cause::bounded:
      out.push_back("a shorter tool");
      lower_feed("a lower feed");
      break;
    case Cause::limited:
      limits(kMaxShiftKey);
      out.push_back("a shorter tool");
      lower_feed("a lower feed");
      break;
    case Cause::short_range:
      if (figure.contour == ContourCause::path_tolerance)
        out.push_back("a smaller path tolerance (G64 P, tolerance_mm of the corner)");
      else
        lower_feed("a lower feed there");
      limits(kAngleGrowthKey);
      break;
    case Cause::opposed:
      out.push_back("a finishing pass for each side");
      break;
    case Cause::tip:
      out.push_back("a tilted tool");
      out.push_back("another path there");
      break;
    case Cause::bow:
      if (!tried.second_cuts) out.push_back("a second cut (lever \"passes\")");
      if (!tried.pass_before) out.push_back("less stock left by the pass before (lever \"allowance\")");
      out.push_back("a shorter tool");
      lower_feed("a lower feed");
      break;
    case Cause::not_compensated:
      out.push_back("naming them in [compensation] operations");
      break;
  }
  return out;
}

std::string lines_text(const std::vector<ProgramLine>& lines) {
  std::vector<std::string> out;
  for (const ProgramLine& line : lines)
    out.push_back(line.emitted == line.given || line.emitted == 0
                      ? fmt::format("{}", line.given)
                      : fmt::format("{} ({} as emitted)", line.given, line.emitted));
  return fmt::format("line{} {}", lines.size() > 1 ? "s" : "", fmt::join(out, ", "));
}

namespace {

/// "a, b or c".
std::string alternatives(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) out += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + words[i];
  return out;
}

}  // namespace

std::string sentence(const CauseFigure& c) {
  return fmt::format(
      "{:.2f} um rms {}{}; {}", c.rms_um, words_of(c), c.lines.empty() ? "" : ", most in " + lines_text(c.lines),
      c.remedies.empty() ? "what was tried does not remove it" : alternatives(c.remedies) + " would remove it");
}

}  // namespace camber::compensate
