#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/triangle_mesh.h"
#include "checks/setup_checks.h"
#include "plausibility/evidence.h"
#include "plausibility/rules.h"

namespace camber::plausibility {
namespace {

std::string shift_text(const Vec3& s) {
  std::string out;
  constexpr double kCounts_mm = 0.05;
  for (int a = 0; a < 3; ++a)
    if (std::abs(s[a]) >= kCounts_mm) out += fmt::format("{}{}{:.2f}", out.empty() ? "" : " ", "XYZ"[a], s[a]);
  return out;
}

constexpr double kOut_mm = 0.1;  // of the stock, that a part may be

/// "+X by 1.00 mm": where a part that would fit into the stock stands out of its sides. A stock that is smaller than
/// the part is a region of it.
std::string sides_out(const machine::Box& part, const machine::Box& stock) {
  std::string out;
  for (int a = 0; a < 2; ++a) {
    if (part.max_mm[a] - part.min_mm[a] > stock.max_mm[a] - stock.min_mm[a] + kOut_mm) continue;
    const double below = stock.min_mm[a] - part.min_mm[a], above = part.max_mm[a] - stock.max_mm[a];
    if (std::max(below, above) > kOut_mm)
      out += fmt::format("{}{}{} by {:.2f} mm", out.empty() ? "" : " and ", below > above ? '-' : '+', "XYZ"[a],
                         std::max(below, above));
  }
  return out;
}

}  // namespace

void look_at_part(const Evidence& e, Diagnostics& diagnostics) {
  if (e.job.part.mesh.empty() || e.program.moves_in_part().moves.empty()) return;
  const removal::PartMesh part(closed_mesh(machine::part_mesh(e.job.part), e.job.part.mesh));
  if (e.stock) {
    const std::size_t before = diagnostics.errors();
    checks::check_part_size(e.job.part.mesh, {part.min_mm(), part.max_mm()}, *e.stock, diagnostics);
    if (diagnostics.errors() > before) return;
  }
  const PartFit fit = fit_part(e.job, e.program, part);
  if (fit.places.empty()) return;
  constexpr double kClear_mm = 0.5;
  const std::string fits = fit.shift_mm ? fmt::format("; the part moved by {} fits", shift_text(*fit.shift_mm)) : "";
  const bool shifted = fit.shift_mm && fit.cutting_in > kCuttingIn;
  if (fit.gouging > kGouging || shifted)
    diagnostics.add(e.at_move(
        Severity::error, fit.gouge_move,
        fmt::format("the cutters cut into {} along {:.0f} % of their path, by up to {:.2f} mm here{}; a part that the "
                    "path leaves was expected (its place, its size, another part, another tool?)",
                    e.job.part.mesh, 100 * std::max(fit.gouging, fit.cutting_in), fit.gouge_mm, fits),
        "part-place"));
  else if (fit.nearest_mm > kClear_mm)
    diagnostics.add(Diagnostic{
        Severity::warning,
        {e.job.part.mesh, 0, 0},
        fmt::format("no cutter comes nearer to the part than {:.2f} mm{}; finishing passes that touch it were expected "
                    "(its place, another part, another tool?)",
                    fit.nearest_mm, fits),
        "part-place",
        {}});
}

void look_at_part_in_stock(const Evidence& e, Diagnostics& diagnostics) {
  if (e.job.part.mesh.empty() || !e.stock || !e.job.stock.vdb.empty()) return;
  constexpr double kCells = 300;
  const TriangleMesh mesh = machine::part_mesh(e.job.part);
  const machine::Box box = checks::box_of(mesh);
  if (const std::string sides = sides_out(box, *e.stock); !sides.empty())
    diagnostics.add(Diagnostic{
        Severity::warning,
        {e.job.part.mesh, 0, 0},
        fmt::format("the part stands out of the stock towards {}, though it would fit in; a stock that holds the part "
                    "was expected (the place of either?)",
                    sides),
        "part-in-stock",
        {}});
  const Vec3 size = box.max_mm - box.min_mm;
  const removal::HeightMap part(mesh, std::max({size.x(), size.y(), 1e-3}) / kCells);
  const std::optional<removal::HeightMap> stock = checks::stock_heights(e.job, part.cell_mm());
  if (!stock) return;
  double most = 0;
  Vec2 where = Vec2::Zero();
  for (std::size_t j = 0; j < part.rows(); ++j)
    for (std::size_t i = 0; i < part.columns(); ++i) {
      const Vec2 p = part.centre(i, j);
      const Vec2 from = (p - stock->min_mm().head<2>()) / stock->cell_mm();
      if (from.x() < 1 || from.y() < 1) continue;
      const auto column = static_cast<std::size_t>(from.x()), row = static_cast<std::size_t>(from.y());
      if (column + 1 >= stock->columns() || row + 1 >= stock->rows()) continue;
      // Between the cells of steep sides.
      double top = stock->at(column, row);
      for (std::size_t r = row - 1; r <= row + 1; ++r)
        for (std::size_t c = column - 1; c <= column + 1; ++c) top = std::max(top, stock->at(c, r));
      const double out = part.at(i, j) - top;
      if (out > most) most = out, where = p;
    }
  if (most <= kOut_mm) return;
  diagnostics.add(
      Diagnostic{Severity::warning,
                 {e.job.part.mesh, 0, 0},
                 fmt::format("the part rises out of the stock by up to {:.2f} mm, at X{:.2f} Y{:.2f}; a stock "
                             "that holds the part was expected",
                             most, where.x(), where.y()),
                 "part-in-stock",
                 {}});
}

}  // namespace camber::plausibility
