#pragma once
// A statement that runs and the words of its block; the modes and tools that words set. Internal to heidenhain/; the
// parts are listed in klartext.cpp.
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nc/arcs.h"
#include "nc/heidenhain/klartext_tree.h"
#include "nc/heidenhain/parameters.h"
#include "nc/interpreter.h"
#include "nc/reporter.h"
#include "nc/tool_names.h"

namespace camber::nc::heidenhain {

/// The words of a path block, with numbers for parameters. Lengths in the unit of the program.
struct BlockValues {
  struct Feed {
    std::optional<double> value, per_turn, per_tooth;  ///< F, FU, FZ
    bool rapid = false, of_tool = false;               ///< FMAX, FAUTO
    bool by_variable = false;
  };
  struct Polar {
    std::optional<double> radius, angle;  ///< PR, PA
    bool radius_step = false, angle_step = false;
  };
  struct Function {
    int code = 0;
    std::optional<double> argument{};
    std::size_t offset = 0;
  };
  std::array<std::optional<double>, 3> axis{}, rotary{};  ///< X Y Z, A B C
  std::uint8_t step = 0, rotary_step = 0;                 ///< bit i: it is a step (IX)
  std::uint8_t to_plane = 0;                              ///< bit i: the rotary word is Q120, Q121, Q122
  Feed feed{};
  Polar polar{};
  std::optional<double> radius, length, arc_angle;
  std::optional<int> compensation;  ///< letter::kCompensation
  std::optional<int> sense;         ///< 1, -1
  std::array<std::optional<double>, 3> normal{}, tool{};
  std::vector<Function> functions{};
  bool by_parameter = false;  ///< a coordinate is a parameter: the text has no number to edit

  bool has(int code) const {
    for (const Function& f : functions)
      if (f.code == code) return true;
    return false;
  }
  bool moves() const { return axis[0] || axis[1] || axis[2]; }
  bool turns() const { return rotary[0] || rotary[1] || rotary[2]; }
  /// Bit i: X, Y, Z stands in the block.
  std::uint8_t given_axes() const {
    return static_cast<std::uint8_t>((axis[0] ? 1 : 0) | (axis[1] ? 2 : 0) | (axis[2] ? 4 : 0));
  }
  std::uint8_t absolute_axes() const { return static_cast<std::uint8_t>(given_axes() & ~step); }
};

/// The statement at hand: its text, parameters, and where moves and messages go.
struct StatementContext {
  const Program& main;
  const InterpreterOptions& options;
  Reporter& report;
  Interpretation& out;
  const Program* running = &main;  ///< the file that has the statement
  const Statement* statement = nullptr;
  std::uint32_t block = 0;  ///< Move::block
  bool editable = true;     ///< Move::editable
  bool inch = tree_of(main).inch;
  Parameters parameters{};
  ReliedEnds relied_ends{};

  const Program& file() const { return *running; }
  const Tree& tree() const { return tree_of(file()); }
  Cursor cursor(const Statement& s) const { return {file().source.text(), s.at, s.end}; }
  double unit_mm() const { return inch ? 25.4 : 1.0; }
  bool has_rotary_axes() const { return !options.rotary_axes.empty(); }
  /// The value, unless only the machine knows it.
  double known(double value, std::size_t offset) const;
  double known_value(Cursor& at) { return known_value(at, at.offset()); }
  double known_value(Cursor& at, std::size_t offset) { return known(read_value(at, parameters), offset); }
  void error(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});
  void warn(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});
  void add_event(EventKind kind, double value);
};

/// Feeds, spindle, and what else moves share as their state.
class Modes {
 public:
  explicit Modes(StatementContext& at) : at_(at) { state_.inch = at.inch; }

  const ModalState& state() const { return state_; }
  /// The state to be changed; the next move has another one.
  ModalState& change() {
    state_changed_ = true;
    return state_;
  }
  std::uint32_t state_index();
  void set_unit(bool inch) { at_.inch = change().inch = inch; }

  /// An S alone is set at once.
  BlockValues read_values(const Statement& s);
  void set_feed_mode(const BlockValues& b);
  void set_feed(const BlockValues& b);
  /// mm/s, mm a turn.
  const std::optional<double>& feed() const { return feed_; }
  const std::optional<double>& tool_feed() const { return tool_feed_; }
  void keep_tool_feed() { tool_feed_ = feed_; }
  void give_feed_to(Move& move);
  double cutting_feed(const std::string& what);
  double turns_per_s(const char* word);
  double teeth();
  void set_plunge_factor(std::optional<double> factor) { plunge_factor_ = factor; }  ///< M103
  bool limits_plunging() const { return plunge_factor_.has_value(); }
  double plunging_feed(double feed, const Vec3& way_mm, int tool_axis) const;
  void set_spindle_speed(double rpm, std::size_t offset);
  void set_spindle(SpindleDirection direction, EventKind kind, int code);
  void set_coolant(bool on, int code);
  void set_tolerance(int part, Cursor at);

 private:
  double value_of(const Word& word);

  StatementContext& at_;
  ModalState state_;
  bool state_changed_ = true;
  std::uint32_t state_index_ = 0;
  std::optional<double> feed_, tool_feed_;
  bool feed_given_ = false, feed_by_variable_ = false;
  std::optional<double> plunge_factor_;
};

Plane plane_of_axis(int axis);

/// Tools of the program and of the table, the one in the spindle, its axis and lengths.
class Tools {
 public:
  Tools(StatementContext& at, Modes& modes);
  Tools(const Tools&) = delete;

  int axis() const { return axis_; }
  Plane plane() const { return plane_of_axis(axis_); }
  PlaneAxes axes() const { return axes_of(plane()); }
  /// The number of a tool by number, name or parameter; nothing where none stands there.
  std::optional<int> read_number(Cursor& at);
  void call(int number);
  void set_axis(int axis);
  void set_delta_radius(double mm) { delta_radius_mm_ = mm; }
  void define(const Statement& s);
  void update_length();
  /// With DR of the call.
  std::optional<double> radius_mm() const;
  /// For cycles: that of the tool, else of its cutter.
  std::optional<double> cutter_radius_mm() const;
  std::optional<double> asked_of_control(Cursor at) const;
  const std::map<int, std::string>& names() const { return numbers_.names(); }

 private:
  struct Tool {
    std::optional<double> length_mm{}, radius_mm{};
  };
  const Tool& tool(int number) const;
  std::optional<double> system_value(int number) const;

  StatementContext& at_;
  Modes& modes_;
  std::map<int, Tool> tools_;
  ToolNumbers numbers_;
  int axis_ = 2;
  bool called_ = false;
  double delta_radius_mm_ = 0;
};

/// Whether a number or a parameter stands there.
bool begins_number(Cursor& at);
/// A point of the unit circle: at multiples of 90 degrees exactly.
Vec2 direction_at_deg(double degrees);

}  // namespace camber::nc::heidenhain
