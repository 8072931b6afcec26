#pragma once
// The block at hand, and the state that its words set: feeds, spindle, path control, tools. Internal to siemens/; the
// parts are listed in block_runner.h.
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nc/arcs.h"
#include "nc/interpreter.h"
#include "nc/reporter.h"
#include "nc/siemens/siemens_block_words.h"
#include "nc/siemens/values.h"
#include "nc/tool_names.h"

namespace camber::nc::siemens {

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

/// Non-modal requests of the block.
struct BlockRequest {
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

/// G41, G42 that are active.
struct ActiveRadius {
  bool active = false;
  int g = 0;
  double radius_mm = 0;
  std::size_t first_move = 0, offset = 0;
  bool moves_path() const { return active && radius_mm != 0; }
};

/// The block at hand, what all parts ask of the modal state, and where moves and messages go.
struct BlockContext {
  const Program& main;
  const InterpreterOptions& options;
  Reporter& report;
  Interpretation& out;
  const Program* program = &main;  ///< file of the block
  BlockPlace place{};
  BlockWords words{};
  BlockRequest request{};
  bool editable = true;
  Motion motion = Motion::linear;
  Plane plane = Plane::xy;
  bool absolute = true;  ///< G90
  ActiveRadius radius{};
  ReliedEnds relied_ends{};

  bool has_rotary_axes() const { return !options.rotary_axes.empty(); }
  PlaneAxes axes() const { return axes_of(plane); }
  bool is_absolute(const Slot& slot) const {
    return slot.dimension == Dimension::absolute || (slot.dimension == Dimension::as_modal && absolute);
  }
  bool is_incremental(const Slot& slot) const {
    return slot.dimension == Dimension::incremental || (slot.dimension == Dimension::as_modal && !absolute);
  }
  /// Position of the word that says the motion, or of the block.
  std::size_t motion_offset() const { return request.motion_given ? request.motion_offset : words.offset(); }
  void error(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});
  /// Error where cutter radius compensation moves the path; returns whether it does.
  bool refuse_under_radius(std::size_t offset, std::string_view what);
  void refuse_ellipse();
  void add_event(EventKind kind, double value);
};

/// Unit, feed, spindle, and what else moves share as their state.
class Modes {
 public:
  explicit Modes(BlockContext& at);

  const ModalState& state() const { return state_; }
  /// The state to be changed; the next move has another one.
  ModalState& change() {
    state_changed_ = true;
    return state_;
  }
  std::uint32_t state_index();
  double unit_mm() const { return state_.inch ? 25.4 : 1.0; }
  void set_unit(bool inch);
  void check_unit();
  void set_plane(Plane plane);
  double axis_value(const Slot& slot, double start, double unit) const;
  void note_dimensions();

  const std::optional<double>& feed() const { return feed_; }  ///< mm/s (G94), 1/s (G93), mm a turn (G95)
  void set_feed(std::optional<double> feed) { feed_ = feed; }
  void set_feed_mode(FeedMode mode);
  void read_feed();
  double internal_feed(double value) const;
  void give_feed_to(Move& move);
  std::optional<double> cutting_feed(double length_mm, const char* g);

  void begin_cutting_speed(const CodeWord& code);
  void end_cutting_speed() { cutting_speed_ = false; }
  void read_spindle_speed();
  void start_spindle(const CodeWord& code);
  void stop_spindle(const CodeWord& code);
  void set_coolant(bool on, int code);
  int main_spindle() const { return main_spindle_; }
  void set_main_spindle(int number) { main_spindle_ = number, main_spindle_named_ = true; }
  /// S3=2000 of a spindle that is not the main one: it counts where that one is the first to turn.
  void note_speed(int spindle, const Slot& speed) { other_speeds_[spindle] = speed; }

 private:
  BlockContext& at_;
  ModalState state_;
  bool state_changed_ = true;
  std::uint32_t state_index_ = 0;
  bool unit_given_ = false;
  std::optional<double> feed_;
  bool feed_given_ = false, feed_by_variable_ = false;
  bool cutting_speed_ = false;  ///< G96: S is no spindle speed
  int main_spindle_ = 1;
  bool main_spindle_named_ = false;  ///< by SETMS
  std::map<int, Slot> other_speeds_;
};

/// Modes for fine paths: compressors, rounding, CYCLE832, CTOL.
class ContourModes {
 public:
  explicit ContourModes(Modes& modes) : modes_(modes) {}

  void set_mode_word(std::string_view upper_name);
  void set_compressor(const WordRow& row);
  void set_blending(int g);
  void set_rounding_distance(double mm);
  void set_tolerance(double tolerance);
  void run_cycle832(const CycleCall& call);

 private:
  void update();

  Modes& modes_;
  bool cycle832_ = false, compressor_ = false;
  double cycle832_tolerance_mm_ = -1, contour_tolerance_mm_ = -1;  ///< negative: not given
  int blending_ = 60;                                              ///< 60, 64, 641 ...
  /// Path control before CYCLE832, which rounds corners (G645); none where a word of its own has followed.
  std::optional<std::pair<PathControl, std::uint8_t>> before_cycle832_;
  double adis_mm_ = 0;
};

/// T, M6, D.
class ToolWords {
 public:
  ToolWords(BlockContext& at, Modes& modes);

  int edge() const { return edge_; }
  int next() const { return next_; }
  void set_name(const std::string& name, std::uint32_t offset);
  void read_tool();
  void change_tool(std::uint32_t offset);
  void read_edge();
  /// Null where nothing gives the offsets of the tool.
  const ToolOffset* offset(int tool) const;
  void set_offset(int tool, bool radius, double mm);
  void finish();

 private:
  void update_length();

  BlockContext& at_;
  Modes& modes_;
  ToolNumbers numbers_;
  std::map<int, ToolOffset> offsets_;
  int next_ = -1;
  bool changed_ = false;
  std::size_t word_offset_ = 0;
  int edge_ = 1;  ///< D
};

}  // namespace camber::nc::siemens
