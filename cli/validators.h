#pragma once
// Checks of options.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/numbers.h"

namespace camber::cli {

/// "nan" and "inf" are none.
inline CLI::Validator number_from_to(double least, double most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        const auto value = parse_number(text);
        return value && *value >= least && *value <= most
                   ? std::string()
                   : fmt::format("{}: a number from {:g} to {:g} was expected", text, least, most);
      },
      "");
}

}  // namespace camber::cli
