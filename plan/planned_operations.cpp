#include "plan/planned_operations.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "plan/joined_runs.h"

namespace camber::plan {
namespace {

constexpr double kBeyond_mm = 1.0;  // how far the tool leaves the blank over an open side
// Shares of a primitive: that a first tool may leave in gaps between walls, and that is no gap.
constexpr double kIsland_mm2 = 1;
constexpr double kGaps = 0.15, kNoGap = 0.005;

/// Where the axis may be: over the primitive, and so far beyond its open sides that the cutter leaves them.
std::array<Vec2, 2> region_of(const VolumePrimitive& p, const OpenFaces& open, double radius_mm) {
  std::array<Vec2, 2> box{Vec2(p.min_mm.x(), p.min_mm.y()), Vec2(p.max_mm.x(), p.max_mm.y())};
  const double beyond = radius_mm + kBeyond_mm;
  for (int side = 0; side < 4; ++side)
    if (open.side[static_cast<std::size_t>(side)])
      box[static_cast<std::size_t>(side % 2)][side / 2] += side % 2 == 0 ? -beyond : beyond;
  return box;
}

Pattern pattern_of(Feature feature, bool contoured) {
  switch (feature) {
    case Feature::closed_pocket:
      return Pattern::contour_line;
    case Feature::through_hole:
    case Feature::blind_hole:
      return Pattern::drilling;
    default:
      return contoured ? Pattern::contour_line : Pattern::scanning_line;
  }
}

/// Makes the operations of one primitive after the other.
class Planner {
 public:
  Planner(const PlanInput& input, const RemovalVolume& removal, PlannedDivision& out)
      : input_(input),
        removal_(removal),
        out_(out),
        work_(removal, out.primitives),
        begun_(removal.holes.size(), false),
        drilled_(removal.holes.size(), false) {}

  void plan() {
    for (std::size_t i = 0; i < out_.order.steps.size(); ++i) {
      const Step& step = out_.order.steps[i];
      const std::size_t before = out_.operations.size();
      number_ = i + 1;
      if (out_.primitives[step.primitive].is_hole)
        plan_hole(step);
      else
        plan_box(step);
      const VolumePrimitive& p = out_.primitives[step.primitive];
      if (out_.operations.size() == before && !(p.is_hole && drilled_[p.hole]) &&
          (out_.unmachined.empty() || out_.unmachined.back().primitive != step.primitive))
        leave(step, "no operation");
      work_.remove(step.primitive);
    }
    group_holes();
    for (const Unreachable& u : out_.order.unreachable)
      out_.unmachined.push_back({u.primitive, describe(out_.primitives[u.primitive]), u.reason + "; another set-up"});
  }

 private:
  static std::string describe(const VolumePrimitive& p) {
    return fmt::format("{} from ({:.3g}, {:.3g}, {:.3g}) to ({:.3g}, {:.3g}, {:.3g})", p.is_hole ? "hole" : "volume",
                       p.min_mm.x(), p.min_mm.y(), p.min_mm.z(), p.max_mm.x(), p.max_mm.y(), p.max_mm.z());
  }

  void leave(const Step& step, const std::string& reason) {
    const VolumePrimitive& p = out_.primitives[step.primitive];
    out_.unmachined.push_back({step.primitive, fmt::format("{}, {}", to_string(step.feature), describe(p)), reason});
  }

  /// Smallest radius of the rounded inner corners beside a primitive; infinite: none.
  double inner_radius_mm(const VolumePrimitive& p, bool& sharp) const {
    constexpr double kTouch_mm = 1e-3;
    double least = machine::kNoLimit;
    for (const InnerCorner& c : removal_.corners) {
      if (c.to_mm < p.min_mm.z() + kTouch_mm || c.from_mm > p.max_mm.z() - kTouch_mm) continue;
      if (c.at_mm.x() < p.min_mm.x() - kTouch_mm || c.at_mm.x() > p.max_mm.x() + kTouch_mm ||
          c.at_mm.y() < p.min_mm.y() - kTouch_mm || c.at_mm.y() > p.max_mm.y() + kTouch_mm)
        continue;
      if (c.radius_mm <= 0)
        sharp = true;
      else
        least = std::min(least, c.radius_mm);
    }
    return least;
  }

