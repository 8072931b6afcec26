#pragma once
// Moves to reference points and machine coordinates: G28, G29, G30, G28.1, G30.1, G53. Internal to nc/.
#include <array>
#include <optional>

#include "nc/mover.h"

namespace camber::nc {

class ReferenceMoves {
 public:
  ReferenceMoves(BlockContext& at, ModalGroups& modal, FrameCodes& frames, RotaryCodes& rotary, Mover& mover,
                 ToolPlace& place)
      : at_(at), modal_(modal), frames_(frames), rotary_(rotary), mover_(mover), place_(place) {}

  void store_reference(const Code& code);
  void go_to_reference();
  void return_from_reference();
  void go_in_machine_frame();

 private:
  struct StoredReference {
    Vec3 place_mm = Vec3::Zero(), rotary_rad = Vec3::Zero();  ///< place and angles in the frame of the moves
  };

  BlockContext& at_;
  ModalGroups& modal_;
  FrameCodes& frames_;
  RotaryCodes& rotary_;
  Mover& mover_;
  ToolPlace& place_;
  std::optional<Vec3> reference_via_mm_;                              ///< the intermediate point of G28, G30; for G29
  std::array<std::optional<StoredReference>, 2> stored_reference_{};  ///< G28.1, G30.1
};

}  // namespace camber::nc
