#pragma once
// G40, G41, G42: which radius holds, and when the path under it is computed. Internal to nc/.
#include <cstddef>
#include <optional>

#include "nc/frame_codes.h"

namespace camber::nc {

class RadiusCodes {
 public:
  RadiusCodes(BlockContext& at, ModalGroups& modal, FrameCodes& frames, ToolPlace& place)
      : at_(at), modal_(modal), frames_(frames), place_(place) {}

  void read_radius_number();
  void read_radius_code(const Code& code);
  void check_radius_block();
  /// G40 was read; the cutter is still beside the contour.
  bool leaving() const { return leaving_; }
  void leave_contour(Move& move);
  /// The move off the contour is no arc.
  void refuse_arc(const char* g);
  /// A move was inserted before Interpretation::moves[at].
  void move_inserted(std::size_t at);
  /// Reports what can be said only at the end.
  void finish();

 private:
  /// Cutter radius compensation that is switched on.
  struct Radius {
    bool active = false;
    int g_tenths = 0;
    double radius_mm = 0;
    std::size_t first_move = 0;  ///< index into Interpretation::moves
    std::size_t offset = 0;      ///< position of the G41 or G42
  };
  std::optional<double> radius_of(const Code& code);
  void end_radius();

  BlockContext& at_;
  ModalGroups& modal_;
  const FrameCodes& frames_;
  const ToolPlace& place_;
  Radius radius_;
  int radius_number_ = -1;  ///< the last D
  bool leaving_ = false;
  Vec3 beside_mm_ = Vec3::Zero();
};

}  // namespace camber::nc
