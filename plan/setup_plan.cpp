#include "plan/setup_plan.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "base/stage.h"
#include "base/triangle_mesh.h"
#include "plan/part_of_stock.h"
#include "plan/stock_solid.h"

namespace camber::plan {
namespace {

/// STEP files say their unit themselves.
TriangleSolid read_solid(const std::string& path, double mm_per_unit) {
  const TriangleMesh mesh = read_mesh(path);
  if (const std::size_t open = mesh.open_edges(); open > 0)
    fail_on_file(path,
                 fmt::format("the mesh has {} edges without exactly two triangles; a closed solid was expected", open),
                 "stl-open");
  TriangleSolid out = solid_of(mesh);
  if (!is_step_file(path))
    for (Vec3& p : out.points) p *= mm_per_unit;
  return out;
}

removal::Stock load_stock(const std::string& path, const PlanInput& input) {
  constexpr double kBand = 3;  // voxels
  return removal::Stock::load(path, input.simulation.voxel_mm, kBand);
}

/// With its holes filled where it comes as a stock.
PartOfStock read_part(const PlanInput& input, const SolidBounds& blank) {
  if (!is_stock_file(input.part_path)) return {read_solid(input.part_path, input.mm_per_unit), {}, {}};
  PartOfStock out = part_of(load_stock(input.part_path, input), blank, input.faces);
  if (out.solid.triangles.empty())
    fail_on_file(input.part_path, "has no material with an upright wall between two levels; a part was expected",
                 "part-missing");
  return out;
}

struct Blank {
  TriangleSolid solid;
  std::array<std::vector<AxisPlane>, 3> planes{};
  double tolerance_mm = 0;
};

Blank read_blank(const PlanInput& input) {
  const machine::StockDescription& b = input.blank;
  if (b.box) return {.solid = solid_of(*b.box)};
  if (b.cylinder) return {.solid = solid_of(*b.cylinder)};
  if (!b.mesh.empty()) return {.solid = read_solid(b.mesh, input.mm_per_unit)};
  constexpr double kHalf = 0.6;  // voxels
  StockBlank from = blank_of(load_stock(b.vdb, input), input.faces);
  return {.solid = std::move(from.solid),
          .planes = std::move(from.planes),
          .tolerance_mm = kHalf * input.simulation.voxel_mm};
}

/// Volume that the best plans of earlier set-ups machine, seen from a later one.
class Machined {
 public:
  Machined(const SetupPlan& earlier, const Eigen::Matrix3d& later_turn)
      : earlier_(&earlier), turn_(later_turn * earlier.setup.turn.transpose()) {
    const PlannedDivision& plan = earlier.plans[earlier.best];
    goes_.assign(earlier.removal.grid.size(), false);
    for (const PlanOperation& o : plan.operations) {
      const VolumePrimitive& p = plan.primitives[plan.order.steps[o.primitive - 1].primitive];
      if (p.is_hole) holes_.push_back(earlier.removal.holes[p.hole]);
      for (const CellIndex& c : p.cells) goes_[earlier.removal.grid.place(c)] = true;
    }
  }

  bool quarter_turns() const {
    constexpr double kNear = 1e-9;
    return (turn_.array().abs() < kNear || (turn_.array().abs() - 1).abs() < kNear).all();
  }

  bool holds(const Vec3& later) const {
    const Vec3 at = turn_.transpose() * later;
    for (const Hole& h : holes_)
      if ((Vec2(at.x(), at.y()) - h.centre_mm).norm() < h.diameter_mm / 2 && at.z() > h.tip_mm && at.z() < h.top_mm)
        return true;
    const CellGrid& g = earlier_->removal.grid;
    CellIndex c;
    for (int a = 0; a < 3; ++a) {
      int i = -1;
      while (i < g.count(a) && g.plane_mm(a, i + 1) < at[a]) ++i;
      (a == 0 ? c.x : a == 1 ? c.y : c.z) = i;
    }
    return g.holds(c) && goes_[g.place(c)];
  }

  void add_planes(std::array<std::vector<AxisPlane>, 3>& planes) const {
    const CellGrid& g = earlier_->removal.grid;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        if (std::abs(turn_(b, a)) > 0.5)
          for (int i = 0; i <= g.count(a); ++i)
            planes[static_cast<std::size_t>(b)].push_back(
                {turn_(b, a) * g.plane_mm(a, i), g.plane(a, i).area_mm2, false});
  }

