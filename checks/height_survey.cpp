#include "checks/height_survey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/triangle_mesh.h"
#include "checks/collision_search.h"
#include "checks/setup_checks.h"
#include "checks/tool_outline.h"
#include "feedmodel/rapid.h"
#include "removal/tool_path.h"

namespace camber::checks {
namespace {

using removal::CutterBottom;
using removal::HeightMap;

/// Error of the steps along a path, of a cell.
constexpr double kStepError = 0.1;

/// The lower face of a part of the tool above its cutter.
struct Disc {
  double radius_mm = 0, height_mm = 0;
  Collision::Part part = Collision::Part::shank;
};

struct SurveyTool {
  SurveyTool(const machine::Tool& tool, const SurveyOptions& options)
      : shape(removal::shape_of(tool)), bottom(shape), cutter_end_mm(checks::cutter_end_mm(tool)) {
    const double tolerance = options.tolerance_mm;
    if (tolerance < shape.radius_mm) smaller.emplace(shape, tolerance);
    double widest = 0;
    for (const OutlineRing& ring : tool_outline(tool, kCollisionStep_mm, 1e6)) {
      narrows = narrows || ring.radius_mm < widest - 1e-9;
      widest = std::max(widest, ring.radius_mm);
      if (ring.part == OutlineRing::Part::cutter) continue;
      const auto part = static_cast<Collision::Part>(ring.part);
      if (!above) above = part;
      const double radius = ring.radius_mm - tolerance;
      if (radius > 0 && (discs.empty() || radius > discs.back().radius_mm))
        discs.push_back({radius, ring.height_mm + tolerance, part});
    }
  }

  removal::CutterShape shape;
  CutterBottom bottom;
  std::optional<CutterBottom> smaller;     ///< by the tolerance
  std::vector<Disc> discs;                 ///< each wider than those below it
  std::optional<Collision::Part> above{};  ///< what follows the flutes
  double cutter_end_mm;
  bool narrows = false;  ///< some part is narrower than one below it
};

class Surveyor {
 public:
  Surveyor(const machine::Job& job, const motion::SimulatedProgram& program, const SurveyOptions& options,
           HeightMap heights)
      : job_(job), program_(program), options_(options), heights_(std::move(heights)) {
    for (const auto& [number, tool] : job.tools) tools_.try_emplace(number, tool, options);
  }

  HeightSurvey run() {
    HeightSurvey out{
        .cell_mm = heights_.cell_mm(), .moves = std::vector<MoveCut>(moves().size()), .machined = heights_};
    out.blank_mm3 = heights_.volume_mm3();
    blank_.emplace(heights_);
    if (job_.stock.allowance_mm > 0) out.allowance_mm3 = cut_up_to_allowance();
    const std::vector<RapidCheck> rapids = rapids_of(program_);
    auto rapid = rapids.begin();
    bool first = true;
    for (std::uint32_t i = 0; i < moves().size(); ++i) {
      for (; rapid != rapids.end() && rapid->move == i; ++rapid) look_at_rapid(*rapid, out);
      if (!cuts(i)) continue;
      if (std::exchange(first, false) && program_.selected[i]) out.starts_in_material = starts_in_material(i);
      cut(i, out);
    }
    for (const MoveCut& m : out.moves) out.removed_mm3 += m.volume_mm3;
    out.machined = std::move(heights_);
    return out;
  }

 private:
  const std::vector<nc::Move>& moves() const { return program_.moves_in_part().moves; }
  static bool upright(const nc::Move& m) {
    return m.kind == nc::MoveKind::linear && (m.end_mm - m.start_mm).head<2>().isZero();
  }
  bool cuts(std::uint32_t i) const { return program_.selected[i] || removal::makes_hole(program_.holes[i]); }
  const SurveyTool* tool_of(std::uint32_t i) const {
    const auto tool = tools_.find(program_.moves_in_part().state_of(moves()[i]).tool);
    return tool == tools_.end() ? nullptr : &tool->second;
  }

