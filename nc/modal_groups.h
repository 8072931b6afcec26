#pragma once
// Modal groups: motion, plane, unit, feed, spindle, tool, work offset, path control. Internal to nc/.
#include <cstdint>
#include <functional>
#include <optional>

#include "nc/arcs.h"
#include "nc/block_context.h"
#include "nc/modal_codes.h"

namespace camber::nc {

/// Values of the control's variables.
struct MachineFacts {
  Vec3 position_mm = Vec3::Zero();
  double unit_mm = 1;
  const ModalState* state = nullptr;
  int motion_g = 0;  ///< 0 .. 3; 0 where none was given
  int plane_g = 17;
  int cycle_g = 0;  ///< 0: none active
  bool return_to_r = false;
  double feed = 0;  ///< F as the program gave it
  int selected_tool = 0;
};

enum class MotionCode : std::uint8_t { none, rapid, linear, clockwise, counter_clockwise };

class ModalGroups {
 public:
  explicit ModalGroups(BlockContext& at);

  const ModalState& state() const { return state_; }
  /// The state to be changed; the next move has another one.
  ModalState& change() {
    state_changed_ = true;
    return state_;
  }
  std::uint32_t state_index();  ///< in Interpretation::states
  MotionCode motion() const { return motion_; }
  bool is_arc() const { return motion_ == MotionCode::clockwise || motion_ == MotionCode::counter_clockwise; }
  bool spiral() const { return spiral_; }  ///< G2.1, G3.1
  Plane plane() const { return plane_; }
  int cycle_g() const { return cycle_g_; }                       ///< drilling cycle; 0: none active
  int radius_g() const { return radius_g_; }                     ///< 41, 42; 0: off
  bool return_to_r() const { return return_to_r_; }              ///< G99
  bool centre_mode_given() const { return centre_mode_given_; }  ///< G90.1 or G91.1
  const std::optional<double>& feed() const { return feed_; }    ///< mm/s (G94), 1/s (G93), mm a turn (G95)
  double unit_mm() const { return state_.inch ? kInch : 1.0; }
  void add_facts(MachineFacts& out) const;

  // G codes
  void check_one_of_each_group();
  /// Axis words of a block belong to one code, and a cycle needs some.
  void check_strict_block();
  void set_unit(bool inch);
  void set_motion(const Code& code);
  void set_cycle(const Code& code);
  void set_plane(const Code& code);
  void set_arc_centre(bool absolute);
  void set_feed_mode(FeedMode mode);
  void set_return_level(bool return_to_r) { return_to_r_ = return_to_r; }
  void set_path_control(int tenths);
  void set_contouring(const Code& code);
  /// True: another offset is active.
  bool set_work_offset(const Code& code);
  /// `g`: 41, 42; 0: off. `computed`: the path is computed with a radius that is not zero.
  void set_cutter_radius(int g, bool computed);

  // words and M codes
  void read_feed();
  void read_spindle_speed();
  void read_tool();
  /// `is_read`: reads codes of other parts; true: the code is one.
  void read_m_codes_before(const std::function<bool(const Code&)>& is_read);
  bool read_m_codes_after();
  void add_event(EventKind kind, double value);

  // for moves
  /// Warns where neither G20 nor G21 was given so far.
  void check_unit();
  std::optional<double> cutting_feed(double length_mm, const char* g);
  void give_feed_to(Move& move);
  void check_tool_changes();

 private:
  static constexpr double kInch = 25.4;

  void check_m_groups();
  void add_m_event(const Code& code);
  int additional_work_offset(const Code& code);
  std::optional<double> per_revolution_feed();

  BlockContext& at_;
  ModalState state_;
  bool state_changed_ = true;
  std::uint32_t state_index_ = 0;
  MotionCode motion_ = MotionCode::none;
  bool spiral_ = false;
  Plane plane_ = Plane::xy;
  int cycle_g_ = 0, radius_g_ = 0;
  bool return_to_r_ = false;
  bool unit_given_ = false;
  bool centre_mode_given_ = false;
  std::optional<double> feed_;
  bool feed_given_ = false;  ///< since the last move
  bool feed_by_variable_ = false;
  int next_tool_ = -1;
  bool tool_changed_ = false;
  std::size_t tool_word_offset_ = 0;
};

}  // namespace camber::nc
