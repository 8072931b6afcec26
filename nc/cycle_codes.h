#pragma once
// Blocks of drilling, tapping and boring cycles. Internal to nc/.
#include <cstddef>
#include <optional>

#include "nc/canned_cycles.h"
#include "nc/mover.h"

namespace camber::nc {

class CycleCodes {
 public:
  CycleCodes(BlockContext& at, ModalGroups& modal, FrameCodes& frames, RotaryCodes& rotary, Mover& mover,
             ToolPlace& place)
      : at_(at), modal_(modal), frames_(frames), rotary_(rotary), mover_(mover), place_(place) {}

  /// A cycle begins where none was active.
  void begin();
  void run_cycle();

 private:
  struct Cycle {
    std::optional<double> r_mm, z_mm, p_s, q_mm;
    std::optional<double> first_peck_mm, peck_less_mm, least_peck_mm;  ///< I J K (Dialect::pecks_by_ijk)
    Vec3 shift_mm = Vec3::Zero();                                      ///< I J K of G76 and G87
    double initial_mm = 0;
  };
  bool read_cycle_words();
  void read_peck_words();
  bool set_shift(CycleHole& hole);
  void drill(const Vec3& place);
  Move& add_cycle_move(const CycleStep& step);
  void turn_before(const CycleStep& step);

  BlockContext& at_;
  ModalGroups& modal_;
  FrameCodes& frames_;
  RotaryCodes& rotary_;
  Mover& mover_;
  ToolPlace& place_;
  Cycle cycle_;
  std::size_t moves_made_ = 0;
};

}  // namespace camber::nc
