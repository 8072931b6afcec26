#pragma once
// Where programmed coordinates lie, the moves of the tool and the rotary axes, and the path blocks that make them.
// Internal to heidenhain/.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "nc/frames.h"
#include "nc/heidenhain/klartext_words.h"

namespace camber::nc::heidenhain {

/// The transform that cycles 7, 8, 10, 11 and 26 make together: a point is scaled, turned, mirrored and shifted, in
/// this order.
struct Transform {
  Vec3 shift_mm = Vec3::Zero();
  std::array<bool, 3> mirror{};
  double rotation_rad = 0;
  double scale = 1;
  Vec3 axis_scale = Vec3::Ones(), axis_scale_centre_mm = Vec3::Zero();
};

/// A tilted plane, and the transform in it.
struct WorkPlane {
  std::optional<Eigen::Matrix3d> tilt{};
  Transform transform{};
};

/// Datum shift, mirror image, rotation, scale, and the plane that is tilted.
class DatumFrames {
 public:
  DatumFrames(StatementContext& at, Modes& modes, Tools& tools);

  const Frame& frame() const { return frame_; }
  WorkOffsets& offsets() { return offsets_; }
  const std::optional<Eigen::Matrix3d>& tilt() const { return plane_.tilt; }
  bool tilted() const { return tilt() && !tilt()->isIdentity(1e-12); }
  /// Returns the plane before.
  WorkPlane change_plane(const WorkPlane& plane);

  void shift_datum(Cursor at, std::size_t offset);
  void set_mirror(Cursor at);
  void set_rotation(Cursor at);
  void set_scale(Cursor at);
  void set_axis_scale(Cursor at);
  void run_transform(const Statement& s);
  void use_preset(int preset, std::size_t offset);

  void note_cut_plane();
  void place_stock();

 private:
  void update_frame();
  Transform& transform() { return tilt() ? plane_.transform : base_; }

  StatementContext& at_;
  Modes& modes_;
  Tools& tools_;
  WorkOffsets offsets_;
  Transform base_;
  WorkPlane plane_;
  Frame frame_;
  int preset_ = -1;
  bool preset_told_ = false;
  /// The planes in which the program cuts, without kinematics, with the transform below them: at most two are kept.
  std::vector<WorkPlane> cut_planes_;
};

/// The place of the tool, and moves from there.
class Mover {
 public:
  enum class Place : std::uint8_t { never, known, machine };
  /// Axes whose programmed coordinates do not follow from the program (Move::open_axes, Move::start_open).
  struct Open {
    std::uint8_t axes = 0;
    bool start = false;
  };

  Mover(StatementContext& at, Modes& modes, Tools& tools, DatumFrames& frames);

  const Vec3& position_mm() const { return position_mm_; }
  Vec3 programmed() const { return frames_.frame().to_program(position_mm_); }
  /// The end of the block in programmed coordinates.
  Vec3 target(const BlockValues& b) const;
  Vec3 end_in_moves(const Vec3& programmed_end, std::uint8_t given) const;
  Vec3 last_direction() const;
  bool at_machine_place(int axis) const { return place_[static_cast<std::size_t>(axis)] == Place::machine; }
  Open open() const { return open_; }
  void set_open(Open open) { open_ = open; }

  /// `absolute`: bits of the axes that absolute words put there.
  Move& add_move(MoveKind kind, const Vec3& end_mm, std::uint8_t absolute = 0);
  void line_to(const Vec3& programmed_end, std::uint8_t given, const BlockValues& b);
  void arc_to(const Vec3& programmed_end, const Arc& arc, const BlockValues& b, bool by_radius);
  void make_arc_of(ArcWords words, const BlockValues& b);
  void prepare_cutting(const char* what, std::uint8_t given);
  void settle(std::uint8_t given);
  /// Without a move: programmed.
  void stand_at(const Vec3& programmed_mm) { position_mm_ = end_in_moves(programmed_mm, 7); }
  void set_place(int axis, Place place) { place_[static_cast<std::size_t>(axis)] = place; }
  /// The tilted plane has changed, and no axes turn: X, Y and Z keep their numbers until they are programmed.
  void carry_over() { carried_over_ = 7; }
  /// The next move starts beside the position.
  void leave_from(const Vec3& beside_mm);

 private:
  StatementContext& at_;
  Modes& modes_;
  Tools& tools_;
  DatumFrames& frames_;
  Vec3 position_mm_ = Vec3::Zero();
  std::array<Place, 3> place_{};
  Open open_;
  std::uint8_t carried_over_ = 0;
  bool leaving_ = false;
  Vec3 beside_mm_ = Vec3::Zero();
};

/// The parts with which all those below make their moves.
struct MotionParts {
  StatementContext& at_;
  Modes& modes_;
  Tools& tools_;
  DatumFrames& frames_;
  Mover& mover_;
};

/// RL, RR, R0.
class RadiusCompensation : MotionParts {
 public:
  explicit RadiusCompensation(const MotionParts& parts) : MotionParts(parts) {}

