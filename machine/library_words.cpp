#include "machine/library_words.h"

namespace camber::machine {

std::optional<ToolType> type_of_library(std::string_view word) {
  if (word == "ball end mill") return ToolType::ball;
  if (word == "flat end mill" || word == "face mill") return ToolType::flat;
  if (word == "bull nose end mill") return ToolType::bull;
  if (word == "chamfer mill") return ToolType::chamfer;
  if (word.find("drill") != std::string_view::npos) return ToolType::drill;
  return std::nullopt;
}

std::optional<double> modulus_of_library_GPa(std::string_view word) {
  constexpr double kCarbide_GPa = 600, kSteel_GPa = 210;
  if (word == "carbide") return kCarbide_GPa;
  if (word == "hss") return kSteel_GPa;
  return std::nullopt;
}

}  // namespace camber::machine
