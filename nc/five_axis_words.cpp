#include "nc/five_axis_words.h"

#include <array>
#include <utility>

namespace camber::nc {
namespace {

/// Rows that differ from the default.
constexpr std::array<std::pair<std::string_view, FiveAxisWords>, 2> kFiveAxisWords{
    {{"haas", {"G234", OneDirection::dynamic}}, {"linuxcnc", {"G43.4", OneDirection::joints}}}};

}  // namespace

FiveAxisWords five_axis_words(const Dialect& dialect) {
  for (const auto& [name, words] : kFiveAxisWords)
    if (name == dialect.name) return words;
  return {};
}

}  // namespace camber::nc
