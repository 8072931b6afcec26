#pragma once
// How a dynamometer log is to be read: the [force_log] table of a job.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/material.h"
#include "machine/tool.h"

namespace camber::machine {

/// A quantity of a log: a column of it, or one number for all.
struct LogQuantity {
  std::string column;              ///< its name in the header; empty: by number, or constant
  int index = 0;                   ///< 1-based number of the column; 0: by name, or constant
  std::optional<double> constant;  ///< in the key's unit
  double scale = 1;                ///< key's unit per unit of the column; negative turns the axis round
};

/// One steady cut of a log of samples.
struct LoggedCut {
  double from_s = 0, to_s = 0, feed_mm_per_min = 0, axial_depth_mm = 0, radial_depth_mm = 0;
};

enum class LogContents { means, samples };

struct ForceLog {
  std::string path;  ///< path of the job
  LogContents contents = LogContents::samples;
  bool waveform = false;  ///< fit the waveform, not only its means; samples only
  bool up_milling = true;
  bool on_work = false;  ///< the columns are forces on the work (a dynamometer under it)
  ForceLaw law = ForceLaw::linear;
  Tool tool;
  std::optional<Material> material;                 ///< [material], for the coefficients to keep
  std::vector<std::string> hold;                    ///< names of coefficients that keep the material's value
  std::array<std::optional<LogQuantity>, 3> force;  ///< feed, left of it, up; N. Nothing: not measured
  LogQuantity time;                                 ///< s
  LogQuantity spindle_rpm, axial_depth_mm, radial_depth_mm;
  LogQuantity feed;  ///< mm/min, or mm per tooth
  bool feed_is_per_tooth = false;
  int header_line = 1;                        ///< 1-based line of the names of the columns
  std::vector<std::array<double, 2>> idle_s;  ///< the tool turns in air: what shows is drift
  std::vector<LoggedCut> cuts;                ///< cuts of a log of samples
};

/// Reads [tool.N], [material] (may be missing) and [force_log] of a job; program, machine and stock are not needed.
/// Throws InputError with file:line:column.
ForceLog read_force_log(const std::string& job_path, Diagnostics& diagnostics);

}  // namespace camber::machine
