#pragma once
// Which variables of the control are offsets: #5221 is X of G54.
#include <cstdint>
#include <optional>

#include "nc/dialect.h"

namespace camber::nc {

struct OffsetVariable {
  enum class Kind : std::uint8_t { work, external, tool_length, tool_length_wear, tool_radius, tool_radius_wear };
  Kind kind = Kind::work;
  int number = 0;  ///< number of the work offset (as ModalState::work_offset) or of the tool offset (H or D)
  int axis = 0;    ///< axis of a work offset: X Y Z A B C, or kRotation (LinuxCNC), degrees
  static constexpr int kRotation = 9;
};

/// The variable of that number; nothing where it is no offset.
///
/// Fanuc (B-64484EN, system variables, tool memory C), Haas and Mazak: #5201.. external shift, #5221 + 20 n.. G54 to
/// G59, #7001 + 20 n.. and #14001 + 20 n.. the additional ones (G54.1 P, G154 P). Tool offsets n, from 1:
///
/// |        | length         | its wear       | radius         | its wear       |
/// |--------|----------------|----------------|----------------|----------------|
/// | Fanuc  | #2200, #11000  | #2000, #10000  | #2400, #13000  | #2600, #12000  |
/// | Haas   | #2000          | #2200          | #2400          | #2600          |
/// | Mazak  | #2200, #11000  | #2000, #10000  | #2400, #16000  | #2600, #17000  |
///
/// LinuxCNC: #5221 + 20 n.. G54 to G59.3, the tenth of each the rotation.
std::optional<OffsetVariable> offset_variable(const Dialect& dialect, int number);

}  // namespace camber::nc
