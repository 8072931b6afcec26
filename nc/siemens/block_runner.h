#pragma once
// Executes blocks whose words have numbers: modal state, frames, moves, cycles. Which block is next: sequencer.h.
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "nc/arcs.h"
#include "nc/canned_cycles.h"
#include "nc/interpreter.h"
#include "nc/offsets.h"
#include "nc/reporter.h"
#include "nc/siemens/siemens_block_words.h"
#include "nc/siemens/values.h"
#include "nc/tool_names.h"

namespace camber::nc::siemens {

enum class AxisPlace : std::uint8_t {
  never,      ///< not programmed so far; its coordinate counts as 0
  reference,  ///< at a machine coordinate
  known
};

/// A cycle with its parameters; absent ones are empty.
struct CycleCall {
  const WordRow* row = nullptr;
  std::vector<std::optional<Value>> values;
  std::uint32_t offset = 0;

  bool has(std::size_t i) const { return i < values.size() && values[i].has_value() && !values[i]->text; }
  double number(std::size_t i, double otherwise = 0) const { return has(i) ? values[i]->number : otherwise; }
  /// Of a parameter whose digits have meanings of their own: the one at 1, 10, 100 ...
  int digit(std::size_t i, int power) const { return static_cast<int>(number(i)) / power % 10; }
  std::string text(std::size_t i) const {
    return i < values.size() && values[i] && values[i]->text ? *values[i]->text : std::string();
  }
};

/// Place of a block.
struct BlockPlace {
  const Program* file = nullptr;
  std::uint32_t block = 0;
  std::uint32_t called_from = 0;  ///< Move::block
  bool editable = true;           ///< Move::editable, as far as the sequencer knows
};

class BlockRunner : public SystemValues {
 public:
  BlockRunner(const Program& program, const InterpreterOptions& options, Reporter& report, Interpretation& out);

  // One block: begin, then words, then execute.
  void begin(const BlockPlace& place);
  void add_plain(std::span<const Word> words);
  BlockWords& words() { return words_; }
  bool goes_to_fixed_point() const;
  void set_command(const WordRow& row, std::uint32_t offset);
  void set_tool_name(const std::string& name, std::uint32_t offset);
  /// Carries the block out. Returns false at the end of the program (M2, M30); `ends_subprogram`: M17 was in it.
  bool execute(bool& ends_subprogram);
  /// Returns whether the last executed block has moved X, Y or Z: MCALL acts behind it.
  bool has_moved() const { return moved_; }

  void run_cycle(const CycleCall& call, const BlockPlace& place);
  bool drills(const CycleCall& call) const { return call.row->does == Does::drilling; }
  /// A pattern of holes: the places, in program coordinates. `visit` runs behind each move.
  void run_pattern(const CycleCall& call, const BlockPlace& place, const std::function<void()>& visit);
  void set_stock(const CycleCall& call, std::uint32_t block);
  void leave_for_machine_place(char axis, const std::string& name, std::uint32_t offset);
  void go_home(const WordRow& row, std::uint32_t offset, const BlockPlace& place);
  /// SETMS(n), OFFN=, RNDM=
  void set_main_spindle(int number) { main_spindle_ = number, main_spindle_named_ = true; }
  /// S3=2000 of a spindle that is not the main one: it counts where that one is the first to turn.
  void note_speed(int spindle, const Slot& speed) { other_speeds_[spindle] = speed; }
  int main_spindle() const { return main_spindle_; }
  void set_offset_normal(double value) { offset_normal_mm_ = value * unit_mm(); }
  void set_contour_tolerance(double tolerance);
  void set_modal_rounding(double value) { modal_rounding_mm_ = value * unit_mm(); }
  void set_block_feed(double value) { request_.block_feed = value; }
  void set_corner_feed(double value, bool modal) { (modal ? modal_corner_feed_ : request_.corner_feed) = value; }
  /// POS, POSA: the axis goes there by itself.
  void position_axis(char letter, const Slot& slot);
  void orient_spindle() { add_event(EventKind::spindle_orient, 0); }
  void set_frame_variable(const std::string& name, const std::vector<double>& indexes,
                          const std::vector<std::string>& index_names, const Value& value, std::uint32_t offset);
  void finish();

  struct Saved;
  std::shared_ptr<const Saved> saved_modes() const;
  void restore(const Saved& saved);

