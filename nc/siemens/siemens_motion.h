#pragma once
// Where programmed coordinates lie, the moves of the tool and the rotary axes, and the words that make them. Internal
// to siemens/.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "nc/frames.h"
#include "nc/offsets.h"
#include "nc/siemens/siemens_modes.h"

namespace camber::nc::siemens {

/// Work offsets, TRANS, ROT, SCALE, MIRROR, the plane of CYCLE800.
class ProgramFrames {
 public:
  ProgramFrames(BlockContext& at, Modes& modes);

  const Frame& frame() const { return frame_; }
  WorkOffsets& offsets() { return offsets_; }
  Affine total() const;
  const Affine& programmable() const { return programmable_; }
  void set_programmable(const Affine& frame);
  const std::optional<Affine>& swivelled() const { return swivelled_; }
  /// CYCLE800; programmable frames end.
  void set_swivelled(const std::optional<Affine>& frame);
  void set_work_offset(int g);
  void run_command();
  void set_programmable_shift();
  void set_variable(const std::string& name, const std::vector<double>& indexes,
                    const std::vector<std::string>& index_names, const Value& value, std::uint32_t offset);

 private:
  void update();

  BlockContext& at_;
  Modes& modes_;
  WorkOffsets offsets_;
  Affine programmable_;
  Vec3 fine_shift_mm_ = Vec3::Zero();  ///< part of it that G59 has set
  std::optional<Affine> swivelled_;
  Frame frame_;
};

enum class AxisPlace : std::uint8_t {
  never,      ///< not programmed so far; its coordinate counts as 0
  reference,  ///< at a machine coordinate
  known
};

/// The place of the tool and of the rotary axes, and moves from there.
class Mover {
 public:
  Mover(BlockContext& at, Modes& modes, ProgramFrames& frames)
      : at_(at), modes_(modes), frames_(frames), start_open_(at.has_rotary_axes()) {}

  const Vec3& position_mm() const { return position_mm_; }
  Vec3 programmed() const { return frames_.frame().to_program(position_mm_); }
  void stand_at(const Vec3& end_mm) { position_mm_ = end_mm; }
  AxisPlace place(int axis) const { return place_[static_cast<std::size_t>(axis)]; }
  void set_place(int axis, AxisPlace place) { place_[static_cast<std::size_t>(axis)] = place; }
  void set_places(AxisPlace place) { place_.fill(place); }
  std::optional<Vec3> last_direction() const;

  Move& add_move(MoveKind kind, const Vec3& end_mm);
  void prepare_cutting(const char* what, bool arc = false);
  void settle_axes();
  void settle_machine_axis(std::size_t axis, double machine_mm, Vec3& place_mm);
  void add_machine_target(const Vec3& end_mm, std::uint8_t given);
  /// The next move in the plane starts beside the position.
  void leave_from(const Vec3& beside_mm);
  bool leaving() const { return leaving_; }
  void leave_no_more() { leaving_ = false; }

  // rotary axes
  const RotaryOption* rotary_axis(char letter) const;
  /// Its angle, where the program has given it.
  std::optional<double> rotary_rad(char letter) const;
  bool turns() const { return rotary_target_.has_value(); }  ///< in this block
  void forget_turn() { rotary_target_.reset(); }
  void read_rotary_words();
  void check_rotary_letter(char letter);
  void set_tip_control(TipControl control, const char* code, std::uint32_t offset);
  void swivel(const CycleCall& call);
  std::uint8_t open_axes() const { return open_axes_; }
  void close_axes() { open_axes_ = 0; }
  void settle_axes_for(const char* what, bool line);

 private:
  bool place_unknown() const;
  void leave_contour(Move& move);
  void read_rotary_word(const RotaryOption& axis, RotaryTarget& target);
  void read_tool_direction();
  void open_all(std::string cause);
  void add_rotary_target(std::size_t move);
  std::uint8_t open_axes_of_move() const;
  bool turned() const { return angles_unknown_ != 0 || rotary_rad_ != Vec3::Zero(); }

  BlockContext& at_;
  Modes& modes_;
  ProgramFrames& frames_;
  Vec3 position_mm_ = Vec3::Zero();
  std::array<AxisPlace, 3> place_{};
  std::uint8_t open_axes_ = 0;
  bool start_open_ = false;
  std::string open_cause_;
  bool leaving_ = false;
  Vec3 beside_mm_ = Vec3::Zero();
  int first_cut_offset_ = 0;
  Vec3 rotary_rad_ = Vec3::Zero();
  std::optional<RotaryTarget> rotary_target_;
  std::uint8_t angles_unknown_ = 0;
  const char* direction_code_ = "";
  bool aligned_ = false;
};

/// The parts with which all those below make their moves.
struct MotionParts {
  BlockContext& at_;
  Modes& modes_;
  ToolWords& tools_;
  ProgramFrames& frames_;
  Mover& mover_;
};

/// G40, G41, G42 with OFFN.
class RadiusWords : MotionParts {
 public:
  explicit RadiusWords(const MotionParts& parts) : MotionParts(parts) {}

  void begin(const CodeWord& code);
  void end();
  void set_offset_normal(double mm) { offset_normal_mm_ = mm; }
  void finish();

 private:
  double offset_normal_mm_ = 0;
  bool not_editable_told_ = false;
};

/// Lines, arcs, dwells, machine coordinates.
class PathBlocks : MotionParts {
 public:
  explicit PathBlocks(const MotionParts& parts) : MotionParts(parts) {}

  void move();
  void dwell();
  void set_pole();
  void go_in_machine_frame();
  void go_to_fixed_point();

 private:
  void move_on_line();
  void move_on_arc();
  void move_through_point();
  void move_tangentially();
  void make_arc_move(const ArcWords& arc, const Vec3& end_mm, const char* g);
  bool arc_error(const ArcResult& result, const ArcWords& arc);
  Vec3 target();
  Vec3 target_in_program();
  Vec3 polar_target(Vec3 start);

  Vec3 pole_mm_ = Vec3::Zero();
};

/// RND, RNDM, CHF, CHR: the corner with the next move.
class Corners : MotionParts {
 public:
  explicit Corners(const MotionParts& parts) : MotionParts(parts) {}

  void set_modal_rounding(double mm) { modal_rounding_mm_ = mm; }
  void set_modal_feed(double feed) { modal_feed_ = feed; }  ///< FRCM
  void read(std::size_t moves_before);
  void make(std::size_t moves_before);
  void finish();

 private:
  struct Corner {
    bool waits = false, chamfer = false, modal = false;
    double size_mm = 0;
    std::size_t move = 0, offset = 0;
    std::string text;
    std::optional<double> feed_mm_per_s{};
  };
  void put(const Corner& corner, std::size_t before, std::size_t after);

  Corner corner_;
  double modal_rounding_mm_ = 0;
  std::optional<double> modal_feed_;
};

}  // namespace camber::nc::siemens
