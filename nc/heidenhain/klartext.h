#pragma once
// Runs the statements of a Klartext program and makes moves of them. Behind the door heidenhain_language.h.
//   klartext.cpp     the walk: labels, calls, jumps, parameters
//   words.cpp        the words of a block; feeds, M functions, tools
//   path.cpp         L, C, CR, CT, CP, LP and their kind; machine coordinates
//   contour.cpp      RND, CHF, APPR, DEP, radius compensation
//   transforms.cpp   datum shift, mirror image, rotation, scale; tilted planes
//   cycles.cpp       definitions and calls of cycles, patterns
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "nc/canned_cycles.h"
#include "nc/corner_cut.h"
#include "nc/cutter_radius.h"
#include "nc/frames.h"
#include "nc/heidenhain/klartext_tree.h"
#include "nc/heidenhain/parameters.h"
#include "nc/interpreter.h"
#include "nc/reporter.h"
#include "nc/tool_names.h"

namespace camber::nc::heidenhain {

/// The words of a path block, with numbers for parameters. Lengths in the unit of the program.
struct BlockValues {
  std::array<std::optional<double>, 3> axis{}, rotary{};  ///< X Y Z, A B C
  std::uint8_t step = 0, rotary_step = 0;                 ///< bit i: it is a step (IX)
  std::uint8_t to_plane = 0;                              ///< bit i: the rotary word is Q120, Q121, Q122
  std::optional<double> feed, radius, polar_radius, polar_angle, length, arc_angle;
  bool polar_radius_step = false, polar_angle_step = false;
  bool rapid = false, auto_feed = false, feed_by_variable = false;
  std::optional<double> feed_per_turn, feed_per_tooth;
  std::optional<int> compensation;  ///< letter::kCompensation
  std::optional<int> sense;         ///< 1, -1
  std::array<std::optional<double>, 3> normal{}, tool{};
  struct Function {
    int code = 0;
    std::optional<double> argument{};
    std::size_t offset = 0;
  };
  std::vector<Function> functions{};
  bool by_parameter = false;  ///< a coordinate is a parameter: the text has no number to edit

  bool has(int code) const {
    for (const Function& f : functions)
      if (f.code == code) return true;
    return false;
  }
  bool moves() const { return axis[0] || axis[1] || axis[2]; }
  bool turns() const { return rotary[0] || rotary[1] || rotary[2]; }
};

/// The transform that cycles 7, 8, 10, 11 and 26 make together: a point is scaled, turned, mirrored and shifted, in
/// this order.
struct Transform {
  Vec3 shift_mm = Vec3::Zero();
  std::array<bool, 3> mirror{};
  double rotation_rad = 0;
  double scale = 1;
  Vec3 axis_scale = Vec3::Ones(), axis_scale_centre_mm = Vec3::Zero();
};

class Klartext {
 public:
  Klartext(const Program& main, const InterpreterOptions& options, Diagnostics& diagnostics, Reporter& report,
           Interpretation& out);
  ~Klartext();
  void run();

