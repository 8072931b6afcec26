#include "plan/joined_runs.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace camber::plan {
namespace {

constexpr double kTouch_mm = 1e-3;

using Run = std::vector<PlanOperation>;

bool is_by_levels(const PlanOperation& o) { return o.pattern != Pattern::drilling && o.scallop_mm <= 0; }

bool places_overlap(const PlanOperation& a, const PlanOperation& b) {
  for (int axis = 0; axis < 2; ++axis)
    if (std::min(a.box_mm[1][axis], b.box_mm[1][axis]) - std::max(a.box_mm[0][axis], b.box_mm[0][axis]) < kTouch_mm)
      return false;
  return true;
}

/// Side by side at a common height, or one on the other.
bool touch(const PlanOperation& a, const PlanOperation& b) {
  return places_overlap(a, b) && std::min(a.to_mm, b.to_mm) > std::max(a.from_mm, b.from_mm) - kTouch_mm;
}

class Joiner {
 public:
  Joiner(const PlanInput& input, PlannedDivision& plan) : input_(input), plan_(plan) {
    for (const PlanOperation& o : plan.operations) runs_.push_back({o});
  }

  void join() {
    // Up to the run before that it fits; then down to the one behind.
    for (std::size_t i = 1; i < runs_.size(); ++i)
      for (std::size_t j = i; j-- > 0;)
        if (may_pass(j + 1, i, i) && joins(j, i)) {
          merge(j, i, j);
          --i;
          break;
        }
    for (std::size_t i = runs_.size(); i-- > 0;)
      for (std::size_t j = i + 1; j < runs_.size(); ++j)
        if (may_be_passed(i, i + 1, j) && joins(i, j)) {
          merge(i, j, j);
          break;
        }
    plan_.operations.clear();
    for (const Run& run : runs_) plan_.operations.insert(plan_.operations.end(), run.begin(), run.end());
  }

 private:
  const VolumePrimitive& primitive(const PlanOperation& o) const {
    return plan_.primitives[plan_.order.steps[o.primitive - 1].primitive];
  }

  /// Whether an operation must come after another one that is planned before it.
  static bool needs(const PlanOperation& later, const PlanOperation& earlier) {
    if (later.primitive == earlier.primitive) return true;
    const bool opens = earlier.kind != OperationKind::finish && earlier.from_mm > later.to_mm - kTouch_mm;
    return !is_by_levels(later) || !is_by_levels(earlier) || (opens && places_overlap(earlier, later));
  }
  static bool needs(const Run& later, const Run& earlier) {
    return std::ranges::any_of(later, [&](const PlanOperation& l) {
      return std::ranges::any_of(earlier, [&](const PlanOperation& e) { return needs(l, e); });
    });
  }
  /// Run `of` before those from `first` to `end`.
  bool may_pass(std::size_t first, std::size_t end, std::size_t of) const {
    for (std::size_t k = first; k < end; ++k)
      if (needs(runs_[of], runs_[k])) return false;
    return true;
  }
  /// Run `of` behind those from `first` to `end`.
  bool may_be_passed(std::size_t of, std::size_t first, std::size_t end) const {
    for (std::size_t k = first; k < end; ++k)
      if (needs(runs_[k], runs_[of])) return false;
    return true;
  }

  /// The conditions of two runs in one; nothing where they are no better together.
  std::optional<Conditions> together(const Run& a, const Run& b) const {
    Run all = a;
    all.insert(all.end(), b.begin(), b.end());
    const PlanOperation& first = all.front();
    for (const PlanOperation& o : all)
      if (o.feature == Feature::free_form || !not_joined_because(first, o).empty() || !o.conditions.within)
        return std::nullopt;
    const bool meet = std::ranges::any_of(a, [&](const PlanOperation& x) {
      return std::ranges::any_of(b, [&](const PlanOperation& y) { return touch(x, y); });
    });
    if (!meet) return std::nullopt;
    std::string note;
    const auto c = conditions_for(input_, input_.tools.at(first.tool),
                                  {first.kind == OperationKind::finish, depth_mm(all), machine::kNoLimit}, note);
    constexpr double kRounding = 1e-6;
    if (!c || !c->within) return std::nullopt;
    const auto cost = first.kind == OperationKind::finish ? &Joiner::wall_levels : &Joiner::cost_s;
    const double apart = (this->*cost)(a, a.front().conditions) + (this->*cost)(b, b.front().conditions);
    // A path of another pattern must be worth it.
    const bool alike = std::ranges::all_of(all, [&](const PlanOperation& o) { return o.pattern == first.pattern; });
    return (this->*cost)(all, *c) <= apart + (alike ? kRounding : -kRounding) ? c : std::nullopt;
  }
  bool joins(std::size_t a, std::size_t b) const { return together(runs_[a], runs_[b]).has_value(); }

