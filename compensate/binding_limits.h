#pragma once
// Limits of the job that kept the path from the shifts that its error asks for.
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "compensate/safety.h"

namespace camber::compensate {

struct State;
struct Task;

inline constexpr const char *kMaxShiftKey = "max_shift_mm", *kAngleGrowthKey = "max_angle_growth_deg",
                            *kOvercutKey = "max_overcut_um", *kProfileKey = "profile_um";

/// 95th percentiles with a limit and without it, both of a prediction.
struct LimitEffect {
  double with_um = 0, without_um = 0;
  /// Of the given program, what was cut alone: the stretch of the path about BindingLimit::line. 0: all of it.
  std::size_t first_line = 0, last_line = 0;
  bool known() const { return with_um > 0; }
};

struct BindingLimit {
  std::string key;   ///< "max_shift_mm"
  double value = 0;  ///< of the job, in the key's unit
  double binds_no_more_at = 0;
  bool own = true;        ///< false: the job does not give it
  std::size_t count = 0;  ///< points of the path that it holds; of a depth limit points of the surface
  ProgramLine line{};     ///< where it holds the path back most
  LimitEffect effect{};
};
/// "max_shift_mm = 0.1 binds at 34 points of the path, most in line 12; from 0.134 on it would not; without it the 95th
/// percentile of lines 10 to 14 would be 3.20 instead of 5.10 um".
std::string sentence(const BindingLimit& limit);

/// Of the best round. The effect of a limit of the path comes from a prediction of the stretch that it holds back most,
/// with this one limit removed; the stock before it is what a rigid tool leaves. That of a depth limit is the best
/// round before the guard.
std::vector<BindingLimit> binding_limits(const Task& task, const State& state);

}  // namespace camber::compensate
