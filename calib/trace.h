#pragma once
// Servo traces: commanded and actual axis positions, sample by sample.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"

namespace camber::calib {

/// The quantities of a servo trace.
enum class Quantity {
  time,
  x_cmd,
  y_cmd,
  z_cmd,
  x_act,
  y_act,
  z_act,
  feed,
  line,
  a_cmd,
  b_cmd,
  c_cmd,
  a_act,
  b_act,
  c_act
};
inline constexpr std::size_t kQuantities = 15;

/// A trace without holes: samples `first` .. `end` - 1 follow each other at the period.
struct Stretch {
  std::size_t first = 0, end = 0;
};

/// Columns that the file does not have are zero throughout.
struct ServoTrace {
  std::string path;
  double period_s = 0;      ///< median distance of the samples
  std::vector<double> t_s;  ///< ascending
  std::vector<Vec3> command_mm, actual_mm;
  std::vector<double> feed_mm_per_s;  ///< empty without the column
  std::vector<std::uint32_t> line;  ///< 1-based line of the program being commanded, 0: none; empty without the column
  std::vector<std::size_t> row;     ///< 1-based line of the file of each sample; empty where samples are put together
  std::array<bool, 3> has_command{}, has_actual{};
  std::vector<Vec3> rotary_command_deg, rotary_actual_deg;  ///< a, b, c; empty without any such column
  std::array<bool, 3> has_rotary_command{}, has_rotary_actual{};
  std::vector<Stretch> stretches;  ///< in order; one when there is no gap

  std::size_t size() const { return t_s.size(); }
};

inline constexpr std::size_t kJoints = 6;  ///< x, y, z, a, b, c

/// Position of a joint in a sample, mm or degrees: as commanded where the trace has it.
double joint_position(const ServoTrace& trace, std::size_t sample, std::size_t joint);
/// The largest way of a joint between two samples.
double joint_step(const ServoTrace& trace, std::size_t from, std::size_t to);

/// Sets period (median distance of the samples) and stretches from the times; returns the samples after a gap.
std::vector<std::size_t> set_stretches(ServoTrace& trace);

/// The rotary axes of a trace in place of x, y and z, in degrees instead of mm: drives and accelerations of both kinds
/// are fitted alike.
ServoTrace rotary_trace(const ServoTrace& trace);

/// Reads a CSV whose header names columns: `t_s` and any of x_cmd_mm y_cmd_mm z_cmd_mm x_act_mm y_act_mm
/// z_act_mm feed_mm_per_min line, of rotary axes a_cmd_deg a_act_deg (b, c alike), in any order; CRLF and blanks around
/// fields are allowed.
///
/// Errors (InputError): [file-missing], [trace-empty], [trace-column] (no t_s, no position, a column twice),
/// [trace-fields] (number of fields), [trace-number] (not a finite number), [trace-time] (time does not rise).
/// Warnings: [trace-column] for a column that is not known, [trace-gap] for a hole in the time (more than
/// 1.5 periods), with its line and size; the trace is split there.
ServoTrace read_trace(const std::string& path, Diagnostics& diagnostics);

}  // namespace camber::calib