  /// Places along a move, its start included.
  template <class Visit>
  void along(const nc::Interpretation& path, std::uint32_t i, const CutterBottom& cutter, const Visit& visit) const {
    const nc::Move& m = path.moves[i];
    const double length = nc::length_mm(path, m);
    double step = cutter.step_mm(kStepError * heights_.cell_mm());
    if (m.kind == nc::MoveKind::arc) {
      const nc::Arc& arc = path.arcs[m.arc];
      const double radius = (m.start_mm - arc.center_mm).norm();
      step = std::min(step, std::sqrt(8 * std::max(radius, 1e-3) * kStepError * heights_.cell_mm()));
    }
    const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(length / step)));
    for (std::size_t k = 0; k <= steps; ++k) {
      const double u = static_cast<double>(k) / static_cast<double>(steps);
      visit(nc::point_at(path, m, u), k == 0 ? 0 : length / static_cast<double>(steps), u);
    }
  }

  double cut_up_to_allowance() {
    double removed = 0;
    const motion::SimulatedProgram& target = options_.target ? *options_.target : program_;
    for (std::uint32_t i = 0; i < target.moves_in_part().moves.size(); ++i) {
      if (!target.selected[i]) continue;
      const auto tool = tools_.find(target.moves_in_part().state_of(target.moves_in_part().moves[i]).tool);
      if (tool == tools_.end() || job_.stock.allowance_mm >= tool->second.shape.radius_mm) continue;
      const CutterBottom smaller(tool->second.shape, job_.stock.allowance_mm);
      along(target.moves_in_part(), i, smaller,
            [&](const Vec3& tip, double, double) { removed += heights_.cut(smaller, tip).volume_mm3; });
    }
    return removed;
  }

  bool starts_in_material(std::uint32_t i) const {
    const SurveyTool* tool = tool_of(i);
    return tool && tool->smaller && heights_.touch(*tool->smaller, moves()[i].start_mm);
  }

  void cut(std::uint32_t i, HeightSurvey& out) {
    const SurveyTool* tool = tool_of(i);
    if (!tool) return;
    MoveCut& m = out.moves[i];
    const double least = kStepError * heights_.cell_mm();
    double& without = program_.selected[i] && upright(moves()[i]) ? m.approach_mm : m.beside_mm;
    Vec3 looked_at = Vec3::Constant(1e9);
    along(program_.moves_in_part(), i, tool->bottom, [&](const Vec3& tip, double step, double) {
      const HeightMap::Cut cut = heights_.cut(tool->bottom, tip);
      m.length_mm += step;
      m.volume_mm3 += cut.volume_mm3;
      m.area_mm2 += cut.area_mm2;
      if (cut.deepest_mm > least)
        m.cutting_mm += step;
      else if (step > 0 && !blank_->touch(tool->bottom, tip))
        without += step;
      if (cut.deepest_mm > m.deepest_mm) m.deepest_mm = cut.deepest_mm, m.deepest_place = tip;
      if (cut.deepest_mm > options_.tolerance_mm) m.above_tip_mm = std::max(m.above_tip_mm, cut.above_tip_mm);
      if (program_.selected[i] && cut.deepest_mm > options_.tolerance_mm &&
          cut.above_tip_mm > tool->cutter_end_mm + options_.tolerance_mm)
        add_above_flutes(i, *tool, tip, cut.above_tip_mm, out);
      if ((tip - looked_at).norm() < kCollisionStep_mm) return;
      looked_at = tip;
      look_at_bodies(i, *tool, tip, false, out);
    });
  }

  void add_above_flutes(std::uint32_t i, const SurveyTool& tool, const Vec3& tip, double above, HeightSurvey& out) {
    const auto block = moves()[i].block;
    if (out.above_flutes.empty() || moves()[out.above_flutes.back().move].block != block)
      out.above_flutes.push_back({i, above});
    else
      out.above_flutes.back().above_tip_mm = std::max(out.above_flutes.back().above_tip_mm, above);
    if (tool.above) add(i, *tool.above, false, tip + Vec3(0, 0, tool.cutter_end_mm), out);
  }

  void look_at_bodies(std::uint32_t i, const SurveyTool& tool, const Vec3& tip, bool rapid, HeightSurvey& out) {
    for (const Disc& disc : tool.discs) {
      const double z = tip.z() + disc.height_mm;
      if (z >= heights_.max_mm().z()) return;
      if (const auto place = heights_.touch_disc(tip.head<2>(), disc.radius_mm, z))
        return add(i, disc.part, rapid, *place, out);
    }
  }

