#pragma once
// Work offsets and tool offsets from the program (G10) or the caller.
#include <map>
#include <optional>
#include <string_view>

#include "base/geometry.h"

namespace camber::nc {

/// G54, G59.1, G54.1P7, G154P7, G112 (Haas: G154 P3) as ModalState::work_offset has them; nothing for other names.
std::optional<int> work_offset_number(std::string_view name);

/// A work offset: G54 .. G59.3, G54.1 Pn. Numbers as in ModalState::work_offset.
struct WorkOffset {
  Vec3 value_mm = Vec3::Zero();    ///< machine coordinates of its origin
  double rotation_rad = 0;         ///< about Z (G10 L2 R of LinuxCNC)
  Vec3 rotary_rad = Vec3::Zero();  ///< machine coordinates of A, B, C at words of 0
  bool known = false;              ///< false: where it lies is not known; value_mm is relative to that unknown place
  bool read = false;               ///< the program has read it while it was not known: what it sets is relative to that
};

/// A line of the tool offset memory, by its H or D number.
struct ToolOffset {
  std::optional<double> length_mm{}, length_wear_mm{};
  std::optional<double> radius_mm{}, radius_wear_mm{};
  /// Geometry and wear; nothing where neither was given.
  std::optional<double> effective_radius_mm() const {
    if (!radius_mm && !radius_wear_mm) return std::nullopt;
    return radius_mm.value_or(0) + radius_wear_mm.value_or(0);
  }
};

/// All work offsets, as origins in the frame of the moves.
///
/// The frame of the moves is parallel to the machine's axes; its origin is that of the work offset that was active at
/// the first move. Offsets whose values are known lie where their values say; those that are not known all lie in one
/// place. Where both kinds are used, the first one used of the second kind is taken to lie in that place too.
class WorkOffsets {
 public:
  explicit WorkOffsets(const std::map<int, Vec3>& given_mm);

  WorkOffset& at(int number) { return offsets_[number]; }
  bool known(int number) const;
  double rotation_rad(int number) const;
  Vec3 rotary_rad(int number) const;

  /// Origin of the offset in the frame of the moves, mm. `first`: no move was made yet, so this one is the frame.
  Vec3 origin_mm(int number, bool first);
  /// Origin of the machine's coordinates in the frame of the moves; nothing where the offset in use is not known.
  std::optional<Vec3> machine_origin_mm(int number) const;
  /// The common shift of all offsets (Fanuc EXT, G10 L2 P0).
  Vec3 external_mm = Vec3::Zero();

 private:
  std::map<int, WorkOffset> offsets_;
  std::optional<Vec3> anchor_known_, anchor_unknown_;
};

}  // namespace camber::nc
