#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "checks/setup_checks.h"
#include "nc/known_places.h"
#include "plausibility/rules.h"

namespace camber::plausibility {

namespace {

/// A stock roughed along the path (allowance_mm) of whose top nothing is left anywhere, however high it was.
void look_at_roughed_top(const Evidence& e, Diagnostics& diagnostics) {
  constexpr double kOdd_mm = 3, kOfDiameter = 0.5;
  if (!e.survey || e.job.stock.allowance_mm <= 0 || e.survey->allowance_mm3 <= 0) return;
  double least = kOdd_mm;
  for (const ToolWork& work : e.tools) least = std::max(least, kOfDiameter * work.tool->diameter_mm);
  const removal::HeightMap& left = e.survey->machined;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < left.rows(); ++j)
    for (std::size_t i = 0; i < left.columns(); ++i) highest = std::max(highest, left.at(i, j));
  const double top = e.stock->max_mm.z();
  if (top - highest < least) return;
  diagnostics.add(e.at_job(
      Severity::warning,
      fmt::format("the stock's top is at Z{:g}, but nothing of it is left above Z{:.2f}: the cut before, of which "
                  "allowance_mm = {:g} tells, takes {:.1f} mm off everywhere; a stock of which the path leaves the top "
                  "somewhere was expected (is it too high?)",
                  top, highest, e.job.stock.allowance_mm, top - highest),
      "stock-top"));
}

/// Returns how far the stock would have to lie elsewhere, mm, where the path stands out of it on one side by more than
/// the tool that mills most, as runs in and out may, and leaves some of it on the other.
Vec3 lies_aside_mm(const Evidence& e, const nc::Extents& tips) {
  const double clear_mm = std::ranges::max_element(e.tools, {}, &ToolWork::milling_mm)->tool->diameter_mm;
  Vec3 out = Vec3::Zero();
  for (const Eigen::Index a : {0, 1}) {
    const double below = e.stock->min_mm[a] - tips.min_mm[a], above = tips.max_mm[a] - e.stock->max_mm[a];
    if (std::max(below, above) > clear_mm && std::min(below, above) < 0) out[a] = (above - below) / 2;
  }
  return out;
}

}  // namespace

void look_at_stock_top(const Evidence& e, Diagnostics& diagnostics) {
  if (!e.stock || e.elsewhere || e.program.turns()) return;
  constexpr double kSame_mm = 0.05;
  // The highest place of which the program says where it is.
  nc::KnownPlaces places(e.program.text(), e.program.moves_in_part());
  double highest = -std::numeric_limits<double>::infinity();
  std::uint32_t where = 0;
  for (std::uint32_t i = 0; i < e.program.moves_in_part().moves.size(); ++i) {
    const nc::Move& m = e.program.moves_in_part().moves[i];
    if (!places.next(m).end || m.reference || m.kind == nc::MoveKind::dwell || m.end_mm.z() <= highest) continue;
    highest = m.end_mm.z();
    where = i;
  }
  const double top = e.stock->max_mm.z();
  if (!std::isfinite(highest) || highest >= top - kSame_mm) return look_at_roughed_top(e, diagnostics);
  diagnostics.add(
      e.at_move(e.error_of(0, {}, true), where,
                fmt::format("the program rises to Z{:g} at most, but the stock's top is at Z{:g}; a program "
                            "that comes clear of the stock was expected (is the stock too high, or its zero "
                            "another one?)",
                            highest, top),
                "stock-top"));
}

void look_at_stock_place(const Evidence& e, Diagnostics& diagnostics) {
  // Runs in and out are long beside small cuts.
  constexpr double kOddAside = 0.2, kOdd = 0.5, kMeaningless = 0.75;
  if (!e.survey || e.elsewhere) return;
  double beside = 0, all = 0;
  for (const ToolWork& work : e.tools) beside += work.cut.beside_mm, all += work.cut.length_mm - work.cut.approach_mm;
  if (all <= 0 || beside <= kOddAside * all) return;
  const auto longest = std::ranges::max_element(e.survey->moves, {}, [](const auto& m) { return m.beside_mm; });
  const nc::Extents tips = checks::tip_extents(e.program.moves_in_part(), e.program.selected, e.program.holes);
  const Vec3 &lo = e.stock->min_mm, &hi = e.stock->max_mm, aside = lies_aside_mm(e, tips);
  if (beside <= kOdd * all && aside.isZero()) return;
  diagnostics.add(e.at_move(
      beside > kMeaningless * all ? e.error_of(0, {}, true) : Severity::warning,
      static_cast<std::uint32_t>(longest - e.survey->moves.begin()),
      fmt::format(
          "{:.0f} % of the cutting path runs beside or above the stock: the tip cuts from X{:.2f} Y{:.2f} Z{:.2f} "
          "to X{:.2f} Y{:.2f} Z{:.2f}, the stock lies from X{:.2f} Y{:.2f} Z{:.2f} to X{:.2f} Y{:.2f} Z{:.2f}; a "
          "stock around the path{} was expected",
          100 * beside / all, tips.min_mm.x(), tips.min_mm.y(), tips.min_mm.z(), tips.max_mm.x(), tips.max_mm.y(),
          tips.max_mm.z(), lo.x(), lo.y(), lo.z(), hi.x(), hi.y(), hi.z(),
          aside.isZero() ? "" : fmt::format(", elsewhere by X{:.2f} Y{:.2f},", aside.x(), aside.y())),
      "stock-place"));
}

void look_at_removal(const Evidence& e, Diagnostics& diagnostics) {
  constexpr double kNothingLeft = 0.97;
  if (!e.survey || e.elsewhere || e.survey->blank_mm3 <= 0) return;
  const double removed = (e.survey->removed_mm3 + e.survey->allowance_mm3) / e.survey->blank_mm3;
  if (removed < kNothingLeft) return;
  diagnostics.add(e.at_job(Severity::warning,
                           fmt::format("the program removes {:.1f} % of the stock; a stock of which a part is left was "
                                       "expected (is it too small, or a tool too large?)",
                                       100 * removed),
                           "stock-left"));
}

void look_at_allowance(const Evidence& e, Diagnostics& diagnostics) {
  constexpr double kOfDiameter = 0.2, kMost_mm = 2, kLeast_mm = 0.02;
  const double allowance = e.job.stock.allowance_mm;
  // A cut before that meets nothing is an error of its own.
  if (allowance <= 0 || (e.survey && e.survey->allowance_mm3 == 0) || e.tools.empty()) return;
  double diameter = std::numeric_limits<double>::infinity();
  for (const ToolWork& work : e.tools)
    if (work.mills) diameter = std::min(diameter, work.tool->diameter_mm);
  const double most = std::min(kMost_mm, kOfDiameter * diameter);
  if (allowance >= kLeast_mm && allowance <= most) return;
  diagnostics.add(e.at_job(Severity::warning,
                           fmt::format("allowance_mm = {:g} is not what a pass before leaves for a cutter of {:g} mm; "
                                       "{:g} to {:.2g} mm was expected",
                                       allowance, diameter, kLeast_mm, most),
                           "allowance-size"));
}

}  // namespace camber::plausibility