  /// Holes are the last ones and do not depend on each other, but where one is under another: first all centres, then
  /// the drills and the reamers, each tool once.
  void group_holes() {
    for (std::size_t h = 0; h < begun_.size(); ++h)
      if (begun_[h] && !drilled_[h]) return;
    const auto is_of_hole = [&](const PlanOperation& o) {
      return out_.primitives[out_.order.steps[o.primitive - 1].primitive].is_hole;
    };
    const auto first = std::ranges::find_if(out_.operations, is_of_hole);
    std::vector<int> tools;  // in the order in which they come
    for (auto o = first; o != out_.operations.end(); ++o)
      if (std::ranges::find(tools, o->tool) == tools.end()) tools.push_back(o->tool);
    std::ranges::stable_sort(first, out_.operations.end(), {}, [&](const PlanOperation& o) {
      return std::make_pair(o.kind, std::ranges::find(tools, o.tool) - tools.begin());
    });
  }

  ToolNeed need_of(const Step& step) const {
    const VolumePrimitive& p = out_.primitives[step.primitive];
    ToolNeed need;
    need.feature = step.feature;
    need.width_mm = step.width_mm;
    need.depth_mm = p.max_mm.z() - p.min_mm.z();
    need.wall_mm = [this, number = step.primitive, bottom = p.min_mm.z()](double radius) {
      return work_.highest_near_mm(number, radius) - bottom;
    };
    if (!p.is_hole)
      need.has_room = [this, &step](double radius) { return work_.has_room(step.primitive, step.open, radius); };
    if (p.contoured && !p.free_form) {
      // Gaps between walls may be left to a rest operation.
      need.walls_within = work_.stands_within_mm2(step.primitive) > kIsland_mm2;
      need.has_room = [this, &step, most = kGaps * area_mm2(p)](double radius) {
        return unreached_mm2(step, radius) <= most;
      };
    }
    return need;
  }

  static double area_mm2(const VolumePrimitive& p) {
    return (p.max_mm.x() - p.min_mm.x()) * (p.max_mm.y() - p.min_mm.y());
  }

  double unreached_mm2(const Step& step, double radius_mm) const {
    return work_.unreached_mm2(step.primitive, step.open, radius_mm);
  }

  const PlanTool& tool(int number) const { return input_.tools.at(number); }

  /// Null where the case base does not know the tool.
  PlanOperation* add(const Step& step, OperationKind kind, int number, Pattern pattern, const CutNeed& cut,
                     std::string note) {
    const VolumePrimitive& p = out_.primitives[step.primitive];
    std::string said;
    const auto conditions = conditions_for(input_, tool(number), cut, said);
    if (!conditions) {
      leave(step, said);
      return nullptr;
    }
    PlanOperation op{.primitive = number_,
                     .feature = step.feature,
                     .kind = kind,
                     .tool = number,
                     .pattern = pattern,
                     .conditions = *conditions};
    op.box_mm = region_of(p, step.open, tool(number).tool.diameter_mm / 2);
    op.from_mm = p.min_mm.z(), op.to_mm = p.max_mm.z();
    for (const std::string& n : {std::move(note), said})
      if (!n.empty()) op.notes.push_back(n);
    if (!conditions->within)
      op.notes.push_back(fmt::format("the limit \"{}\" is not kept at a tenth of the depth", conditions->limit));
    out_.operations.push_back(std::move(op));
    return &out_.operations.back();
  }

  void set_volume(PlanOperation& op, double volume_mm3) const {
    op.volume_mm3 = volume_mm3;
    op.nominal_time_s = volume_mm3 / removal_rate_mm3_per_s(tool(op.tool), op.conditions);
  }