  bool active() const { return radius_.active; }
  bool moves_path() const { return radius_.active && radius_.radius_mm != 0; }
  bool left() const { return radius_.left; }
  /// letter::kCompensation of the last RL or RR.
  int last() const { return last_; }
  void set_last(int code) { last_ = code; }
  void set(int code, std::size_t offset);
  void end();

 private:
  struct Radius {
    bool active = false;
    bool left = true;
    double radius_mm = 0;
    std::size_t first_move = 0, offset = 0;
    Plane plane = Plane::xy;
  };

  Radius radius_;
  bool not_editable_told_ = false;
  int last_ = 1;
};

/// Rotary axes, tool directions, tilted planes, tool-centre-point control.
class Orientation : MotionParts {
 public:
  Orientation(const MotionParts& parts, RadiusCompensation& compensation)
      : MotionParts(parts), compensation_(compensation) {}

  bool turned() const { return direction_unknown_ || rotary_rad_ != Vec3::Zero(); }
  /// The direction of the tool where the program has given it as a vector.
  std::optional<Vec3> direction() const;
  void set_shortest_way(bool on) { shortest_way_ = on; }  ///< M126, M127
  void add_rotary(const BlockValues& b, std::size_t move);
  void turn_only(const BlockValues& b);
  void direction_target(const Vec3& direction, std::size_t move);
  void set_working_plane(Cursor at, int part);
  void run_plane(const Statement& s);
  void set_tip_control(bool on);

 private:
  enum class Turn : std::uint8_t { stay, turn, move };  ///< of PLANE; move: the tip keeps its place on the part
  void tilt(const Eigen::Matrix3d& rotation, Turn turn, std::size_t offset);
  void reset_tilt(Turn turn);
  void open_all_if_turned();

  RadiusCompensation& compensation_;
  Vec3 rotary_rad_ = Vec3::Zero();
  bool direction_unknown_ = false;  ///< rotary axes stand where a direction has put them
  bool shortest_way_ = false;
};

// --- path blocks

/// L, C, CR, CT, CP, LP and their kind; machine coordinates.
class PathBlocks : MotionParts {
 public:
  PathBlocks(const MotionParts& parts, Orientation& orientation) : MotionParts(parts), orientation_(orientation) {}

  void set_centre(const BlockValues& b);
  Vec3 polar_target(const BlockValues& b);
  void run_line(const BlockValues& b);
  void run_circle(const BlockValues& b);
  void run_radius_arc(const BlockValues& b);
  void run_tangent_arc(const BlockValues& b, const Vec3& end);
  void run_polar_circle(const BlockValues& b);
  void retract(const BlockValues::Function& f, const BlockValues& b);

 private:
  void go_in_machine_frame(const BlockValues& b);
  void run_untilted(const BlockValues& b);
  void run_programmed_line(const BlockValues& b);
  int sense_of(const BlockValues& b);

  Orientation& orientation_;
  Vec3 pole_mm_ = Vec3::Zero();  ///< programmed
  bool pole_given_ = false, pole_from_here_ = false;
  Plane pole_plane_ = Plane::xy;
  int last_sense_ = 0;
};

/// RND and CHF between two blocks, APPR before one and DEP behind one.
class Contour : MotionParts {
 public:
  Contour(const MotionParts& parts, RadiusCompensation& compensation, PathBlocks& path)
      : MotionParts(parts), compensation_(compensation), path_(path) {}

  void set_corner(const Statement& s, const BlockValues& b);
  /// `feed_before`: of the block before it.
  void start_approach(const Statement& s, const BlockValues& b, std::optional<double> feed_before);
  /// `first`: of the moves that the block has made.
  void after_move(std::size_t first);
  void depart(const Statement& s, const BlockValues& b);
  void finish();

 private:
  struct Corner {  ///< until the next block of the contour
    bool waits = false, chamfer = false;
    double size_mm = 0;
    std::optional<double> feed_mm_per_s{};
    std::size_t move = 0, offset = 0;
    std::string text{};
  };
  enum class Form : std::uint8_t { tangent_line, normal_line, arc, line_and_arc };
  struct Approach {  ///< until the next block of the contour
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
  std::optional<Form> read_form(const Statement& s, bool& polar);
  bool positioned_at_rapid() const;
  void finish_approach(std::size_t contour);
  Vec3 tangent_point(const Vec3& centre, double radius, double sense, const Vec3& outside, bool arrives) const;
  std::string text_of(const Statement& s) const;

  RadiusCompensation& compensation_;
  PathBlocks& path_;
  Corner corner_;
  Approach approach_;
};

}  // namespace camber::nc::heidenhain
