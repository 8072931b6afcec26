#pragma once
// Path blocks: lines, arcs and poles; corners, approach and departure of a contour. Internal to heidenhain/.
#include <optional>
#include <string>

#include "nc/heidenhain/klartext_motion.h"

namespace camber::nc::heidenhain {

/// L, C, CR, CT, CP, LP and their kind; machine coordinates.
class PathBlocks {
 public:
  PathBlocks(StatementContext& at, Modes& modes, Tools& tools, DatumFrames& frames, Mover& mover,
             Orientation& orientation)
      : at_(at), modes_(modes), tools_(tools), frames_(frames), mover_(mover), orientation_(orientation) {}

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

  StatementContext& at_;
  Modes& modes_;
  Tools& tools_;
  DatumFrames& frames_;
  Mover& mover_;
  Orientation& orientation_;
  Vec3 pole_mm_ = Vec3::Zero();  ///< programmed
  bool pole_given_ = false, pole_from_here_ = false;
  Plane pole_plane_ = Plane::xy;
  int last_sense_ = 0;
};

/// RND and CHF between two blocks, APPR before one and DEP behind one.
class Contour {
 public:
  Contour(StatementContext& at, Modes& modes, Tools& tools, DatumFrames& frames, Mover& mover,
          RadiusCompensation& compensation, PathBlocks& path)
      : at_(at),
        modes_(modes),
        tools_(tools),
        frames_(frames),
        mover_(mover),
        compensation_(compensation),
        path_(path) {}

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

  StatementContext& at_;
  Modes& modes_;
  Tools& tools_;
  DatumFrames& frames_;
  Mover& mover_;
  RadiusCompensation& compensation_;
  PathBlocks& path_;
  Corner corner_;
  Approach approach_;
};

}  // namespace camber::nc::heidenhain