  void plan_box(const Step& step) {
    const VolumePrimitive& p = out_.primitives[step.primitive];
    bool sharp = false;
    const double inner = inner_radius_mm(p, sharp);
    ToolNeed need = need_of(step);
    if (step.feature == Feature::free_form) return plan_free_form(step, need);
    std::string wanted;
    auto pick = pick_mill(need, input_.tools, wanted);
    if (!pick) return leave(step, "none of the tools will do; it needs " + wanted);
    const double depth = p.max_mm.z() - p.min_mm.z();
    const double surface = work_.wall_mm2(step.primitive) + work_.floor_mm2(step.primitive);
    const Pattern pattern = pattern_of(step.feature, p.contoured);
    PlanOperation* rough =
        add(step, OperationKind::rough, pick->tool, pattern, {false, depth, machine::kNoLimit}, pick->note);
    if (rough == nullptr) return;
    rough->allowance_mm = input_.fine && surface > 0 ? input_.allowance_mm : 0;
    const double left = rough->allowance_mm * surface;
    set_volume(*rough, std::max(p.volume_mm3 - left, 0.0));
    if (sharp) rough->notes.push_back("sharp inner corners keep the radius of the tool");
    int last = pick->tool;
    const double radius = tool(pick->tool).tool.diameter_mm / 2;
    if (inner * (1 + kCornerShare) < radius)
      last = add_rest(step, need, inner).value_or(last);
    else if (p.contoured)
      last = add_rest_of_gaps(step, need, radius, sharp).value_or(last);
    if (rough_of(step).allowance_mm > 0) {
      add_finish(step, last, left);
    }
    out_.operations.back().surface_mm2 = surface;
  }

  PlanOperation& rough_of(const Step&) {
    const auto at =
        std::ranges::find_if(out_.operations, [&](const PlanOperation& o) { return o.primitive == number_; });
    return *at;
  }

  std::optional<int> add_rest(const Step& step, ToolNeed need, double inner_mm) {
    need.inner_radius_mm = inner_mm;
    std::string wanted;
    const auto pick = pick_rest_mill(need, input_.tools, wanted);
    if (!pick) {
      rough_of(step).notes.push_back(
          fmt::format("inner corners of {:.3g} mm keep more material; they need {}", inner_mm, wanted));
      return std::nullopt;
    }
    PlanOperation* rest =
        add(step, OperationKind::rest, pick->tool, Pattern::contour_line,
            {false, out_.primitives[step.primitive].max_mm.z() - out_.primitives[step.primitive].min_mm.z(),
             machine::kNoLimit},
            {});
    if (rest == nullptr) return std::nullopt;
    rest->allowance_mm = rough_of(step).allowance_mm;
    // Four corners, each with what the larger tool leaves.
    const double depth = rest->to_mm - rest->from_mm, r = tool(rough_of(step).tool).tool.diameter_mm / 2;
    set_volume(*rest, (4 - kPi) * (r * r - inner_mm * inner_mm) * depth);
    return pick->tool;
  }

  /// Where walls leave gaps that the tool does not get into, and the smallest end mill does.
  std::optional<int> add_rest_of_gaps(const Step& step, ToolNeed need, double radius_mm, bool sharp) {
    const double smallest = removal_.narrowest_mm / 2;
    if (smallest <= 0 || smallest >= radius_mm) return std::nullopt;
    const double depth = need.depth_mm, area = area_mm2(out_.primitives[step.primitive]);
    const double least = unreached_mm2(step, smallest), left = unreached_mm2(step, radius_mm);
    const auto narrow = [&](double unreached, double radius) {
      return unreached - least > (sharp ? sharp_corners_mm2(radius) : 0) + kNoGap * area;
    };
    if (!narrow(left, radius_mm)) return std::nullopt;
    need.inner_radius_mm = radius_mm * (1 - 2 * kCornerShare);
    need.has_room = [&](double radius) { return !narrow(unreached_mm2(step, radius), radius); };
    std::string wanted;
    const auto pick = pick_rest_mill(need, input_.tools, wanted);
    if (!pick) {
      rough_of(step).notes.push_back(
          fmt::format("gaps of {:.3g} mm2 in all keep material; they need {}", left - least, wanted));
      return std::nullopt;
    }
    PlanOperation* rest =
        add(step, OperationKind::rest, pick->tool, Pattern::contour_line, {false, depth, machine::kNoLimit}, {});
    if (rest == nullptr) return std::nullopt;
    rest->allowance_mm = rough_of(step).allowance_mm;
    set_volume(*rest, (left - unreached_mm2(step, tool(pick->tool).tool.diameter_mm / 2)) * depth);
    return pick->tool;
  }

