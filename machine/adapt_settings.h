#pragma once
// Limits, levers and feeds of camber adapt.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/diagnostics.h"

namespace camber::machine {

/// Limits within which camber adapt keeps the loads. Not given: no limit.
struct AdaptLimits {
  std::optional<double> force_N{};         ///< greatest lateral force of a tooth passing
  std::optional<double> torque_Nmm{};      ///< greatest torque of the spindle
  std::optional<double> deflection_mm{};   ///< greatest deflection of the tip
  std::optional<double> form_error_mm{};   ///< magnitude, against the programmed surface
  std::optional<double> chip_mm{};         ///< thickest chip
  std::optional<double> power_W{};         ///< mean over a tooth passing
  std::optional<double> chip_min_mm{};     ///< thickest chip, at least
  std::optional<double> chatter_margin{};  ///< depth over critical depth; kept by spindle speeds, not by feeds
};

/// Part of a program that camber adapt may change.
enum class AdaptLever : std::uint8_t {
  feed,  ///< F words, by load
  speed  ///< S words, and F with them so that the chip stays
};

struct AdaptSettings {
  AdaptLimits limits;
  bool bounds_feed = true;  ///< a limit bounds the feed from above
  std::vector<AdaptLever> levers{AdaptLever::feed};
  bool has(AdaptLever lever) const { return std::ranges::find(levers, lever) != levers.end(); }
  double lowest_feed_mm_per_s = 0, highest_feed_mm_per_s = 0;  ///< both 0: not given
  std::optional<std::array<double, 2>> spindle_rpm{};          ///< lowest, highest speed that may be used
  double step_fraction = 0.05;                                 ///< feeds that differ by less share an F word
  Diagnostic limits_place;                                     ///< an error without a message where the limits stand
};

}  // namespace camber::machine
