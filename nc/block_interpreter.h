#pragma once
// Executes one block on the state of the interpreter. Internal to nc/; the interface is interpreter.h.
#include <array>
#include <optional>
#include <string>

#include "nc/arcs.h"
#include "nc/block_words.h"
#include "nc/canned_cycles.h"
#include "nc/frames.h"
#include "nc/interpreter.h"
#include "nc/modal_codes.h"
#include "nc/offset_variables.h"

namespace camber::nc {

/// State of knowledge of an axis position in the work frame.
enum class AxisPlace : std::uint8_t {
  never,      ///< not programmed so far; its coordinate counts as 0
  reference,  ///< at the reference point or at a machine coordinate (G28, G30, G53)
  known
};

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

/// A block to execute: position of its text, and its words.
struct RunBlock {
  const Program& program;       ///< file of the block
  std::uint32_t block = 0;      ///< index in that file
  std::span<const Word> words;  ///< words whose values are numbers
  std::uint32_t called_from;    ///< Move::block: the block itself, or of the main program the one that called the file
  bool editable = true;         ///< Move::editable
};

/// Doubts about the options that a run raises.
struct RunVerdict {
  /// Arcs fit with absolute centres only, none with relative ones only, and no word says which they are.
  bool centres_look_absolute = false;
  /// Not empty: how numbers without a decimal point count is not known, no coordinate has a point, and read as
  /// millimetres or inches they are larger than any machine.
  std::string increments_warning{};
  std::size_t increments_offset = 0;
};

class BlockInterpreter {
 public:
  BlockInterpreter(const Program& program, const InterpreterOptions& options, Reporter& report, Interpretation& out);

  /// Runs one block; false at the end of the program (M2, M30) or where reading on makes no sense.
  bool run(std::uint32_t block) { return run({*program_, block, program_->words_of(block), block}); }
  bool run(const RunBlock& block);
  MachineFacts facts() const;
  /// The value of an offset in millimetres or degrees; nothing where it is not known.
  std::optional<double> offset_value(const OffsetVariable& variable);
  /// The program sets it (#5221 = 10.). `offset`: in the text.
  void set_offset(const OffsetVariable& variable, double value, std::size_t offset);
  /// Reports what can be said only at the end.
  void finish();
  RunVerdict verdict() const;

 private:
  enum class Motion : std::uint8_t { none, rapid, linear, clockwise, counter_clockwise };
  /// Non-modal actions of the G codes of one block.
  struct Request {
    bool dwell = false, exact_stop = false, machine_frame = false, reference = false;
    bool motion_given = false, cycle_given = false, feed_mode_given = false;
    bool skip_motion = false;  ///< the axis words belong to something that is not read
    bool trouble = false;      ///< an error was reported: say nothing of unused words
    const Word* motion_word = nullptr;
    const Word* reference_word = nullptr;
    Code frame_code{};  ///< a code whose words set a frame or an offset (G10, G52, G68 ...); no word: none
    bool return_from_reference = false;
    bool single_direction = false;  ///< G60
  };
  /// Cutter radius compensation that is switched on.
  struct Radius {
    bool active = false;
    int g_tenths = 0;
    double radius_mm = 0;
    std::size_t first_move = 0;  ///< index into Interpretation::moves
    std::size_t offset = 0;      ///< position of the G41 or G42
  };
  struct Cycle {
    int g = 0;  ///< 0: none active
    std::optional<double> r_mm, z_mm, p_s, q_mm;
    std::optional<double> first_peck_mm, peck_less_mm, least_peck_mm;  ///< I J K (Dialect::pecks_by_ijk)
    Vec3 shift_mm = Vec3::Zero();                                      ///< I J K of G76 and G87
    double initial_mm = 0;
    bool incremental = false;
    bool peck_warned = false;
  };

  /// ,R or ,C of a block that has moved, until the next one does.
  struct Corner {
    bool waits = false;
    bool chamfer = false;
    double size_mm = 0;    ///< radius; of a chamfer the distance from the corner
    std::size_t move = 0;  ///< index into Interpretation::moves
    std::size_t offset = 0;
    std::string text;  ///< text of the word, for messages
  };

