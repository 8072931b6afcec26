#pragma once
#include <cstdint>

namespace camber::nc {

enum class LanguageId : std::uint8_t {
  iso,         ///< G code: Fanuc, Haas, Mazak, LinuxCNC
  heidenhain,  ///< Klartext
  siemens      ///< Sinumerik
};

}  // namespace camber::nc
