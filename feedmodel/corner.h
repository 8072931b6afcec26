#pragma once
// Corner laws: the speed at which a control passes from one segment to the next, the rounding between them, and short
// lines that are driven as one.
#include <cstddef>
#include <optional>
#include <span>

#include "base/geometry.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Corner speed at which no axis' speed jumps by more than `permitted` [mm/s]:
/// F_c = min_i permitted_i / |u2_i - u1_i|, the form F / max(dV_axis / V_permitted) of Fanuc's parameter 1783.
/// Returns infinity where the directions agree.
double speed_difference_limit(const Vec3& from, const Vec3& to, const Vec3& permitted_mm_per_s);

/// F <= a dt / sqrt(2 (1 - cos theta)).      [mm/s] = [mm/s^2][s]
/// Source: Takata 1999, eq. 2.11 as corrected (docs/errata.md). theta = angle between the directions.
double angle_limit(const Vec3& from, const Vec3& to, double acceleration_mm_per_s2, double time_s);

/// A corner rounded by a circular arc that touches both sides.
struct Blend {
  double trim_mm = 0;  ///< cut off each side
  double radius_mm = 0;
  double turn_rad = 0;
  double speed_mm_per_s = 0;
  double acceleration_mm_per_s2 = 0;  ///< axes' acceleration in the plane of the arc, before any fraction is applied
};

struct BlendOptions {
  double tolerance_mm = 0;         ///< largest distance between the arc and the corner; infinite: only the room counts
  double room_mm = 0;              ///< most that may be cut off each side
  double goal_speed_mm_per_s = 0;  ///< programmed; no faster than this
  double normal_fraction = 1;      ///< fraction of the plane's acceleration that turns the motion
  Vec3 velocity_mm_per_s, acceleration_mm_per_s2;  ///< limits of the axes
};

/// With the half angle h between the sides (turn = pi - 2h), an arc of radius R touches at R / tan h from the
/// corner and passes it at R (1/sin h - 1). R is the largest that the tolerance and the room allow, and no larger than
/// the goal v asks for: R <= v^2 / (a cos h), so that each side loses at most v^2 / (a sin h). The speed is
/// sqrt(share a R), the goal at most. Nothing for directions that agree or are opposite.
/// Source: LinuxCNC's G64 P corners as its traces show them (docs/feed-model.md).
std::optional<Blend> blend_corner(const Vec3& from, const Vec3& to, const BlendOptions& options);

/// A run of merged lines never holds more than this (LinuxCNC's figure).
inline constexpr std::size_t kMaxMergedLines = 100;

/// Tolerance within which lines are merged in this modal state: G64's Q, else its P where the control
/// merges by it (ControlKind::g64_p_merges), else the control's own. 0: no merging.
double merge_tolerance_mm(const nc::ModalState& state, const machine::Control& control);

/// Returns the index after the last move of the run of lines that begins at `first` and is driven as one line: every
/// corner that is passed over lies within `tolerance_mm` of the straight line from the run's start to its end. Only
/// straight feed moves of one state and one feed are merged. Returns first + 1 where nothing merges. Source: LinuxCNC
/// user manual, G64 P- Q- ("naive cam detector").
std::size_t merged_run_end(std::span<const nc::Move> moves, std::size_t first, double tolerance_mm);

}  // namespace camber::feedmodel