  static double depth_mm(const Run& run) { return highest_mm(run) - lowest_mm(run); }
  static double highest_mm(const Run& run) { return std::ranges::max(run, {}, &PlanOperation::to_mm).to_mm; }
  static double lowest_mm(const Run& run) { return std::ranges::min(run, {}, &PlanOperation::from_mm).from_mm; }

  double area_mm2(const PlanOperation& o) const {
    const VolumePrimitive& p = primitive(o);
    return (p.max_mm.x() - p.min_mm.x()) * (p.max_mm.y() - p.min_mm.y());
  }
  /// Seen from above, of one on the other.
  double common_mm2(const PlanOperation& a, const PlanOperation& b) const {
    const VolumePrimitive &p = primitive(a), &q = primitive(b);
    double out = 1;
    for (int axis = 0; axis < 2; ++axis)
      out *= std::max(0.0, std::min(p.max_mm[axis], q.max_mm[axis]) - std::max(p.min_mm[axis], q.min_mm[axis]));
    return out;
  }

  static int levels(const Run& run, const Conditions& c) {
    return std::max(1, static_cast<int>(std::ceil(depth_mm(run) / c.axial_mm - 1e-6)));
  }
  /// Returns the number of levels at which a finishing run cuts walls; floors are cut once in any case.
  double wall_levels(const Run& run, const Conditions& c) const { return levels(run, c); }

  /// Time of loops or rows over the primitives: evenly spaced levels, and bottoms that are none of them by themselves.
  double cost_s(const Run& run, const Conditions& c) const {
    const double top = highest_mm(run), depth = depth_mm(run);
    const int n = levels(run, c);
    double area = 0;
    for (const PlanOperation& o : run) {
      bool even = false;
      for (int k = 1; k <= n; ++k) {
        const double z = top - depth * k / n;
        even = even || std::abs(z - o.from_mm) < kTouch_mm;
        if (z > o.from_mm - kTouch_mm && z < o.to_mm - kTouch_mm) area += area_mm2(o);
      }
      if (even) continue;
      double apart = area_mm2(o);
      for (const PlanOperation& below : run)
        if (std::abs(below.to_mm - o.from_mm) < kTouch_mm) apart -= common_mm2(o, below);
      area += std::max(0.0, apart);
    }
    return 60 * area / (c.radial_mm * c.feed_mm_per_min);
  }

  /// Runs `a` and `b`, a before b, become one at the place of one of them.
  void merge(std::size_t a, std::size_t b, std::size_t at) {
    const Conditions c = *together(runs_[a], runs_[b]);
    Run all = runs_[a];
    all.insert(all.end(), runs_[b].begin(), runs_[b].end());
    std::ranges::stable_sort(all, {}, &PlanOperation::primitive);
    const bool loops =
        std::ranges::any_of(all, [](const PlanOperation& o) { return o.pattern == Pattern::contour_line; });
    const double rate = removal_rate_mm3_per_s(input_.tools.at(all.front().tool), c);
    for (PlanOperation& o : all) {
      o.conditions = c;
      o.joined = &o != &all.front();
      if (loops) o.pattern = Pattern::contour_line;
      if (o.kind != OperationKind::finish) o.nominal_time_s = o.volume_mm3 / rate;
    }
    runs_[at] = std::move(all);
    runs_.erase(runs_.begin() + static_cast<std::ptrdiff_t>(at == a ? b : a));
  }

  const PlanInput& input_;
  PlannedDivision& plan_;
  std::vector<Run> runs_;
};

}  // namespace

std::size_t first_of_run(const PlannedDivision& plan, std::size_t operation) {
  while (operation > 0 && plan.operations[operation].joined) --operation;
  return operation;
}

std::string not_joined_because(const PlanOperation& before, const PlanOperation& row) {
  constexpr double kSame_mm = 1e-4;
  if (!is_by_levels(before) || !is_by_levels(row)) return "only milling level by level can be joined";
  if (row.kind != before.kind) return "it is of another kind than the row before";
  if (row.tool != before.tool) return fmt::format("its tool is {}, that of the row before {}", row.tool, before.tool);
  if (std::abs(row.allowance_mm - before.allowance_mm) > kSame_mm)
    return fmt::format("its allowance is {:g} mm, that of the row before {:g}", row.allowance_mm, before.allowance_mm);
  return {};
}

void join_operations(const PlanInput& input, PlannedDivision& plan) { Joiner(input, plan).join(); }

}  // namespace camber::plan