  void add_finish(const Step& step, int number, double left_mm3) {
    const VolumePrimitive& p = out_.primitives[step.primitive];
    const bool level = step.feature == Feature::face && !p.contoured;
    PlanOperation* finish =
        add(step, OperationKind::finish, number, level ? Pattern::scanning_line : Pattern::contour_line,
            {true, p.max_mm.z() - p.min_mm.z(), machine::kNoLimit}, {});
    if (finish == nullptr) return;
    Conditions& c = finish->conditions;
    // Walls are finished over the radial depth of the allowance, floors over its axial depth.
    finish->volume_mm3 = left_mm3;
    const double floor = work_.floor_mm2(step.primitive), wall = work_.wall_mm2(step.primitive);
    finish->nominal_time_s = 60 * (floor / (c.radial_mm * c.feed_mm_per_min) + wall / (c.axial_mm * c.feed_mm_per_min));
  }

  void plan_free_form(const Step& step, ToolNeed need) {
    const VolumePrimitive& p = out_.primitives[step.primitive];
    bool sharp = false;
    need.inner_radius_mm = inner_radius_mm(p, sharp);
    need.has_room = {};
    std::string wanted;
    const auto ball = pick_mill(need, input_.tools, wanted);
    if (!ball) return leave(step, "none of the tools will do; it needs " + wanted);
    const double depth = p.max_mm.z() - p.min_mm.z(), radius = tool(ball->tool).tool.diameter_mm / 2;
    const std::string note = p.overhang ? "a face of it looks down; it is not reached there" : "";
    const double left = rough_free_form(step, need, ball->tool);
    PlanOperation* op = add(step, OperationKind::finish, ball->tool, Pattern::scanning_line,
                            {input_.fine, radius, machine::kNoLimit}, note);
    if (op == nullptr) return;
    finish_free_form(*op, radius, std::min(left, depth * free_form_mm2(p)), free_form_mm2(p));
  }

  /// Rows whose ridges have the height that is asked for; without one as far apart as the cases say.
  void finish_free_form(PlanOperation& op, double radius, double left_mm3, double surface_mm2) const {
    Conditions& c = op.conditions;
    if (input_.fine) {
      op.scallop_mm = input_.scallop_mm;
      c.radial_mm = std::floor(2000 * std::sqrt(op.scallop_mm * (2 * radius - op.scallop_mm))) / 1000;
    } else {
      const double half = std::min(c.radial_mm / 2, radius);
      op.scallop_mm = std::round(1e4 * (radius - std::sqrt(radius * radius - half * half))) / 1e4;
    }
    op.volume_mm3 = left_mm3;
    op.surface_mm2 = surface_mm2;
    op.nominal_time_s = 60 * surface_mm2 / (c.radial_mm * c.feed_mm_per_min);
  }

  /// None where no more is there than roughing would leave. Levels, by an end mill where it is deeper than the ball end
  /// mill cuts at once, else by that itself. Returns what is left.
  double rough_free_form(const Step& step, ToolNeed need, int ball) {
    const VolumePrimitive& p = out_.primitives[step.primitive];
    constexpr double kSkin = 1.05;  // of the allowance that roughing would leave
    if (p.volume_mm3 <= kSkin * input_.allowance_mm * free_form_mm2(p)) return p.volume_mm3;
    const double depth = p.max_mm.z() - p.min_mm.z();
    need.feature = Feature::open_pocket;
    need.inner_radius_mm = machine::kNoLimit;
    std::string wanted;
    const auto mill =
        depth > tool(ball).tool.diameter_mm / 2 ? pick_mill(need, input_.tools, wanted) : std::optional<ToolPick>();
    PlanOperation* rough =
        add(step, OperationKind::rough, mill ? mill->tool : ball, mill ? Pattern::contour_line : Pattern::scanning_line,
            {false, depth, machine::kNoLimit}, {});
    if (rough == nullptr) return p.volume_mm3;
    rough->allowance_mm = input_.allowance_mm;
    // Steps as high as a level, and the allowance.
    const double left =
        std::min(p.volume_mm3, free_form_mm2(p) * (rough->allowance_mm + rough->conditions.axial_mm / 2));
    set_volume(*rough, p.volume_mm3 - left);
    return left;
  }