  // modal_state.cpp: words that change the state
  bool read_g_codes();
  bool read_g_code(const Code& code, const GCode& meaning);
  void check_one_of_each_group();
  void check_m_groups();
  void check_strict_block();
  int additional_work_offset(const Code& code);
  void check_offset_numbers();
  void set_motion(const Code& code);
  void set_cycle(const Code& code);
  void set_plane(const Code& code);
  void set_work_offset(const Code& code);
  void set_path_control(int tenths);
  void set_tool_length(const Code& code);
  void set_feed_mode(FeedMode mode);
  void set_contouring(const Code& code);
  void scale_whole_numbers();
  /// Factor on the value of a number without a decimal point. 1: as it stands.
  double whole_number_scale_of(const Word& word);
  double whole_number_unit(char letter, bool& is_angle) const;
  std::string whole_numbers_setting() const;
  void warn_of_whole_numbers();
  void read_feed();
  void read_radius_number();
  void read_spindle_speed();
  void read_tool();
  bool read_m_codes_before();
  bool read_m_codes_after();
  void check_letters();
  void warn_of_unused_words();

  // frame_codes.cpp: where programmed coordinates lie
  void read_frame_code(const Code& code);
  void run_frame_code();
  void set_local_shift();
  void set_position();
  void place_at_program_point(int axis, double programmed_mm);
  void restore_shift(int tenths);
  void set_rotation();
  void set_scaling();
  void set_mirror();
  void set_data();
  void set_work_offset_data(bool touch_off);
  void warn_of_moved_offset(int number, std::size_t at, const std::string& name);
  void take_pending_offset();
  void set_tool_data(int kind);
  double scale_value(char letter);
  void update_frame();
  void settle_machine_axis(std::size_t axis, double machine_mm, Vec3& place_mm);
  Vec3 programmed() const { return frame_.to_program(position_mm_); }
  Vec3 polar_target(Vec3 programmed_mm);
  void return_from_reference();

  // radius_codes.cpp: G40, G41, G42
  void read_radius_code(const Code& code);
  std::optional<double> radius_of(const Code& code);
  void check_radius_block();
  void end_radius();
  void leave_contour(Move& move);

  // corner_words.cpp: ,R ,C ,A
  void read_corner_words(std::size_t moves_before);
  void finish_corner(std::size_t moves_before);
  void put_corner(const Corner& corner, std::size_t before, std::size_t after);
  void corner_error(std::size_t offset, std::string message);
  Vec3 target_at_angle(const Vec3& start, Vec3 end);

  // rotary_codes.cpp: A B C, tool-centre-point control, clamps
  const RotaryOption* rotary_axis(char letter) const;
  bool read_clamp(const Code& code);
  bool read_tip_control_m(const Code& code);
  void set_tip_control(TipControl control, const Code& code);
  void set_tip_control_g(const Code& code);
  void read_tool_length(const Code& code);
  std::string refuses_rotary() const;
  void read_rotary_words();
  void read_rotary_word(const RotaryOption& axis, RotaryTarget& target);
  void read_tool_direction();
  std::string needs_kinematics(const Code& code, const char* name) const;
  bool sets_rotary_offset() const;
  void add_rotary_target(std::size_t move);
  void check_rotary_letter(char letter);

  // tilted_codes.cpp: G68.2, G53.1, G69, G254, G255
  bool rotary_axes_turned() const;
  void open_axes(std::string cause);
  void settle_axes_for(const char* what, bool line);
  bool may_set_frame(const Code& code);
  void set_tilted_frame();
  void align_tool();
  void cancel_tilted_frame();
  void set_dynamic_offset(const Code& code);
  void switch_work_frame(WorkFrame frame, const char* code);
  void check_rotary_offset();
  void add_machine_target(const Vec3& end_mm, std::uint8_t given);
  std::uint8_t open_axes_of_move() const;

  // motion.cpp: words that make moves
  void dwell();
  void move_after_dwell();
  std::optional<double> dwell_seconds(char letter);
  void go_to_reference();
  void store_reference(const Code& code);
  void turn_home(bool all, std::uint8_t letters, const Vec3& home_rad);
  void go_in_machine_frame();
  void move();
  void move_on_line();
  void move_on_arc();
  // cycle_codes.cpp
  void run_cycle();
  bool read_cycle_words();
  void read_peck_words();
  bool set_shift(CycleHole& hole);
  void drill(const Vec3& place);
  Move& add_cycle_move(const CycleStep& step);
  void turn_before(const CycleStep& step);
  bool arc_error(const ArcResult& arc, const ArcWords& words);
  bool other_centre_fits(const ArcWords& words) const;
  Vec3 target();
  Vec3 target_from(const Vec3& start);
  Vec3 programmed_target();
  void read_spiral_words(ArcWords& arc);
  void read_spiral_turns(ArcWords& arc);
  void position_in_one_direction();
  void prepare_cutting(char const* what, bool arc = false);
  void motion_point(const Vec3& end_mm, const char* g);
  std::optional<double> cutting_feed(double length_mm, char const* g);
  std::optional<double> per_revolution_feed();
  void check_unit();
  void settle_axes();
  bool place_unknown() const;
  Move& add_move(MoveKind kind, const Vec3& end_mm);
  std::uint32_t state_index();
  void add_event(EventKind kind, double value);
  void add_m_event(const Code& code);