  std::optional<Value> system_value(const std::string& name, const std::vector<Value>& indexes,
                                    const std::vector<std::string>& index_names) override;
  double unit_mm() const override { return state_.inch ? kInch : 1.0; }

 private:
  enum class Motion : std::uint8_t {
    rapid,
    linear,
    clockwise,
    counter_clockwise,
    through_point,
    tangential,
    tapping_in,
    tapping_out
  };
  static constexpr double kInch = 25.4;

  /// Non-modal requests of the block.
  struct Request {
    bool exact_stop = false, machine_frame = false, dwell = false, trouble = false;
    bool fixed_point = false;      // G74, G75
    int pole = 0;                  // G110, G111, G112
    int shift = 0;                 // G58, G59
    std::uint32_t positioned = 0;  // bit i: POS or POSA of the axis 'A' + i
    bool motion_given = false;
    std::uint32_t motion_offset = 0;
    const WordRow* frame = nullptr;
    std::uint32_t frame_offset = 0;
    bool limits = false;                                // G25, G26: words are limits
    std::optional<double> block_feed{}, corner_feed{};  // FB; FRC, FRCM
  };
  struct Radius {
    bool active = false;
    int g = 0;
    double radius_mm = 0;
    std::size_t first_move = 0;
    std::size_t offset = 0;
  };
  struct Corner {
    bool waits = false, chamfer = false, modal = false;
    double size_mm = 0;
    std::size_t move = 0, offset = 0;
    std::string text;
    std::optional<double> feed_mm_per_s{};
  };

  // modal_words.cpp
  void read_g_codes();
  void read_g_code(const CodeWord& code);
  void set_work_offset(int g);
  void set_feed_mode(FeedMode mode);
  void read_feed();
  double internal_feed(double value) const;
  void begin_cutting_speed(const CodeWord& code);
  void read_spindle_speed();
  void read_tool();
  void change_tool(std::uint32_t offset);
  void read_edge();
  void read_m_codes_before();
  void start_spindle(const CodeWord& code);
  bool read_m_codes_after(bool& ends_subprogram);
  void set_contouring();
  void set_mode_word(std::string_view upper_name);
  void check_letters();

  // frames.cpp
  void update_frame();
  Affine total_frame() const;
  void run_frame_command();
  void set_programmable_shift();
  void swivel(const CycleCall& call, const BlockPlace& place);
  Vec3 programmed() const { return frame_.to_program(position_mm_); }
  void settle_machine_axis(std::size_t axis, double machine_mm, Vec3& place_mm);

  // motion.cpp
  void move();
  void go_in_machine_frame();
  void go_to_fixed_point();
  void dwell();
  void set_pole();
  void move_on_line();
  void move_on_arc();
  void move_through_point();
  void move_tangentially();
  void make_arc_move(const ArcWords& arc, const Vec3& end_mm, const char* g);
  bool arc_error(const ArcResult& result, const ArcWords& arc);
  Vec3 target();
  Vec3 target_in_program();
  Vec3 polar_target(Vec3 start);
  double axis_value(const Slot& slot, double start, double unit) const;
  void note_dimensions();
  void prepare_cutting(const char* what, bool arc = false);
  std::optional<double> cutting_feed(double length_mm, const char* g);
  void check_unit();
  void settle_axes();
  bool place_unknown() const;
  Move& add_move(MoveKind kind, const Vec3& end_mm);
  std::uint32_t state_index();
  void add_event(EventKind kind, double value);
  std::optional<Vec3> last_direction() const;

  // corners.cpp
  void read_corner(std::size_t moves_before);
  void finish_corner(std::size_t moves_before);
  void put_corner(const Corner& corner, std::size_t before, std::size_t after);

  // radius.cpp
  void read_radius_code(const CodeWord& code);
  void end_radius();
  void leave_contour(Move& move);

  // rotary.cpp
  const RotaryOption* rotary_axis(char letter) const;
  void read_rotary_words();
  void read_rotary_word(const RotaryOption& axis, RotaryTarget& target);
  void read_tool_direction();
  void check_rotary_letter(char letter);
  void set_tip_control(TipControl control, const char* code, std::uint32_t offset);
  void open_axes(std::string cause);
  void settle_axes_for(const char* what, bool line);
  void add_rotary_target(std::size_t move);
  void add_machine_target(const Vec3& end_mm, std::uint8_t given);
  std::uint8_t open_axes_of_move() const;
  bool rotary_axes_turned() const { return angles_unknown_ != 0 || rotary_rad_ != Vec3::Zero(); }
  void update_tool_length();

