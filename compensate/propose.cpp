#include "compensate/propose.h"

#include <algorithm>
#include <array>

namespace camber::compensate {
namespace {

constexpr int kLiftings = 5;      // of the path before a round of the guard, by what they are expected to bring
constexpr int kStiffenings = 12;  // of the path where its angles grow by more than the bound
constexpr double kStiffer = 2.5;
constexpr double kSplit_mm = 0.0005;     // a split of a line in the first round must be worth this, ...
constexpr double kLateSplit_mm = 0.002;  // ... a later one this

using Fit = std::size_t(ShiftPath&, std::span<const Observation>, const FitShiftOptions&);  // fit_shift, fit_lifts

/// Splits lines where the shifts of the unrestricted path ask for it; a late split must be worth more.
void choose_splits(const Task& task, Version& version, const std::vector<Observation>& observations, Fit* fit) {
  ShiftPath free = version.path;
  fit(free, observations, fit_options(task, version));
  if (version.splits.add_strays(free, version.split_once ? kLateSplit_mm : kSplit_mm) > 0)
    version.link_stiffness.clear();
  version.split_once = true;
}

void stiffen(Version& version, const std::vector<nc::MoveMap::MovePlace>& places) {
  auto& stiffness = version.stiffness;
  for (const auto& place : places) {
    if (!version.path.contains(place.move)) continue;
    const std::size_t at = version.path.find(place.move, place.fraction).lower;
    for (std::size_t i = at > 0 ? at - 1 : 0; i < std::min(at + 3, stiffness.size()); ++i) stiffness[i] *= kStiffer;
  }
}

/// Emits the path's shifts, and again with a stiffer path where it turns by more than the bound.
void fit_and_emit(const Task& task, Version& version, const std::vector<Observation>& observations, Fit* fit,
                  PlannedRound& out) {
  ShiftPath& path = version.path;
  const std::vector<Vec3> from = path.shifts();
  ThinPath thin(path, version.splits.kept());
  const std::vector<Observation> asked = thin.places_of(observations);
  const std::vector<RowLink> links = row_links(thin.path(), kRowReach_mm);
  auto& link_stiffness = version.link_stiffness;
  if (link_stiffness.size() != links.size()) link_stiffness.assign(links.size(), 1.0);
  for (int i = 0; i <= kStiffenings; ++i) {
    path.set_shifts(from);
    thin.take_shifts(path);
    const std::vector<double> stiffness = thin.greatest_of(version.stiffness);
    out.round.limited_points = fit(thin.path(), asked, fit_options(task, stiffness, links, link_stiffness));
    thin.give_shifts(path);
    for (std::size_t p = 0; p < from.size(); ++p) {
      Vec3& shift = path.points()[p].shift_mm;
      shift = from[p] + out.round.step_fraction * (shift - from[p]);
    }
    out.made->emitted = emit(version.source, path, version.splits.kept(), version.compensated);
    const PathQuality& quality = out.made->emitted->quality;
    thin.take_shifts(path);
    const RowTurn turn = row_turn(thin.path(), links, task.job.compensation.max_angle_growth_rad);
    if (quality.over.empty() && turn.over.empty()) break;
    stiffen(version, quality.over);
    for (const std::size_t link : turn.over) link_stiffness[link] *= kStiffer;
  }
  out.round.largest_shift_mm = path.largest_shift_mm();
}

}  // namespace

FitShiftOptions fit_options(const Task& task, std::span<const double> stiffness, std::span<const RowLink> links,
                            std::span<const double> link_stiffness) {
  return {.smoothing_mm = smoothing_mm(task.job.simulation.voxel_mm),
          .max_shift_mm = task.job.compensation.max_shift_mm,
          .stiffness = stiffness,
          .links = links,
          .link_stiffness = link_stiffness,
          .bounded = true,
          .centred = !task.job.compensation.profile_um};
}

FitShiftOptions fit_options(const Task& task, const Version& version) {
  return fit_options(task, version.stiffness, version.links, {});
}

std::vector<Observation> wanted_of(const Task& task, const Version& version, const Observed& observed,
                                   const Guard* guard) {
  std::vector<Observation> out = observed.of_path();
  if (guard)
    guard->apply_to(out);
  else
    out = without_row_form(version.path, out, fit_options(task, version));
  version.sensitivity.apply_to(out);
  return out;
}

PlannedRound propose(const Task& task, State& state, double fraction, const Guard* guard, const Prepare& prepare) {
  Version& version = *state.active;
  PlannedRound out{.from = state.last, .made = std::make_shared<Trial>()};
  const bool by_expectation = !state.expected.empty() && !guard;
  std::vector<Observation> observations =
      by_expectation ? state.expected : wanted_of(task, version, state.last->observed, guard);
  state.expected.clear();
  // What rows do that come out of the shadow of others says nothing of their gain, nor what another feed does.
  out.shows_gain = !by_expectation && !prepare;
  out.round.gain = version.sensitivity.mean();
  out.round.step_fraction = fraction;
  out.round.guard = guard != nullptr;
  version.path.set_shifts(state.last->shifts);
  FeedLever::set_fractions(version.path, state.last->fractions);
  if (prepare) prepare(observations);
  Fit* fit = guard ? &fit_lifts : &fit_shift;
  choose_splits(task, version, observations, fit);
  fit_and_emit(task, version, observations, fit, out);
  return out;
}

PlannedRound propose_shifts(const Task& task, State& state, std::span<const Vec3> wanted) {
  Version& version = *state.active;
  PlannedRound out{.from = state.last, .made = std::make_shared<Trial>(), .shows_gain = false};
  out.round.gain = version.sensitivity.mean();
  out.round.combined = true;
  version.path.set_shifts(state.last->shifts);
  FeedLever::set_fractions(version.path, state.last->fractions);
  std::vector<Observation> observations;
  for (const ShiftChain& chain : version.path.chains())
    for (std::size_t i = chain.from; i < chain.from + chain.count; ++i) {
      const bool last = i + 1 == chain.from + chain.count;
      const Vec3 change = wanted[i] - state.last->shifts[i];
      for (const Vec3& axis : std::array<Vec3, 3>{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}) {
        Observation o;
        o.place = last ? ShiftPath::PointInterval{i - 1, 1.0} : ShiftPath::PointInterval{i, 0.0};
        o.normal = axis;
        o.error_mm = -axis.dot(change);
        o.area_mm2 = 1;
        observations.push_back(o);
      }
    }
  choose_splits(task, version, observations, &fit_lifts);
  fit_and_emit(task, version, observations, &fit_lifts, out);
  return out;
}

bool ask_for_lifts(const Task& task, State& state, Guard& guard, double deepest_um) {
  Version& version = *state.active;
  const Trial& last = *state.last;
  const double limit_um = task.given.depth_limit_um;
  std::vector<Observation> gains = last.observed.points;
  version.sensitivity.apply_to(gains);
  Observed expected = last.observed;
  double expected_um = deepest_um;
  version.path.set_shifts(last.shifts);
  ShiftPath path = version.path;
  ThinPath thin(path, version.splits.kept());
  const std::vector<RowLink> links = row_links(thin.path(), kRowReach_mm);
  const std::vector<double> stiffness = thin.greatest_of(version.stiffness);
  guard.clear();
  for (int i = 0; i < kLiftings && expected_um > limit_um; ++i) {
    guard.learn(expected, expected_um / 1000);
    thin.take_shifts(version.path);
    fit_lifts(thin.path(), thin.places_of(wanted_of(task, version, last.observed, &guard)),
              fit_options(task, stiffness, links, {}));
    thin.give_shifts(path);
    for (std::size_t p = 0; p < gains.size(); ++p) {
      const Observation& o = gains[p];
      if (!last.observed.compensated[p] || !o.own) continue;
      const Vec3 change = path.shift_at(o.place) - version.path.shift_at(o.place);
      expected.points[p].error_mm = o.error_mm + o.gain * o.normal.dot(change);
    }
    expected_um = depth_of(last.surface, expected, limit_um, true).gouge_depth_p999_um;
  }
  return expected_um - limit_um < (1 - kGuardGain) * (deepest_um - limit_um);
}

}  // namespace camber::compensate
