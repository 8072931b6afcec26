#pragma once
// Chooses the direction of the tool at every point of a path, at least cost and clear of everything.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "machine/machine.h"
#include "posture/directions.h"
#include "posture/lag_error.h"
#include "posture/path_points.h"
#include "posture/surroundings.h"

namespace camber::posture {

enum class Mode : std::uint8_t {
  chosen,     ///< least cost along the path: form error, rotary motion, time
  normal,     ///< along the normal of the part
  lead_tilt,  ///< at constant angles to the normal: forward and sideways
  seed        ///< along the normal, and away from what interferes (Shirase, AF-2004012, section 4.3)
};

struct PostureOptions {
  Mode mode = Mode::chosen;
  bool indexed = false;                            ///< one direction for all points; mode is not looked at
  bool stock = true;                               ///< the stock is an obstacle, except for the flutes
  double clearance_mm = 1;                         ///< distance that everything but the cutter keeps
  double lead_rad = 10 * kPi / 180, tilt_rad = 0;  ///< lead_tilt
  double max_tilt_rad = 75 * kPi / 180;            ///< largest angle from +Z of the program
  double least_angle_rad = 10 * kPi / 180;         ///< smallest angle of tool and normal: below it the tip cuts
  double grid_rad = 7.5 * kPi / 180;               ///< distance of the directions that `chosen` tries
  double degree_cost_mm = 0.02;                    ///< a degree of rotary motion is worth so many mm of path with the
                                                   ///< error of a tool at a right angle to the normal
};

inline constexpr double kTimeShare = 0.1;  ///< a second longer, as so much of the feed's way

double angle_between(const Vec3& a, const Vec3& b);

/// Part of the lateral deflection that is normal to the part, of a tool at this angle to the normal: a force along the
/// normal bends it by sin^2, one along the part by sin cos of the angle; kAlong is the share of the latter.
inline constexpr double kAlong = 0.3;
double error_share(double angle_rad);

/// Returns the share of the error that the axes leave on the surface (lag_error.h), squared: a turn leaves as much
/// however it is spread along the path, and the square spreads it.
double lag_share(double error_mm, const ToolShape& tool);

/// Returns the cost of a direction per mm of path: share of the error, and a tip that cuts.
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

/// Points at which the tool is nearer than it needs to be, or on whose way from the point before it is, or swings
/// (rotary_path.h). Between points the tip goes straight and the axes turn evenly.
std::vector<std::size_t> unclear_points(std::span<const PathPoint> points, std::span<const Vec3> axes,
                                        std::span<const Vec3> rotary_rad, const Surroundings& surroundings,
                                        const ToolShape& tool, const machine::Machine& machine);

}  // namespace camber::posture
