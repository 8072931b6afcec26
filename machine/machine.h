#pragma once
// What a machine and its control are. Read from machine.toml; a limit that is missing is no limit (infinity).
#include <array>
#include <limits>
#include <string>

#include "base/diagnostics.h"

namespace camber::machine {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

enum class Dialect { fanuc, haas, mazak, linuxcnc };
enum class CornerLaw {
  speed_difference,  ///< per-axis permitted speed step (Fanuc 1783): F_c = F / max(dV_axis / V_permitted)
  angle,             ///< F <= a dt / sqrt(2 (1 - cos theta))
  blend,             ///< corners rounded within a tolerance
  exact_stop
};

struct Corner {
  CornerLaw law = CornerLaw::exact_stop;
  double tolerance_mm = 0;                 ///< blend
  double speed_difference_mm_per_s = kNoLimit;  ///< speed_difference
  double time_s = 0;                       ///< angle: dt
};

struct Control {
  Dialect dialect = Dialect::fanuc;
  double period_s = 0.001;      ///< of interpolation and of feed.csv
  double block_time_s = 0;      ///< block processing time T_b
  Corner corner;
  double merge_tolerance_mm = 0;  ///< short lines within it are merged; 0: none
};

struct Axis {
  double max_velocity_mm_per_s = kNoLimit;
  double acceleration_mm_per_s2 = kNoLimit;
  double jerk_mm_per_s3 = kNoLimit;
  double filter_s = 0;                      ///< moving average after interpolation; 0: none
  double position_gain_per_s = kNoLimit;    ///< Kp of the position loop; infinity: no lag
  double feed_forward_percent = 0;
  std::array<double, 2> travel_mm{-kNoLimit, kNoLimit};
};

struct Spindle {
  double max_rpm = kNoLimit;
};

struct Machine {
  std::string path;  ///< of the file it was read from
  Control control;
  std::array<Axis, 3> axis;  ///< x, y, z
  Spindle spindle;
};

/// Throws InputError with file:line:column for unknown keys, wrong types and values out of range.
Machine read_machine(const std::string& path, Diagnostics& diagnostics);

/// machine.toml text that read_machine reads back to the same values.
std::string to_toml(const Machine& machine);

}  // namespace camber::machine
