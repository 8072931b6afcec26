#pragma once
// Checks of options.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/numbers.h"

namespace camber::cli {

/// "nan" and "inf" are none.
inline CLI::Validator number_from_to(double min, double max) {
  return CLI::Validator(
      [min, max](std::string& text) {
        const auto value = parse_number(text);
        return value && *value >= min && *value <= max
                   ? std::string()
                   : fmt::format("{}: a number from {:g} to {:g} was expected", text, min, max);
      },
      "");
}

}  // namespace camber::cli
