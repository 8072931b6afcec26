#pragma once
// Chooses the direction of the tool at every point of a path, at least cost and clear of everything.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinematics/chain.h"
#include "machine/machine_model.h"
#include "posture/path_points.h"
#include "posture/surroundings.h"

namespace camber::posture {

// Directions of the tool that a machine reaches within travel, and the rotary motion and time from one to the next.

class Directions {
 public:
  struct Step {
    std::uint16_t to = 0;
    float turn_deg = 0;  ///< sum of the turns of the rotary axes
    float time_s = 0;    ///< time of the slowest axis, at its speed or from rest to rest with its acceleration
    std::uint8_t from_branch = 0, to_branch = 0;  ///< solutions, as in angles()
  };

  /// Directions about `step_rad` apart, up to `max_tilt_rad` from +Z, that the rotary axes of the machine reach within
  /// their travel; neighbours up to one and a half steps away. Requires machine.kinematics.given().
  Directions(const machine::Machine& machine, double step_rad, double max_tilt_rad);

  std::size_t size() const { return axes_.size(); }
  const Vec3& axis(std::size_t i) const { return axes_[i]; }
  /// Returns one or two solutions for A, B and C, rad.
  std::span<const Vec3> angles(std::size_t i) const { return {angles_[i].rad.data(), angles_[i].count}; }
  /// Every solution of the inverse kinematics is within travel.
  bool whole(std::size_t i) const { return angles_[i].whole; }
  /// Returns the steps from direction i, the one to itself included.
  std::span<const Step> steps(std::size_t i) const { return {steps_.data() + first_[i], first_[i + 1] - first_[i]}; }

 private:
  struct Angles {
    std::array<Vec3, 2> rad;
    std::size_t count = 0;
    bool whole = false;
  };
  Step step_between(std::size_t a, std::size_t b) const;

  const machine::Machine& machine_;
  std::vector<Vec3> axes_;
  std::vector<Angles> angles_;
  std::vector<Step> steps_;
  std::vector<std::size_t> first_;
};

// Lag error: the error that the following errors of the axes leave on the surface. Each axis is behind its command by
// its own time.
//
// An axis i at the speed q'_i is behind by  tau_i q'_i,  tau = filter / 2 + T1 + T2 + (1 - Kf) / Kp  (feedmodel/drive.h
// at constant speed). The centre of the cutter's rounding, c(q) in the part's frame, is off by  J (tau o q'),  J =
// dc/dq, and the surface by the component along the normal:
//     e = n . J (tau o q')
// which is 0 where all axes are behind by the same time, as the centre goes along the surface.

class LagError {
 public:
  /// For a tool of this length (gauge line to tip), whose cutter is rounded about a point `pivot_mm` above the tip;
  /// `origin_mm`: machine zero in the frame of the points.
  LagError(const machine::Machine& machine, const Vec3& origin_mm, double tool_length_mm, double pivot_mm);

  /// False: the axes follow their commands, all with the same delay.
  bool any() const { return any_; }

  /// The machine with the tool at a point.
  struct Place {
    kinematics::Joints joints;
    Vec3 linear = Vec3::Zero(), rotary = Vec3::Zero();  ///< (J^T n)_i tau_i; s, mm s / rad
  };
  Place place(const PathPoint& point, const Vec3& axis, const Vec3& rotary_rad) const;

  /// mm, on the way between two places in this time; angles by the shorter way. Greater than zero: into the part.
  static double error_mm(const Place& from, const Place& to, double time_s);

  /// Errors along the path, at a constant direction and with the axes where `rotary_rad` has them: a value for each
  /// point, 0 off the part.
  std::vector<double> along(std::span<const PathPoint> points, const Vec3& axis, const Vec3& rotary_rad) const;

 private:
  Vec3 centre_mm(const kinematics::Joints& joints) const;

