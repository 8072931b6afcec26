#pragma once
// What a compensation aims at, what it may change, and by how much.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/geometry.h"
#include "machine/simulation_settings.h"

namespace camber::machine {

/// The error that compensation corrects and judges.
enum class Reference {
  commanded,  ///< error_um: against the programmed path
  machine     ///< deflection_um: servo lag and corner rounding are not corrected
};

/// Part of a program that a compensation may change.
enum class Lever : std::uint8_t {
  shift,     ///< points of the path
  feed,      ///< F words, where the error that no shift takes away exceeds the tolerance
  passes,    ///< runs of cuts that are made twice, where it does
  allowance  ///< the passes before, so that they leave as little as they can
};

/// Where the rounds of a compensation end.
enum class Goal : std::uint8_t {
  best,      ///< at the least error: where a round lowers the 95th percentile by no more than a tenth
  tolerance  ///< where what a shift can still correct is small against the tolerance
};

struct CompensationSettings {
  double tolerance_um = 1.0;
  Goal goal = Goal::best;
  Reference reference = Reference::commanded;
  std::optional<std::array<double, 2>> profile_um;  ///< band of the finished surface; not given: tolerance_um
  double max_shift_mm = 0.1;
  int max_rounds = 8;
  double max_overcut_um = 0;  ///< maximum gouge depth, with the predicted deflection; 0: not given
  /// Depth limit of the job; not given: compensation determines one (compensate::default_depth_limit_um).
  std::optional<double> depth_limit_um() const {
    if (profile_um) return -(*profile_um)[0];
    return max_overcut_um > 0 ? std::optional(max_overcut_um) : std::nullopt;
  }
  /// Half of the width of the band.
  double half_width_um() const { return profile_um ? ((*profile_um)[1] - (*profile_um)[0]) / 2 : tolerance_um; }
  std::vector<Lever> levers;  ///< shift is always among them; empty: shift, and feed where F words can be changed
  bool has(Lever lever) const {
    return levers.empty() ? lever == Lever::shift || lever == Lever::feed
                          : std::ranges::find(levers, lever) != levers.end();
  }
  /// Extra machine time for feed and passes: the least error within it. Not given: as much as the tolerance takes, up
  /// to 10 % where the job does not name its levers, else to 200 %.
  std::optional<double> time_budget_percent;
  double min_feed_percent = 20;                 ///< least feed, percent of the programmed one; below it edges rub
  double pass_allowance_mm = 0;                 ///< what the first of two passes, or the one before, leaves; 0: chosen
  double max_angle_growth_rad = 3 * kPi / 180;  ///< between blocks of the path
  Operations operations;                        ///< simulated moves to compensate; none given: the finishing moves
  std::optional<Vec3> work_offset_mm;           ///< program zero in machine coordinates, for the travel limits
};

inline constexpr std::string_view kWantedLevers = "a list of \"shift\", \"feed\", \"passes\" and \"allowance\"";

struct LeverNames {
  std::vector<Lever> levers;
  std::vector<std::string> errors;  ///< "levers names "speed"; ... was expected"; empty: none
};

/// The levers of `names`; "shift" must be among them.
LeverNames levers_of(const std::vector<std::string>& names);

}  // namespace camber::machine
