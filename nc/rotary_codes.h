#pragma once
// Rotary axes: words A B C, clamps, tool-centre-point control, and frames that follow the part (G68.2, G53.1, G69,
// G254, G255). Internal to nc/.
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "nc/frame_codes.h"

namespace camber::nc {

class RotaryCodes {
 public:
  RotaryCodes(BlockContext& at, ModalGroups& modal, FrameCodes& frames, ToolPlace& place)
      : at_(at), modal_(modal), frames_(frames), place_(place), start_open_(!at.options.rotary_axes.empty()) {}

  const Vec3& angles_rad() const { return rotary_rad_; }  ///< A, B, C
  /// Target of the block, until it has a move.
  const std::optional<RotaryTarget>& target() const { return rotary_target_; }
  std::optional<RotaryTarget> take_target() { return std::exchange(rotary_target_, std::nullopt); }
  void give_target(const std::optional<RotaryTarget>& target) { rotary_target_ = target; }

  void check_letters();
  void read_rotary_words();
  bool read_clamp(const Code& code);
  bool read_tip_control_m(const Code& code);
  void set_tool_length(const Code& code);

  void set_tilted_frame();
  void cancel_tilted_frame();
  void set_dynamic_offset(const Code& code);
  /// Sets the target of G53.1; false: an error was reported.
  bool align_tool();

  // for moves
  void begin_move(Move& move);
  void add_rotary_target(std::size_t move);
  void turn_home(bool all, std::uint8_t letters, const Vec3& home_rad);
  void add_machine_target(const Vec3& end_mm, std::uint8_t given);
  void settle_axes_for(const char* what, bool line);
  /// The linear axis is programmed.
  void close_axis(int axis);

 private:
  const RotaryOption* rotary_axis(char letter) const;
  void check_rotary_letter(char letter);
  void read_rotary_word(const RotaryOption& axis, RotaryTarget& target);
  void read_tool_direction();
  std::string refuses_rotary() const;
  bool sets_rotary_offset() const;
  std::string needs_kinematics(const Code& code, const char* name) const;
  void set_tip_control(TipControl control, const Code& code);
  void set_tip_control_g(const Code& code);
  void read_tool_length(const Code& code);
  bool rotary_axes_turned() const;
  void open_axes(std::string cause);
  bool may_set_frame(const Code& code);
  void switch_work_frame(WorkFrame frame, const char* code);
  void check_rotary_offset();
  std::uint8_t open_axes_of_move() const;

  BlockContext& at_;
  ModalGroups& modal_;
  FrameCodes& frames_;
  const ToolPlace& place_;
  Vec3 rotary_rad_ = Vec3::Zero();
  std::optional<RotaryTarget> rotary_target_;
  std::uint8_t angles_unknown_ = 0;  ///< bit i: a direction (G43.5, G53.1) has moved A, B, C
  const char* direction_code_ = "";  ///< the code that gave it
  bool tool_length_active_ = false;  ///< G43
  std::uint8_t clamped_ = 0;         ///< bit i: A, B, C
  std::uint8_t open_axes_ = 0;       ///< bit i: X, Y, Z; Move::open_axes, because of rotary axes
  bool aligned_ = false;             ///< G53.1 has put the tool along Z of the tilted frame
  bool start_open_ = false;          ///< the start of the next move is open; at first nobody knows where the machine is
  std::string open_cause_{};         ///< the code that opened them, for messages
};

}  // namespace camber::nc