  kinematics::Chain chain_;
  Vec3 origin_mm_;
  double tool_length_mm_, pivot_mm_;
  Vec3 linear_tau_s_, rotary_tau_s_;
  bool any_ = false;
};

enum class Mode : std::uint8_t {
  chosen,     ///< least cost along the path: form error, rotary motion, time
  normal,     ///< along the normal of the part
  lead_tilt,  ///< at constant angles to the normal: forward and sideways
  seed        ///< along the normal, and away from what interferes (Shirase, AF-2004012, section 4.3)
};

struct PostureOptions {
  Mode mode = Mode::chosen;
  bool indexed = false;                            ///< one direction for all points; mode is ignored
  bool stock = true;                               ///< the stock is an obstacle, except for the flutes
  double clearance_mm = 1;                         ///< distance that everything but the cutter keeps
  double lead_rad = 10 * kPi / 180, tilt_rad = 0;  ///< lead_tilt
  double max_tilt_rad = 75 * kPi / 180;            ///< largest angle from +Z of the program
  double least_angle_rad = 10 * kPi / 180;         ///< smallest angle of tool and normal: below it the tip cuts
  double grid_rad = 7.5 * kPi / 180;               ///< angle between neighbouring directions that `chosen` tries
  double degree_cost_mm = 0.02;                    ///< cost of a degree of rotary motion, as mm of path with the error
                                                   ///< of a tool at a right angle to the normal
};

inline constexpr double kTimeShare = 0.1;  ///< cost of an additional second, as a fraction of the feed's way in it

double angle_between(const Vec3& a, const Vec3& b);

/// Fraction of the lateral deflection that is normal to the part, for a tool at this angle to the normal: a force along
/// the normal bends the tool by sin^2, one along the part by sin cos of the angle; kAlong is the weight of the latter.
inline constexpr double kAlong = 0.3;
double error_share(double angle_rad);

/// Returns the share of the error that the axes leave on the surface (LagError), squared: a turn leaves as much
/// however it is spread along the path, and the square spreads it.
double lag_share(double error_mm, const ToolShape& tool);

/// Returns the cost, mm, of a direction on the way to a point: the way times the fraction of the error that reaches the
/// surface, with a penalty for a tip that cuts.
double posture_cost(const PathPoint& point, const Vec3& axis, const PostureOptions& options);

struct Postures {
  std::vector<Vec3> axes;                ///< one a point; empty: none (`blocked`)
  std::optional<std::size_t> blocked{};  ///< the first point at which no direction is clear, or none is reached
};

/// Returns one choice per tool; `tools`: one tool, or the same one at decreasing overhangs. Where a tool has an
/// error_mm, the error that its axes leave on the surface (`lag`) is divided by it and counts as a share of the error.
std::vector<Postures> choose_postures(std::span<const PathPoint> points, const Surroundings& surroundings,
                                      std::span<const ToolShape> tools, const machine::Machine& machine,
                                      const LagError& lag, const PostureOptions& options);

/// Returns the points at which the tool is nearer to an obstacle than allowed, or on the way to which it is or swings
/// (rotary_path.h). Between points the tip goes straight and the axes turn evenly.
std::vector<std::size_t> unclear_points(std::span<const PathPoint> points, std::span<const Vec3> axes,
                                        std::span<const Vec3> rotary_rad, const Surroundings& surroundings,
                                        const ToolShape& tool, const machine::Machine& machine);

// Finds which directions are clear at which points, for a tool at several lengths at once.

class ClearDirections {
 public:
  static constexpr std::size_t kMaxTools = 32;

  /// `tools`: the same one drawn in further and further, at most kMaxTools. Directions more than `farthest_rad` from
  /// the normal of a contact are not looked at, and are not clear.
  ClearDirections(std::span<const PathPoint> points, const Surroundings& surroundings, std::span<const ToolShape> tools,
                  const Directions& directions, double farthest_rad);

  bool clear(std::size_t point, std::size_t direction, std::size_t tool) const {
    return (clear_[point * directions_ + direction] >> tool & 1U) != 0;
  }

 private:
  std::size_t directions_;
  std::vector<std::uint32_t> clear_;  ///< point by point: a bit for each tool
};

// Chooses one direction of the tool for a whole operation (3+2 axes).

/// Returns, of the directions that the machine reaches, the one of least cost that is clear at every point and half way
/// between two. `blocked` where there is none: the point at which the direction that gets farthest is not clear.
Postures one_direction(std::span<const PathPoint> points, const Surroundings& surroundings, const ToolShape& tool,
                       const machine::Machine& machine, const LagError& lag, const PostureOptions& options);

}  // namespace camber::posture