  double free_form_mm2(const VolumePrimitive& p) const {
    double sum = 0;
    for (const CellIndex& c : p.cells) sum += removal_.grid.at(c).free_form_mm2;
    return sum;
  }

  /// The hole that goes on under this one with the same middle.
  std::optional<std::size_t> hole_below(const Hole& hole) const {
    constexpr double kSame_mm = 0.05;
    for (std::size_t h = 0; h < removal_.holes.size(); ++h) {
      const Hole& below = removal_.holes[h];
      if ((below.centre_mm - hole.centre_mm).norm() < kSame_mm && below.top_mm < hole.top_mm - kSame_mm &&
          below.top_mm > hole.tip_mm - kSame_mm && below.diameter_mm < hole.diameter_mm + kSame_mm)
        return h;
    }
    return std::nullopt;
  }

  void plan_hole(const Step& step) {
    const std::size_t number = out_.primitives[step.primitive].hole;
    if (drilled_[number]) return;
    const Hole& hole = removal_.holes[number];
    const ToolNeed need = need_of(step);
    std::string wanted;
    auto tools = pick_hole_tools(need, input_.tools, wanted);
    if (tools && begun_[number]) tools->center_drill.reset();  // the hole above leads the drill
    if (!tools) return leave(step, "none of the tools will do; it needs " + wanted);
    const double volume = out_.primitives[step.primitive].volume_mm3;
    if (tools->end_mill) {
      PlanOperation* op = add(step, OperationKind::rough, *tools->end_mill, Pattern::contour_line,
                              {false, need.depth_mm, machine::kNoLimit}, tools->note);
      if (op != nullptr) set_volume(*op, volume);
      return;
    }
    const std::array<std::pair<std::optional<int>, OperationKind>, 3> all{{{tools->center_drill, OperationKind::centre},
                                                                           {tools->drill, OperationKind::drill},
                                                                           {tools->reamer, OperationKind::ream}}};
    for (const auto& [with, kind] : all)
      if (with) add_drilling(step, hole, *with, kind, kind == OperationKind::drill ? volume : 0);
    const auto below = hole_below(hole);
    if (!below) return;
    begun_[*below] = true;
    constexpr double kFits_mm = 0.05;
    if (tools->reamer && tools->drill &&
        std::abs(tool(*tools->drill).tool.diameter_mm - removal_.holes[*below].diameter_mm) < kFits_mm)
      drill_on(removal_.holes[*below], *below);
  }

  /// The drill of a reamed hole goes on to the end of the hole below, which has its diameter.
  void drill_on(const Hole& below, std::size_t number) {
    const auto drill = std::ranges::find_if(out_.operations, [&](const PlanOperation& o) {
      return o.primitive == number_ && o.kind == OperationKind::drill;
    });
    if (drill == out_.operations.end()) return;
    drilled_[number] = true;
    drill->from_mm = below.tip_mm;
    if (is_through(below)) drill->from_mm -= drill_point_mm(tool(drill->tool).tool) + kBeyond_mm;
    set_volume(*drill, drill->volume_mm3 + below.volume_mm3);
    drill->notes.clear();
  }

  bool is_through(const Hole& hole) const {
    const auto p = std::ranges::find_if(
        out_.primitives, [&](const VolumePrimitive& of) { return of.is_hole && &removal_.holes[of.hole] == &hole; });
    return p != out_.primitives.end() && work_.open_faces(static_cast<std::size_t>(p - out_.primitives.begin())).bottom;
  }