  // cycles.cpp
  void drill(const CycleCall& call);
  void mill_thread(const CycleCall& call);
  void mill_pocket_cycle(const CycleCall& call);
  void run_pocket(const PocketCycle& pocket, const CycleCall& call);
  void mill_slots(const CycleCall& call);
  double sense_of(int cdir) const;
  double bottom_mm(const CycleCall& call) const;
  void mill_face(const CycleCall& call);
  bool begin_milling(const CycleCall& call);
  double cutter_radius_mm(const CycleCall& call, bool needed);
  void rapid_to_height(double height_mm);
  void go(CycleStep::Kind kind, const Vec3& program_mm, double feed_mm_per_s, int g);
  void go_round(const Vec3& end, const Vec3& centre, double sweep_rad, double feed_mm_per_s);
  std::optional<double> cycle_feed(double given, const CycleCall& call, const char* what);
  std::string name_of(const CycleCall& call) const { return std::string(call.row->name); }

  void error(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});
  void change_state() { state_changed_ = true; }

  const Program* main_;
  const Program* program_;
  const InterpreterOptions& options_;
  Reporter& report_;
  Interpretation& out_;

  BlockWords words_;
  Request request_;
  BlockPlace place_of_block_;
  bool editable_ = true;
  bool moved_ = false;

  ModalState state_;
  bool state_changed_ = true;
  std::uint32_t state_index_ = 0;
  Motion motion_ = Motion::linear;
  Plane plane_ = Plane::xy;
  bool absolute_ = true;
  bool unit_given_ = false;
  std::optional<double> feed_;  ///< mm/s (G94), 1/s (G93), mm a turn (G95)
  bool feed_given_ = false, feed_by_variable_ = false;
  int main_spindle_ = 1;
  bool main_spindle_named_ = false;  ///< by SETMS
  std::map<int, Slot> other_speeds_;
  int next_tool_ = -1;
  bool tool_changed_ = false;
  std::size_t tool_word_offset_ = 0;
  int edge_ = 1;  ///< D
  ToolNumbers tools_;
  int first_cut_offset_ = 0;

  bool cycle832_ = false, compressor_ = false;
  bool cutting_speed_ = false;                                     ///< G96: S is no spindle speed
  double cycle832_tolerance_mm_ = -1, contour_tolerance_mm_ = -1;  ///< negative: not given
  int blending_ = 60;                                              ///< 60, 64, 641 ...
  /// Path control before CYCLE832, which rounds corners (G645); none where a word of its own has followed.
  std::optional<std::pair<PathControl, std::uint8_t>> before_cycle832_;
  double adis_mm_ = 0;

  WorkOffsets offsets_;
  Affine programmable_;                ///< TRANS, ROT, SCALE, MIRROR
  Vec3 fine_shift_mm_ = Vec3::Zero();  ///< part of it that G59 has set
  std::optional<Affine> swivelled_;    ///< CYCLE800
  Frame frame_;
  Vec3 pole_mm_ = Vec3::Zero();
  std::map<int, ToolOffset> tool_offsets_;
  double offset_normal_mm_ = 0;
  double modal_rounding_mm_ = 0;
  std::optional<double> modal_corner_feed_;  ///< FRCM
  Radius radius_;
  bool not_editable_told_ = false;
  bool leaving_ = false;
  Vec3 beside_mm_ = Vec3::Zero();
  ReliedEnds relied_ends_;
  Corner corner_;

  Vec3 rotary_rad_ = Vec3::Zero();
  std::optional<RotaryTarget> rotary_target_;
  std::uint8_t angles_unknown_ = 0;
  const char* direction_code_ = "";
  bool aligned_ = false;

  Vec3 position_mm_ = Vec3::Zero();
  std::array<AxisPlace, 3> place_{AxisPlace::never, AxisPlace::never, AxisPlace::never};
  std::uint8_t open_axes_ = 0;
  bool start_open_ = false;
  std::string open_cause_;
  std::size_t cycle_moves_ = 0;
};

struct BlockRunner::Saved {
  Motion motion;
  Plane plane;
  bool absolute, inch;
  FeedMode feed_mode;
  Affine programmable;
  int work_offset;
};

}  // namespace camber::nc::siemens