 private:
  /// A program or a subprogram that runs.
  struct Level {
    const Program* file = nullptr;
    std::size_t next = 0;
    bool is_program = true;         ///< else from LBL to LBL 0
    std::uint32_t called_from = 0;  ///< Move::block of moves in other files
  };
  struct Tool {
    std::optional<double> length_mm{}, radius_mm{};
  };
  struct Pending {  ///< RND, CHF until the next block of the contour
    bool waits = false, chamfer = false;
    double size_mm = 0;
    std::optional<double> feed_mm_per_s{};
    std::size_t move = 0, offset = 0;
    std::string text{};
  };
  enum class Form : std::uint8_t { tangent_line, normal_line, arc, line_and_arc };
  struct Approach {  ///< APPR until the next block of the contour
    bool waits = false;
    Form form = Form::tangent_line;
    double length_mm = 0, radius_mm = 0, angle_rad = 0;
    Vec3 from_mm = Vec3::Zero(), start_mm = Vec3::Zero();  ///< programmed: where the tool stands, PA
    double side = 1;                                       ///< 1: on the left of the contour
    bool has_side = true;                                  ///< RL or RR says it
    double feed_mm_per_s = 0;
    bool rapid = false;
    double feed_there_mm_per_s = 0;  ///< to the auxiliary point PH
    bool rapid_there = false;
    std::size_t move = 0, offset = 0;
    std::uint32_t block = 0;
  };
  struct Cycle {
    int number = -1;                 ///< none
    std::map<int, double> values{};  ///< values of old cycles, by the number behind the point
    std::map<int, double> feeds{};
    double radius = 0, sense = -1;
    std::size_t offset = 0;
    bool is_old() const { return number >= 0 && number < 100; }
    bool passed = false;  ///< refused, or the maker's own: its definition said so, and its calls do nothing
  };

  // klartext.cpp
  bool step();
  void execute(const Statement& s);
  void run_functions(const Statement& s);
  void jump(const std::string& label, std::size_t offset);
  void call_label(const Statement& s);
  void call_program(const Statement& s, bool selected);
  void open_program(const std::string& path, std::size_t offset);
  void end_program();
  void assign(const Statement& s);
  bool set_or_say(const ParameterName& name, const Statement& s, const std::function<double()>& value);
  void run_function(const Statement& s);
  std::optional<double> asked_of_control(Cursor at);
  std::optional<bool> definition_asked(Cursor& at) const;
  void jump_behind_goto(Cursor& at, const Statement& s, bool holds);
  std::string label_name(Cursor& at);
  double known(double value, std::size_t offset);
  const Program& file() const { return *level().file; }
  const Tree& tree() const { return tree_of(file()); }
  Level& level() { return levels_.back(); }
  const Level& level() const { return levels_.back(); }
  Cursor cursor(const Statement& s) const { return {file().source.text(), s.at, s.end}; }
  std::optional<double> system_value(int number) const;
  void finish();
  void refuse(const Statement& s);
  void run_dwell(const Statement& s);
  void note_rest(const Statement& s);
  void read_blank_form(const Statement& s);

  // words.cpp
  BlockValues read_values(const Statement& s);
  double value_of(const Word& word);
  void set_feed(const BlockValues& b);
  void set_feed_mode(const BlockValues& b);
  void functions_before(const BlockValues& b);
  void functions_after(const BlockValues& b);
  void run_m(const BlockValues::Function& f);
  void call_tool(const Statement& s);
  void define_tool(const Statement& s);
  void set_spindle_speed(double rpm, std::size_t offset);
  std::optional<double> tool_radius_mm() const;
  /// For cycles: that of the tool, else of its cutter.
  std::optional<double> cutter_radius_mm() const;
  void update_tool_length();
  double turns_per_s(const char* word);
  double teeth();
  double cutting_feed(const std::string& what);
  void add_event(EventKind kind, double value);
  double plunging_feed(double feed, const Vec3& way_mm) const;

  // path.cpp
  void run_path(const Statement& s);
  void run_line(const BlockValues& b);
  void go_in_machine_frame(const BlockValues& b);
  void run_untilted(const BlockValues& b);
  void retract(const BlockValues::Function& f, const BlockValues& b);
  void run_circle(const BlockValues& b);
  void run_radius_arc(const BlockValues& b);
  void run_tangent_arc(const BlockValues& b, const Vec3& end);
  void run_polar_circle(const BlockValues& b);
  void set_centre(const BlockValues& b);
  Vec3 target(const BlockValues& b) const;
  Vec3 polar_target(const BlockValues& b);
  Vec3 end_in_moves(const Vec3& programmed_end, std::uint8_t given) const;
  void line_to(const Vec3& programmed_end, std::uint8_t given, const BlockValues& b);
  void arc_to(const Vec3& programmed_end, const Arc& arc, const BlockValues& b, bool by_radius);
  bool make_arc_of(ArcWords words, const BlockValues& b);
  int sense_of(const BlockValues& b);
  /// `absolute`: bits of the axes that absolute words put there.
  Move& add_move(MoveKind kind, const Vec3& end_mm, std::uint8_t absolute = 0);
  void prepare_cutting(const char* what, std::uint8_t given);
  void settle(std::uint8_t given);
  std::uint32_t state_index();
  Vec3 programmed() const { return frame_.to_program(position_mm_); }
  Vec3 last_direction() const;
  void add_rotary(const BlockValues& b, std::size_t move);
  void turn_only(const BlockValues& b);
  void direction_target(const Vec3& direction, std::size_t move);