  void look_at_rapid(const RapidCheck& r, HeightSurvey& out) {
    const nc::Move& m = moves()[r.move];
    const SurveyTool* tool = tool_of(r.move);
    if (!tool) return;
    const Vec3 way = m.end_mm - m.start_mm;
    if (r.start_known && way.x() == 0 && way.y() == 0 && way.z() >= 0 && !tool->narrows) return;
    const std::size_t before = out.collisions.size();
    const auto look = [&](const Vec3& tip) {
      if (out.collisions.size() != before) return;
      const auto place = tool->smaller ? heights_.touch(*tool->smaller, tip) : std::nullopt;
      if (place)
        add(r.move, Collision::Part::cutter, true, *place, out);
      else
        look_at_bodies(r.move, *tool, tip, true, out);
    };
    if (!r.start_known) return look(m.end_mm);
    if (std::min(m.start_mm.z(), m.end_mm.z()) >= heights_.max_mm().z()) return;
    for (const Vec3& tip : feedmodel::positioning_places(job_.machine, m.start_mm, m.end_mm, kCollisionStep_mm))
      look(tip);
  }

  void add(std::uint32_t i, Collision::Part part, bool rapid, const Vec3& place, HeightSurvey& out) {
    add_collision(program_, {part, rapid, 0, i, program_.moves_in_part().state_of(moves()[i]).tool, place},
                  out.collisions);
  }

  const machine::Job& job_;
  const motion::SimulatedProgram& program_;
  SurveyOptions options_;
  HeightMap heights_;
  std::optional<HeightMap> blank_;  ///< before the allowance
  std::map<int, SurveyTool> tools_;
};

/// Cells that the cutters pass over, for cells of 1 mm.
double work_of(const machine::Job& job, const motion::SimulatedProgram& program, double cell) {
  double out = 0;
  for (std::size_t i = 0; i < program.moves_in_part().moves.size(); ++i) {
    if (!program.selected[i] && !removal::makes_hole(program.holes[i])) continue;
    const nc::Move& m = program.moves_in_part().moves[i];
    const auto tool = job.tools.find(program.moves_in_part().state_of(m).tool);
    if (tool == job.tools.end()) continue;
    const double d = tool->second.diameter_mm, step = std::sqrt(4 * d * kStepError * cell);
    out += (1 + nc::length_mm(program.moves_in_part(), m) / step) * std::max(cell * cell, d * d);
  }
  return out;
}

}  // namespace

double quick_cell_mm(const machine::Job& job, const motion::SimulatedProgram& program, const machine::Box& stock,
                     double cell, double max_visits) {
  constexpr double kCells = 4e6, kWider = 1.25;
  const Vec3 size = stock.max_mm - stock.min_mm;
  while (size.x() * size.y() > kCells * cell * cell || work_of(job, program, cell) > max_visits * cell * cell)
    cell *= kWider;
  return cell;
}

std::optional<HeightMap> stock_heights(const machine::Job& job, double cell) {
  if (job.stock.box) return HeightMap(job.stock.box->min_mm, job.stock.box->max_mm, cell);
  if (job.stock.cylinder) {
    const machine::Cylinder& c = *job.stock.cylinder;
    const double r = c.diameter_mm / 2;
    HeightMap out(c.base_mm - Vec3(r, r, 0), c.base_mm + Vec3(r, r, c.height_mm), cell);
    out.keep_cylinder(c.base_mm.head<2>(), r);
    return out;
  }
  if (job.stock.mesh.empty()) return std::nullopt;
  HeightMap out(read_mesh(job.stock.mesh), cell);
  if (out.undercut()) return std::nullopt;
  return out;
}

std::optional<HeightSurvey> survey_heights(const machine::Job& job, const motion::SimulatedProgram& program,
                                           const SurveyOptions& options) {
  if (program.turns()) return std::nullopt;
  const bool upright = std::ranges::all_of(
      program.moves_in_part().states, [](const nc::ModalState& s) { return s.work_frame == nc::WorkFrame::machine; });
  if (!upright) return std::nullopt;
  std::optional<HeightMap> heights = stock_heights(job, options.cell_mm);
  if (!heights) return std::nullopt;
  return Surveyor(job, program, options, *std::move(heights)).run();
}

}  // namespace camber::checks
