#pragma once
// Makes moves: where the words of a block lead, and what a move takes over from the state. Internal to nc/.
#include "nc/radius_codes.h"
#include "nc/rotary_codes.h"
#include "nc/whole_numbers.h"

namespace camber::nc {

class Mover {
 public:
  Mover(BlockContext& at, ModalGroups& modal, FrameCodes& frames, RotaryCodes& rotary, RadiusCodes& radius,
        WholeNumbers& whole_numbers, ToolPlace& place)
      : at_(at),
        modal_(modal),
        frames_(frames),
        rotary_(rotary),
        radius_(radius),
        whole_numbers_(whole_numbers),
        place_(place) {}

  Move& add_move(MoveKind kind, const Vec3& end_mm);
  /// The end of the block's move in the frame of the moves. Axes that no word moves keep their place to the last bit.
  Vec3 target();
  Vec3 programmed_target();
  /// An absolute word puts an axis in the work frame.
  void settle_axes();
  void prepare_cutting(const char* what, bool arc = false);

 private:
  Vec3 target_from(const Vec3& start);
  Vec3 target_at_angle(const Vec3& start, Vec3 end);

  BlockContext& at_;
  ModalGroups& modal_;
  FrameCodes& frames_;
  RotaryCodes& rotary_;
  RadiusCodes& radius_;
  WholeNumbers& whole_numbers_;
  ToolPlace& place_;
  int first_cut_offset_ = 0;
};

}  // namespace camber::nc
