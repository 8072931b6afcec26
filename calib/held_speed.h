#pragma once
// Speeds that the axes of a trace hold within a move.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/fit_feed.h"

namespace camber::calib {

using JointSpeeds = std::array<double, kJoints>;  ///< x, y, z, a, b, c: mm/s or degrees/s

/// What a line asks of the axes; infinite in rapids. `counts`: a rapid or a line without tool-centre-point control,
/// where axes keep a speed by themselves.
struct AskedSpeeds {
  JointSpeeds per_s{};
  double feed_per_s = 0;  ///< along the path; 0: a rapid
  bool rotary_alone = false;
  bool counts = false;
  bool axes_apart = false;  ///< dog-leg rapid
};

/// A speed that all axes hold for 60 ms or longer in one move; single samples, and the sum of two blocks that overlap,
/// are none.
struct HeldSpeed {
  JointSpeeds speed{};
  double path_per_s = 0;  ///< in what F counts
  double duration_s = 0;
  std::uint32_t line = 0;
  std::size_t first = 0;  ///< sample
  AskedSpeeds asked;
};

/// Empty for a trace without lines.
std::vector<HeldSpeed> held_speeds(const FeedRun& run, const machine::Machine& machine);

/// What positions of traces are rounded to, mm or degrees.
inline constexpr double kTraceRounding = 1e-4;

}  // namespace camber::calib
