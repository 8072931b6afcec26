#include "checks/setup_checks.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "base/triangle_mesh.h"
#include "base/units.h"
#include "kinematics/joint_map.h"
#include "motion/job_checks.h"
#include "motion/operations.h"

namespace camber::checks {
namespace {

constexpr double kSimilar = 0.3;  // of the common volume or area of two boxes: they are meant for each other
constexpr double kFarther = 100;  // times less common volume without the factor

std::string point_text(const Vec3& p) { return fmt::format("X{:.2f} Y{:.2f} Z{:.2f}", p.x(), p.y(), p.z()); }

std::string size_text(const machine::Box& b) {
  const Vec3 size = b.max_mm - b.min_mm;
  return fmt::format("{:.2f} x {:.2f} x {:.2f} mm", size.x(), size.y(), size.z());
}

std::string where_text(const Places& p) {
  return fmt::format("the tip of the tool cuts from {} to {}, the stock lies from {} to {}", point_text(p.tip.min_mm),
                     point_text(p.tip.max_mm), point_text(p.stock.min_mm), point_text(p.stock.max_mm));
}

machine::Box scaled(const machine::Box& box, double factor) { return {factor * box.min_mm, factor * box.max_mm}; }
machine::Box tip_box(const Places& p) { return {p.tip.min_mm, p.tip.max_mm}; }

/// Common part over both together, along the first `axes` axes.
double common_fraction(const machine::Box& a, const machine::Box& b, int axes) {
  double both = 1, of_a = 1, of_b = 1;
  for (int i = 0; i < axes; ++i) {
    both *= std::max(0.0, std::min(a.max_mm[i], b.max_mm[i]) - std::max(a.min_mm[i], b.min_mm[i]));
    of_a *= a.max_mm[i] - a.min_mm[i];
    of_b *= b.max_mm[i] - b.min_mm[i];
  }
  const double sum = of_a + of_b - both;
  return sum > 0 ? both / sum : 0;
}

/// 25.4 or 1 / 25.4 where `box` times it lies like `other` but does not without it.
std::optional<double> unit_factor(const machine::Box& box, const machine::Box& other, int axes) {
  const double as_it_is = common_fraction(box, other, axes);
  for (const double factor : {kMmPerInch, 1 / kMmPerInch}) {
    const double then = common_fraction(scaled(box, factor), other, axes);
    if (then >= kSimilar && as_it_is < then / kFarther) return factor;
  }
  return std::nullopt;
}

/// Whether a cutter whose tip stays in the box can touch the stock. It reaches up as far as one likes.
bool can_meet(const machine::Box& tip, double radius, const machine::Box& stock) {
  for (int a = 0; a < 2; ++a)
    if (tip.min_mm[a] - radius >= stock.max_mm[a] || tip.max_mm[a] + radius <= stock.min_mm[a]) return false;
  return tip.min_mm.z() < stock.max_mm.z();
}

/// Whether the tips' box times the factor would be a program for this stock: there, and about as large.
bool would_fit(const Places& p, double factor) {
  const machine::Box tip = scaled(tip_box(p), factor);
  if (!can_meet(tip, p.radius_mm, p.stock) || tip.min_mm.z() < p.stock.min_mm.z() - p.radius_mm) return false;
  const Vec3 size = tip.max_mm - tip.min_mm, stock = p.stock.max_mm - p.stock.min_mm;
  const auto alike = [](double a, double b) { return a >= kSimilar * b && a <= b / kSimilar; };
  return alike(size.x(), stock.x()) || alike(size.y(), stock.y());
}

std::string factor_text(const Places& p) {
  if (would_fit(p, kMmPerInch))
    return "; the program would fit at 25.4 times its size: are its figures inches (G20, units = \"inch\")?";
  if (would_fit(p, 1 / kMmPerInch)) return "; the stock would fit at 25.4 times its size: is it in inches?";
  return "; moves through the stock were expected";
}

void add(Severity severity, const std::string& file, std::string message, const char* check, Diagnostics& diagnostics) {
  diagnostics.add({severity, {file, 0, 0}, std::move(message), check, {}});
}

}  // namespace

std::optional<machine::Box> stock_box(const machine::Job& job) {
  if (job.stock.box) return job.stock.box;
  if (!job.stock.mesh.empty()) return box_of(read_mesh(job.stock.mesh));
  if (!job.stock.cylinder) return std::nullopt;
  const machine::Cylinder& c = *job.stock.cylinder;
  const double r = c.diameter_mm / 2;
  return machine::Box{c.base_mm - Vec3(r, r, 0), c.base_mm + Vec3(r, r, c.height_mm)};
}

machine::Box box_of(const TriangleMesh& mesh) {
  machine::Box out{mesh.points.front().cast<double>(), mesh.points.front().cast<double>()};
  for (const auto& p : mesh.points) {
    out.min_mm = out.min_mm.cwiseMin(p.cast<double>());
    out.max_mm = out.max_mm.cwiseMax(p.cast<double>());
  }
  return out;
}

nc::Extents tip_extents(const nc::Interpretation& moves, const std::vector<bool>& selected,
                        const std::vector<removal::HoleMove>& holes) {
  nc::Extents out;
  for (std::size_t i = 0; i < moves.moves.size(); ++i) {
    if (!selected[i] && !removal::makes_hole(holes[i])) continue;
    const nc::Extents box = nc::extents_of(moves, moves.moves[i]);
    out.add(box.min_mm);
    out.add(box.max_mm);
  }
  return out;
}

std::vector<int> cutting_tools(const nc::Interpretation& moves, const std::vector<bool>& selected,
                               const std::vector<removal::HoleMove>& holes) {
  std::set<int> out;
  for (std::size_t i = 0; i < moves.moves.size(); ++i)
    if (selected[i] || removal::makes_hole(holes[i])) out.insert(moves.state_of(moves.moves[i]).tool);
  return {out.begin(), out.end()};
}

void report_nothing_removed(const std::string& program, const Places& places, Diagnostics& diagnostics) {
  add(Severity::error, program, fmt::format("nothing is removed: {}{}", where_text(places), factor_text(places)),
      "nothing-removed", diagnostics);
}

void check_places(const std::string& program, const Places& places, Diagnostics& diagnostics) {
  if (places.tip.empty()) return;
  if (!can_meet(tip_box(places), places.radius_mm, places.stock))
    return report_nothing_removed(program, places, diagnostics);
  const auto factor = unit_factor(tip_box(places), places.stock, 2);
  if (!factor) return;
  if (*factor < 1)
    add(Severity::error, program,
        fmt::format("the stock is as large as the program at 25.4 times its size: {}; a stock in mm was expected",
                    where_text(places)),
        "stock-units", diagnostics);
  else
    add(Severity::warning, program,
        fmt::format("the program is as large as the stock at 25.4 times its size: {}; are its figures inches (G20, "
                    "units = \"inch\")?",
                    where_text(places)),
        "program-units", diagnostics);
}

void check_part_size(const std::string& part, const machine::Box& mesh, const machine::Box& stock,
                     Diagnostics& diagnostics) {
  const auto factor = unit_factor(mesh, stock, 3);
  if (!factor) return;
  add(Severity::error, part,
      fmt::format("the part is as large as the stock at {} its size: the part is {}, the stock {}; a mesh in mm was "
                  "expected",
                  *factor > 1 ? "25.4 times" : "1/25.4 of", size_text(mesh), size_text(stock)),
      "part-units", diagnostics);
}

void report_allowance(const machine::Job& job, Diagnostics& diagnostics) {
  add(Severity::error, job.path,
      fmt::format("allowance_mm = {:g}: the cut before, with the cutter smaller by this much, removes nothing from the "
                  "stock; an allowance smaller than the depth of cut was expected",
                  job.stock.allowance_mm),
      "allowance-too-large", diagnostics);
}

double slenderness(const machine::Tool& tool) {
  const double flutes = std::min(tool.flute_length_mm.value_or(tool.overhang_mm), tool.overhang_mm);
  const double neck = tool.neck_diameter_mm > 0 ? std::clamp(tool.neck_length_mm, 0.0, tool.overhang_mm - flutes) : 0;
  const double shank_diameter = tool.shank_diameter_mm > 0 ? tool.shank_diameter_mm : tool.diameter_mm;
  double out = flutes / tool.diameter_mm + (tool.overhang_mm - flutes - neck) / shank_diameter;
  if (neck > 0) out += neck / tool.neck_diameter_mm;
  return out;
}

void check_job(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves,
               Diagnostics& diagnostics) {
  const machine::Operations operations = motion::as_lines(job.operations, program, moves);
  std::vector<bool> selected = removal::selected_moves(moves, operations);
  const auto holes = removal::hole_moves(moves, operations, job.tools);
  for (std::size_t i = 0; i < holes.size(); ++i)
    if (holes[i] != removal::HoleMove::none) selected[i] = false;
  motion::check_cutting(job, program, moves, selected, holes, diagnostics);
  const std::vector<int> tools = cutting_tools(moves, selected, holes);
  const auto stock = stock_box(job);
  // Where rotary axes turn, moves say little of where the tool is: prepare() looks with its poses.
  if (!stock || kinematics::has_rotary_motion(moves, job.machine)) return;
  Places places{tip_extents(moves, selected, holes), 0, *stock};
  for (const int tool : tools)
    if (const auto known = job.tools.find(tool); known != job.tools.end())
      places.radius_mm = std::max(places.radius_mm, known->second.diameter_mm / 2);
  check_places(program.source.name(), places, diagnostics);
  if (!job.part.mesh.empty()) check_part_size(job.part.mesh, box_of(machine::part_mesh(job.part)), *stock, diagnostics);
}

}  // namespace camber::checks