  // contour.cpp
  void set_corner(const Statement& s, const BlockValues& b);
  void after_contour_move(std::size_t first);
  void start_approach(const Statement& s, const BlockValues& b, std::optional<double> feed_before);
  bool positioned_at_rapid() const;
  void finish_approach(std::size_t contour);
  void depart(const Statement& s, const BlockValues& b);
  std::optional<Form> read_form(const Statement& s, bool& polar);
  void set_compensation(int code, std::size_t offset);
  void end_compensation();
  Vec3 tangent_point(const Vec3& centre, double radius, double sense, const Vec3& outside, bool arrives) const;

  // transforms.cpp
  void update_frame();
  void shift_datum(Cursor at, std::size_t offset);
  void set_mirror(Cursor at);
  void set_rotation(Cursor at);
  void set_scale(Cursor at);
  void set_axis_scale(Cursor at);
  void set_working_plane(Cursor at, int part);
  void run_transform(const Statement& s);
  void run_plane(const Statement& s);
  enum class Turn : std::uint8_t { stay, turn, move };  ///< of PLANE; move: the tip keeps its place on the part
  void tilt(const Eigen::Matrix3d& rotation, Turn turn, std::size_t offset);
  void reset_tilt(Turn turn);
  void run_tcpm(const Statement& s);
  void set_tip_control(bool on);
  static bool begins_number(Cursor& at);
  Transform& transform() { return tilt_ ? in_plane_ : base_; }

  // cycles.cpp
  void define_cycle(const Statement& s);
  void define_old_cycle(int number, int part, Cursor at, const Statement& s);
  void set_tolerance(int part, Cursor at);
  void call_cycle(std::size_t offset);
  void run_cycle_call(const Statement& s);
  void drill(int number);
  double old_value(int part) const;
  void drill_old();
  void mill_bore();
  void mill_thread();
  void mill_old_pocket();
  void mill_pocket_cycle();
  PocketMoves pocket_moves();
  double pocket_cutter_mm() const;
  [[noreturn]] void refuse(const char* check, const std::string& message) const;
  [[noreturn]] void too_many_cuts() const;
  void run_pattern(int number);
  void define_pattern(const Statement& s);
  struct Hole {
    double surface_mm = 0, clearance_mm = 0, second_mm = 0;
    double depth_mm = 0;  ///< depth from the surface, negative
    double peck_mm = 0, less_mm = 0, least_mm = 0;
    double above_mm = 0.2;  ///< rapids in the hole stop so far above the last depth
    int breaks = 0;         ///< chip breaks before the tool leaves the hole
    double break_mm = 0.2;
    double start_mm = 0;  ///< negative: the hole is open down to there
    double pre_feed_mm_per_s = 0, feed_mm_per_s = 0;
    std::optional<double> feed_out_mm_per_s{};
    double dwell_s = 0, dwell_top_s = 0;
    Vec3 off_mm = Vec3::Zero();  ///< motion off the wall before the tool leaves
  };
  void drill_hole(const Hole& hole);
  void bore_back();
  void cycle_circle(const Vec3& centre, double sweep_rad, double end_height_mm, double feed_mm_per_s);
  void cycle_move(MoveKind kind, const Vec3& programmed_end, double feed_mm_per_s, double dwell_s = 0);
  double q(int number);
  std::optional<double> q_if_set(int number);
  double feed_q(int number);

