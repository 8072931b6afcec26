#pragma once
// Proposes the next shifts of a path: fits them to what the last trial left, and emits them.
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "compensate/gouge_guard.h"
#include "compensate/state.h"

namespace camber::compensate {

/// A round before its prediction.
struct PlannedRound {
  std::shared_ptr<const Trial> from;  ///< trial whose error the shifts are fitted to
  std::shared_ptr<Trial> made;        ///< the new trial; only its text is set
  Round round{};
  bool shows_gain = true;  ///< the change of the error shows the sensitivity
};

FitShiftOptions fit_options(const Task& task, std::span<const double> stiffness, std::span<const RowLink> links,
                            std::span<const double> link_stiffness);
/// Returns the options of a fit with all points of the path, by which errors are judged.
FitShiftOptions fit_options(const Task& task, const Version& version);

/// Returns the errors that the next shifts should remove. `guard`: null: without lifts.
std::vector<Observation> wanted_of(const Task& task, const Version& version, const Observed& observed,
                                   const Guard* guard);

/// May change the feeds of the path and the observations that the shifts are fitted to.
using Prepare = std::function<void(std::vector<Observation>&)>;

/// Fits new shifts of the active version to the last trial's error and emits their text; does not predict it.
PlannedRound propose(const Task& task, State& state, double fraction, const Guard* guard, const Prepare& prepare = {});

/// The same with shifts as near to these, one per point of the path, as the path's smoothness allows.
PlannedRound propose_shifts(const Task& task, State& state, std::span<const Vec3> wanted);

/// A lift must remove at least this fraction of the depth beyond the limit.
inline constexpr double kGuardGain = 0.1;

/// Asks for lifts until the shifts that follow are expected to keep the depth limit. Returns false if no shift brings
/// the surface nearer to it, for instance because all shifts are at max_shift_mm.
bool ask_for_lifts(const Task& task, State& state, Guard& guard, double deepest_um);

}  // namespace camber::compensate
