#pragma once
// Where programmed coordinates lie: G10, G15 G16, G50 G51, G50.1 G51.1, G52, G68, G92, work offsets, and the memory of
// tool offsets. Frames that follow the part: rotary_codes.h. Internal to nc/.
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nc/frames.h"
#include "nc/modal_groups.h"
#include "nc/offset_variables.h"

namespace camber::nc {

class FrameCodes {
 public:
  FrameCodes(BlockContext& at, ModalGroups& modal, ToolPlace& place);

  const Frame& frame() const { return frame_; }
  Vec3 programmed() const { return frame_.to_program(place_.position_mm); }
  Vec3 polar_target(Vec3 programmed_mm);
  bool offset_known(int work_offset) const { return frames_.offsets.known(work_offset); }
  Vec3 rotary_offset_rad() const { return frames_.offsets.rotary_rad(modal_.state().work_offset); }
  std::optional<Vec3> machine_origin_mm() const {
    return frames_.offsets.machine_origin_mm(modal_.state().work_offset);
  }
  const ToolOffset* tool_offset(int number) const;  ///< null: not known

  void read_frame_code(const Code& code);
  /// The code of the block's request; update_frame() comes after it.
  void run_frame_code();
  /// Something other than unknown work offsets is active.
  void mark_used() { used_ = true; }
  void update_frame();
  void work_offset_selected();

  /// The value of an offset in millimetres or degrees; nothing where it is not known.
  std::optional<double> offset_value(const OffsetVariable& variable);
  /// The program sets it (#5221 = 10.). `at`: in the text.
  void set_offset(const OffsetVariable& variable, double value, std::size_t at);

  // G68.2
  void set_tilt(const std::optional<Tilt>& tilt);
  Vec3 tilted_normal() const;  ///< Z of the tilted frame
  /// Ends rotation and tilted frame; true: there was a tilted one.
  bool cancel_rotation();

  /// An axis goes to a machine coordinate.
  void settle_machine_axis(std::size_t axis, double machine_mm, Vec3& place_mm);

 private:
  void set_local_shift();
  void set_position();
  void place_at_program_point(int axis, double programmed_mm);
  void restore_shift(int tenths);
  void set_rotation();
  void set_scaling();
  double scale_value(char letter);
  void set_mirror();
  void set_data();
  void set_work_offset_data(bool touch_off);
  void warn_of_moved_offset(int number, std::size_t at, const std::string& name);
  void take_pending_offset();
  void set_tool_data(int kind);

  BlockContext& at_;
  ModalGroups& modal_;
  ToolPlace& place_;
  Frames frames_;
  Frame frame_;
  bool used_ = false;
  std::vector<std::pair<OffsetVariable, double>> pending_offsets_;  ///< LinuxCNC: count when they are next selected
  double polar_angle_deg_ = 0;
  std::map<int, ToolOffset> tool_offsets_;
};

}  // namespace camber::nc