  void error(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});
  void warn(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});
  double unit_mm() const { return inch_ ? 25.4 : 1.0; }
  std::string text_of(const Statement& s) const;

  const Program& main_;
  const InterpreterOptions& options_;
  Diagnostics& diagnostics_;
  Reporter& report_;
  Interpretation& out_;

  std::vector<Level> levels_;
  std::map<std::pair<const Tree*, std::size_t>, int> repeats_left_;
  std::vector<std::uint8_t> runs_;  ///< number of runs of each block of the main program, up to 255
  std::size_t repeated_ = 0;
  std::map<std::string, std::unique_ptr<Program>> files_;
  std::string selected_program_;
  Parameters parameters_;
  bool ended_ = false;
  bool inch_ = false;

  const Statement* statement_ = nullptr;
  std::uint32_t block_ = 0;
  bool editable_ = true;

  ModalState state_;
  bool state_changed_ = true;
  std::uint32_t state_index_ = 0;
  std::optional<double> feed_;  ///< mm/s, mm a turn
  std::optional<double> tool_feed_;
  bool feed_given_ = false, feed_by_variable_ = false;
  std::optional<double> plunge_factor_;  ///< M103
  int tool_axis_ = 2;
  bool tool_called_ = false;
  std::map<int, Tool> tools_;
  ToolNumbers tool_numbers_;
  double tool_delta_radius_mm_ = 0;

  WorkOffsets offsets_;
  Transform base_, in_plane_;
  bool tilted() const { return tilt_ && !tilt_->isIdentity(1e-12); }
  std::optional<Eigen::Matrix3d> tilt_;
  Frame frame_;
  int preset_ = -1;
  bool preset_told_ = false;

  Vec3 position_mm_ = Vec3::Zero();
  enum class Place : std::uint8_t { never, known, machine };
  std::array<Place, 3> place_{};
  Vec3 rotary_rad_ = Vec3::Zero();
  bool direction_unknown_ = false;  ///< rotary axes stand where a direction has put them
  std::uint8_t open_axes_ = 0;
  bool start_open_ = false;
  bool shortest_way_ = false;  ///< M126

  Vec3 pole_mm_ = Vec3::Zero();  ///< programmed
  bool pole_given_ = false, pole_from_here_ = false;
  Plane pole_plane_ = Plane::xy;
  int last_sense_ = 0;

  Pending corner_;
  Approach approach_;
  struct Compensation {
    bool active = false;
    bool left = true;
    double radius_mm = 0;
    std::size_t first_move = 0, offset = 0;
    Plane plane = Plane::xy;
  } radius_;
  bool leaving_ = false;
  Vec3 beside_mm_ = Vec3::Zero();
  bool not_editable_told_ = false;
  int last_compensation_ = 1;

  Cycle cycle_;
  bool cycle_modal_ = false;  ///< M89
  std::size_t cycle_moves_ = 0;
  int cycle_g_ = 0;
  std::vector<Vec3> pattern_;  ///< PATTERN DEF: places, programmed
  /// Bit i: without kinematics, X, Y, Z still have the number that they had before the tilted plane changed.
  std::uint8_t carried_over_ = 0;
  /// The planes in which the program cuts, without kinematics: at most two of them are kept.
  struct CutPlane {
    std::optional<Eigen::Matrix3d> tilt{};
    Transform base{};
  };
  std::vector<CutPlane> cut_planes_;
  void note_cut_plane();
  void place_stock();
  ReliedEnds relied_ends_;
  std::optional<Vec3> blank_min_mm_;
};

Plane plane_of_axis(int axis);
/// A point of the unit circle: at multiples of 90 degrees exactly.
Vec2 direction_at_deg(double degrees);

}  // namespace camber::nc::heidenhain
