#pragma once
// Limits and feeds of camber adapt.
#include <optional>

#include "base/diagnostics.h"

namespace camber::machine {

/// Limits within which camber adapt keeps the loads. Not given: no limit.
struct AdaptLimits {
  std::optional<double> force_N{};        ///< greatest lateral force of a tooth passing
  std::optional<double> torque_Nmm{};     ///< greatest torque of the spindle
  std::optional<double> deflection_mm{};  ///< greatest deflection of the tip
  std::optional<double> form_error_mm{};  ///< magnitude, against the programmed surface
  std::optional<double> chip_mm{};        ///< thickest chip
  std::optional<double> power_W{};        ///< mean over a tooth passing
  std::optional<double> chip_min_mm{};    ///< thickest chip, at least
};

struct AdaptSettings {
  AdaptLimits limits;
  double lowest_feed_mm_per_s = 0, highest_feed_mm_per_s = 0;
  double step_fraction = 0.05;  ///< feeds that differ by less share an F word
  Diagnostic limits_place;      ///< an error without a message where the limits stand
};

}  // namespace camber::machine
