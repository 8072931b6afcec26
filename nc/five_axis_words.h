#pragma once
// Words with which the dialects tilt the tool. Kept apart from Dialect, since few files need them; rows in
// nc/dialects.h.
#include <cstdint>
#include <string_view>

#include "nc/dialect.h"

namespace camber::nc {

/// Form in which an operation at one direction of the tool (3+2) is written.
enum class OneDirection : std::uint8_t {
  tip,      ///< under tool-centre-point control
  tilted,   ///< in a tilted frame: G68.2, G53.1
  dynamic,  ///< under the dynamic work offset, G254: rotary axes of the table alone
  joints    ///< X Y Z of the linear axes
};

struct FiveAxisWords {
  std::string_view tip_control = "G43.4";             ///< switches tool-centre-point control on, where no M code does
  OneDirection one_direction = OneDirection::tilted;  ///< usual
  bool tilted_frames = true;                          ///< has G68.2 and G53.1
  bool dynamic_offset = false;                        ///< has G254

  bool writes(OneDirection way) const {
    return way == OneDirection::tilted ? tilted_frames : way != OneDirection::dynamic || dynamic_offset;
  }
};

/// Returns the words of a dialect of dialects().
FiveAxisWords five_axis_words(const Dialect& dialect);

}  // namespace camber::nc