  static double drill_point_mm(const machine::Tool& t) {
    const double half_point = t.point_angle_rad > 0 ? t.point_angle_rad / 2 : kPi / 2;
    return t.diameter_mm / 2 / std::tan(half_point);
  }

  void add_drilling(const Step& step, const Hole& hole, int number, OperationKind kind, double volume_mm3) {
    PlanOperation* op =
        add(step, kind, number, Pattern::drilling, {kind == OperationKind::ream, step.width_mm, step.width_mm}, {});
    if (op == nullptr) return;
    op->box_mm = {hole.centre_mm, hole.centre_mm};
    const machine::Tool& t = tool(number).tool;
    const double point = drill_point_mm(t);
    if (kind == OperationKind::centre)
      op->from_mm = hole.top_mm - (t.diameter_mm < hole.diameter_mm ? std::max(point, t.diameter_mm / 2)
                                                                    : point * hole.diameter_mm / t.diameter_mm);
    else if (step.feature == Feature::through_hole)
      op->from_mm = hole.tip_mm - point - kBeyond_mm;
    else if (hole.bottom_mm - hole.tip_mm < 1e-3 && kind == OperationKind::drill && t.point_angle_rad > 0)
      op->notes.push_back(fmt::format("the bottom is flat; the drill's point leaves {:.3g} mm at its edge", point));
    op->volume_mm3 = volume_mm3;
    op->nominal_time_s = volume_mm3 > 0 ? volume_mm3 / removal_rate_mm3_per_s(tool(number), op->conditions)
                                        : 60 * (op->to_mm - op->from_mm) / op->conditions.feed_mm_per_min;
  }

  const PlanInput& input_;
  const RemovalVolume& removal_;
  PlannedDivision& out_;
  MachinedSpace work_;
  std::vector<bool> begun_, drilled_;  ///< holes under others: led by them; made by their drill
  std::size_t number_ = 0;
};

}  // namespace

int tool_changes(const std::vector<PlanOperation>& operations) {
  int changes = 0;
  for (std::size_t i = 1; i < operations.size(); ++i)
    if (operations[i].tool != operations[i - 1].tool) ++changes;
  return changes;
}

double total_time_s(const std::vector<PlanOperation>& operations, double tool_change_s) {
  double sum = tool_change_s * tool_changes(operations);
  for (const PlanOperation& o : operations) sum += o.nominal_time_s;
  return sum;
}

double form_error_p95_mm(const std::vector<PlanOperation>& operations) {
  std::vector<std::pair<double, double>> errors;  // and surfaces
  double all = 0;
  for (const PlanOperation& o : operations)
    if (o.surface_mm2 > 0) {
      errors.emplace_back(o.conditions.loads.form_error_mm, o.surface_mm2);
      all += o.surface_mm2;
    }
  std::ranges::sort(errors);
  double sum = 0;
  for (const auto& [error, surface] : errors)
    if ((sum += surface) >= 0.95 * all) return error;
  return 0;
}

std::size_t best_plan(const std::vector<PlanFigures>& plans) {
  constexpr double kEqual = 1e-9;
  const auto before = [](const PlanFigures& a, const PlanFigures& b) {
    if (a.complete != b.complete) return a.complete;
    if (std::abs(a.time_s - b.time_s) > kEqual * (a.time_s + b.time_s)) return a.time_s < b.time_s;
    if (a.tool_changes != b.tool_changes) return a.tool_changes < b.tool_changes;
    return a.form_error_mm < b.form_error_mm - kEqual;
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < plans.size(); ++i)
    if (before(plans[i], plans[best])) best = i;
  return best;
}

PlannedDivision plan_division(const PlanInput& input, const RemovalVolume& removal, DivisionPlan division) {
  PlannedDivision out;
  out.division = division;
  out.primitives = divide(removal, division);
  out.order = put_in_order(removal, out.primitives);
  Planner(input, removal, out).plan();
  join_operations(input, out);
  out.tool_changes = tool_changes(out.operations);
  out.nominal_time_s = total_time_s(out.operations, input.tool_change_s);
  out.form_error_p95_mm = form_error_p95_mm(out.operations);
  return out;
}

}  // namespace camber::plan