  void error(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});
  std::string code_text(const Code& code) const;
  bool written_with_point(const Word& word) const;
  bool written_as_number(const Word& word) const;
  double unit_mm() const { return state_.inch ? kInch : 1.0; }
  static constexpr double kInch = 25.4;

  /// Words whose reading depends on the setting for numbers without a decimal point, where it is not known.
  struct WholeNumbers {
    const Program* file = nullptr;  ///< file of the first one; null: there is none
    std::size_t offset = 0;
    std::string text;
    double scale = 1;
    std::size_t more = 0;
    bool any_point = false;  ///< a coordinate of the program has a point
    double largest_mm = 0;   ///< coordinate without one
    double value = 0;        ///< as written
    bool inch = false, is_time = false, is_angle = false;
    std::string read_with(double factor) const;
  };

  const Program* main_;
  const Program* program_;
  const InterpreterOptions& options_;
  Reporter& report_;
  Interpretation& out_;

  BlockWords words_;
  Request request_;
  std::uint32_t block_ = 0;
  bool editable_ = true;

  ModalState state_;
  bool state_changed_ = true;
  std::uint32_t state_index_ = 0;
  Motion motion_ = Motion::none;
  bool spiral_ = false;  ///< G2.1, G3.1
  Plane plane_ = Plane::xy;
  Cycle cycle_;
  std::size_t cycle_moves_ = 0;  ///< made by drilling cycles so far
  bool return_to_r_ = false;     ///< G99
  bool unit_given_ = false;
  std::optional<double> feed_;  ///< mm/s (G94), 1/s (G93), mm a turn (G95)
  bool feed_given_ = false;     ///< since the last move
  bool feed_by_variable_ = false;
  int next_tool_ = -1;
  bool tool_changed_ = false;
  std::size_t tool_word_offset_ = 0;
  int first_cut_offset_ = 0;
  bool centre_mode_given_ = false;  ///< G90.1 or G91.1
  std::size_t arcs_fit_relative_ = 0, arcs_fit_absolute_ = 0;

  Frames frames_;
  std::vector<std::pair<OffsetVariable, double>> pending_offsets_;  ///< LinuxCNC: count when they are next selected
  Frame frame_;
  bool frames_used_ = false;  ///< something other than unknown work offsets is active
  bool not_editable_told_ = false;
  double polar_angle_deg_ = 0;
  std::optional<Vec3> reference_via_mm_;  ///< the intermediate point of G28, G30; for G29
  struct StoredReference {
    Vec3 place_mm = Vec3::Zero(), rotary_rad = Vec3::Zero();  ///< place and angles in the frame of the moves
  };
  std::array<std::optional<StoredReference>, 2> stored_reference_{};  ///< G28.1, G30.1
  std::map<int, ToolOffset> tool_offsets_;
  Radius radius_;
  int radius_number_ = -1;  ///< the last D
  Corner corner_;
  WholeNumbers whole_numbers_;
  std::size_t operation_ = 0;  ///< counts tool changes: limits are said once in each
  bool leaving_ = false;       ///< G40 was read; the cutter is still beside the contour
  Vec3 beside_mm_ = Vec3::Zero();

  Vec3 rotary_rad_ = Vec3::Zero();             ///< A, B, C
  std::optional<RotaryTarget> rotary_target_;  ///< target of the block, until it has a move

  Vec3 position_mm_ = Vec3::Zero();
  std::array<AxisPlace, 3> place_{AxisPlace::never, AxisPlace::never, AxisPlace::never};
  std::uint8_t angles_unknown_ = 0;  ///< bit i: a direction (G43.5, G53.1) has moved A, B, C
  const char* direction_code_ = "";  ///< the code that gave it
  bool tool_length_active_ = false;  ///< G43
  std::uint8_t clamped_ = 0;         ///< bit i: A, B, C
  std::uint8_t open_axes_ = 0;       ///< bit i: X, Y, Z; Move::open_axes, because of rotary axes
  bool aligned_ = false;             ///< G53.1 has put the tool along Z of the tilted frame
  bool start_open_ = false;          ///< whether the start of the next move is open
  std::string open_cause_{};         ///< the code that opened them, for messages
};

}  // namespace camber::nc
