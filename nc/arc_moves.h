#pragma once
// Arcs and spirals: G2, G3, G2.1, G3.1. Internal to nc/.
#include <cstddef>

#include "nc/arcs.h"
#include "nc/mover.h"

namespace camber::nc {

class ArcMoves {
 public:
  ArcMoves(BlockContext& at, ModalGroups& modal, FrameCodes& frames, RotaryCodes& rotary, RadiusCodes& radius,
           Mover& mover, ToolPlace& place)
      : at_(at), modal_(modal), frames_(frames), rotary_(rotary), radius_(radius), mover_(mover), place_(place) {}

  void move_on_arc();
  /// RunVerdict::centres_look_absolute
  bool centres_look_absolute() const;

 private:
  bool other_centre_fits(const ArcWords& arc) const;
  bool arc_error(const ArcResult& result, const ArcWords& arc);
  void motion_point(const Vec3& end_mm, const char* g);
  void read_spiral_turns(ArcWords& arc);
  void read_spiral_words(ArcWords& arc);

  BlockContext& at_;
  ModalGroups& modal_;
  FrameCodes& frames_;
  RotaryCodes& rotary_;
  RadiusCodes& radius_;
  Mover& mover_;
  ToolPlace& place_;
  std::size_t arcs_fit_relative_ = 0, arcs_fit_absolute_ = 0;
};

}  // namespace camber::nc
