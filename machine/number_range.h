#pragma once
// Which numbers a key of a file takes.
#include <limits>
#include <string>

namespace camber::machine {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Which numbers a key takes, and how a message says so.
struct NumberRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;         ///< min itself is not allowed
  bool infinity_allowed = false;  ///< the TOML value `inf`
  bool whole = false;             ///< whole numbers only

  bool holds(double value) const;
  /// "a number greater than zero", "a whole number from 1 to 20" ...
  std::string wanted() const;
};

inline constexpr NumberRange kAnyNumber{};
inline constexpr NumberRange kPositive{.min = 0, .above_min = true};
inline constexpr NumberRange kPositiveOrInf{.min = 0, .above_min = true, .infinity_allowed = true};
inline constexpr NumberRange kNotNegative{.min = 0};
inline constexpr NumberRange kNotNegativeOrInf{.min = 0, .infinity_allowed = true};
inline constexpr NumberRange kAnyNumberOrInf{.infinity_allowed = true};

}  // namespace camber::machine