 private:
  const SetupPlan* earlier_;
  Eigen::Matrix3d turn_;
  std::vector<bool> goes_;
  std::vector<Hole> holes_;
};

void check_shapes(const RemovalVolume& removal, const PlanInput& input, Diagnostics& diagnostics) {
  const double blank = removal.blank_mm3;
  constexpr double kOutside = 1e-4;
  if (removal.outside_mm3 > kOutside * removal.part_mm3)
    fail_on_file(input.path,
                 fmt::format("{:.4g} mm3 of the part {} are outside the blank; a part within it was expected",
                             removal.outside_mm3, input.part_path),
                 "part-outside-blank");
  if (removal.cells_mm3 + removal.holes_mm3 <= 1e-6 * blank)
    fail_on_file(input.path, fmt::format("the blank is the part {}; nothing is to be removed", input.part_path),
                 "nothing-to-remove");
  constexpr double kBalance = 1e-3;
  if (std::abs(removal.balance()) > kBalance)
    diagnostics.add({Severity::warning,
                     {input.path, 0, 0},
                     fmt::format("the volumes found are {:+.2f} % off blank minus part, {:.6g} mm3; at most 0.1 % was "
                                 "expected",
                                 100 * removal.balance(), removal.removal_mm3()),
                     "volume-balance",
                     {}});
}

/// Diameter; 0: there is none.
double narrowest_mill_mm(const PlanTools& tools) {
  double out = 0;
  for (const auto& [number, t] : tools)
    if (t.use == ToolUse::end_mill || t.use == ToolUse::face_mill)
      out = out > 0 ? std::min(out, t.tool.diameter_mm) : t.tool.diameter_mm;
  return out;
}

RemovalVolume removal_of(const PlanInput& input, const Blank& blank, const TriangleSolid& part,
                         const std::vector<Hole>& holes, const std::vector<TriangleSolid>& fixtures,
                         const Eigen::Matrix3d& turn, const std::vector<Machined>& machined) {
  RemovalInput in{.blank = turned(blank.solid, turn), .part = part, .part_holes = holes, .faces = input.faces};
  for (const TriangleSolid& f : fixtures) in.fixtures.push_back(turned(f, turn));
  in.narrowest_mm = narrowest_mill_mm(input.tools);
  // Outlines of layers thinner than a voxel are those of edges that the field rounds.
  constexpr double kEdges = 0.2;
  if (is_stock_file(input.part_path))
    in.faces.plane_tolerance_mm = std::max(in.faces.plane_tolerance_mm, kEdges * input.simulation.voxel_mm);
  in.blank_planes = blank.planes;
  if (blank.tolerance_mm > 0) in.tolerance_mm = blank.tolerance_mm;
  for (const Machined& m : machined) m.add_planes(in.machined_planes);
  if (!machined.empty())
    in.machined = [&](const Vec3& at) {
      return std::ranges::any_of(machined, [&](const Machined& m) { return m.holds(at); });
    };
  return removal_volume(in);
}

SetupPlan plan_setup(const PlanInput& input, const Blank& blank, const PartOfStock& part,
                     const std::vector<TriangleSolid>& fixtures, const PartSetup& setup,
                     const std::vector<Machined>& machined) {
  const TriangleSolid lying = turned(part.solid, setup.turn);
  SetupPlan out{setup,
                turned(blank.solid, setup.turn),
                part.drilled.triangles.empty() ? lying : turned(part.drilled, setup.turn),
                removal_of(input, blank, lying, part.holes, fixtures, setup.turn, machined),
                {},
                0};
  std::vector<PlanFigures> figures;
  Stage stage("planning", kDivisionPlans.size());
  for (const DivisionPlan division : kDivisionPlans) {
    out.plans.push_back(plan_division(input, out.removal, division));
    const PlannedDivision& p = out.plans.back();
    figures.push_back({p.complete(), p.nominal_time_s, p.tool_changes, p.form_error_p95_mm});
    stage.advance();
  }
  out.best = best_plan(figures);
  return out;
}

}  // namespace

PlanResult make_plan(const PlanInput& input, Diagnostics& diagnostics) {
  const Blank blank = read_blank(input);
  const PartOfStock part = read_part(input, blank.solid.bounds());
  std::vector<TriangleSolid> fixtures;
  for (const std::string& path : input.fixture_paths) fixtures.push_back(read_solid(path, input.mm_per_unit));
  PlanResult out;
  out.setups.reserve(input.setups.size());
  out.removal_mm3 = volume_mm3(blank.solid) - volume_mm3(part.solid);
  for (const Hole& h : part.holes) out.removal_mm3 += h.volume_mm3;
  for (const PartSetup& setup : input.setups) {
    std::vector<Machined> machined;
    for (const SetupPlan& earlier : out.setups) machined.emplace_back(earlier, setup.turn);
    for (const Machined& m : machined)
      if (!m.quarter_turns())
        fail_on_file(input.path,
                     fmt::format("[[setup]] \"{}\" is not turned from the first one by quarter turns about the axes; "
                                 "that was expected of every set-up but the first",
                                 setup.name),
                     "setup-turn");
    if ((!blank.planes[2].empty() || is_stock_file(input.part_path)) && !setup.turn.isIdentity())
      fail_on_file(input.path,
                   fmt::format("a {} from a stock.vdb is not turned; a set-up without turn was expected",
                               blank.planes[2].empty() ? "part" : "blank"),
                   "setup-turn");
    out.setups.push_back(plan_setup(input, blank, part, fixtures, setup, machined));
    if (out.setups.size() == 1) check_shapes(out.setups.front().removal, input, diagnostics);
  }
  return out;
}

}  // namespace camber::plan
