#include "machine/compensation_settings.h"

#include <algorithm>

#include <fmt/format.h>

#include "machine/job_keys.h"

namespace camber::machine {

LeverNames levers_of(const std::vector<std::string>& names) {
  LeverNames out;
  for (const std::string& name : names) {
    const auto word = std::ranges::find(kLeverWords, name);
    if (word == kLeverWords.end())
      out.errors.push_back(fmt::format("levers names \"{}\"; {} was expected", name, kWantedLevers));
    else
      out.levers.push_back(static_cast<Lever>(word - kLeverWords.begin()));
  }
  if (std::ranges::find(out.levers, Lever::shift) == out.levers.end())
    out.errors.emplace_back(
        "levers does not name \"shift\", which every compensation needs; [\"shift\", \"feed\"] was expected");
  return out;
}

}  // namespace camber::machine
