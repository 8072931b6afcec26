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
  /// Lines of the given program that were cut alone, about BindingLimit::line; 0: the whole program was cut.
  std::size_t first_line = 0, last_line = 0;
  bool known() const { return with_um > 0; }
};

struct BindingLimit {
  std::string key;   ///< "max_shift_mm"
  double value = 0;  ///< value of the key in the job, in the key's unit
  double binds_no_more_at = 0;
  bool own = true;        ///< false: the limit is a default, not given by the job
  std::size_t count = 0;  ///< number of path points that the limit holds back; of a depth limit surface points
  double of_path = 1;     ///< their fraction of all path points; of a depth limit 1
  ProgramLine line{};     ///< the line whose path the limit holds back most
  LimitEffect effect{};

  /// A larger value can be expected to take something off the error: more than a few places are held back, and where it
  /// was tried the 95th percentile fell.
  bool larger_helps() const;
};
/// "max_shift_mm = 0.1 binds at 34 points of the path, most in line 12; from 0.134 on it would not; without it the 95th
/// percentile of lines 10 to 14 would be 3.20 instead of 5.10 um".
std::string sentence(const BindingLimit& limit);

/// Returns the limits that bind in the best round. The effect of a path limit is predicted on the stretch that it holds
/// back most, with this one limit removed and from the stock that a rigid tool leaves. The effect of a depth limit is
/// taken from the best round before the guard.
std::vector<BindingLimit> binding_limits(const Task& task, const State& state);

}  // namespace camber::compensate
