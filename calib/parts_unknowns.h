#pragma once
// What measured parts can tell about a model: the unknowns of fit-parts.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "calib/parts_fit.h"

namespace camber::calib {

enum class UnknownKind { offset, gain, gain_ratio, force, radial, root, edge, root_rotation, drift };

/// An unknown x, 0 at the start, in which sizes are nearly linear. Offsets and drift add to sizes (mm, mm a day). The
/// others multiply a quantity of the job by 1 + x: forces, compliance of the root, lag (inverse square of the gain);
/// gain_ratio the lag of X by 1 + x and that of Y by 1 - x.
struct PartsUnknown {
  UnknownKind kind = UnknownKind::force;
  std::string name;  ///< of offsets, stiffness: with the tool
  int tool = 0;
  std::size_t clamping = 0;                              ///< offset: which
  std::vector<bool> of_job;                              ///< whether it changes that job's sizes
  std::function<void(machine::Job&, double x)> apply{};  ///< not of drift
  bool adds() const { return kind == UnknownKind::offset || kind == UnknownKind::drift; }
  double lowest() const { return adds() ? -INFINITY : -kMost; }
  double highest() const { return kind == UnknownKind::gain_ratio ? kMost : INFINITY; }
  static constexpr double kMost = 0.98;  ///< a gain seven times the start's lags no more than can be measured
};

/// A measured value of a feature of a job.
struct PartsRow {
  std::size_t job = 0, feature = 0;
  std::string part;
  int tool = 0;
  std::size_t clamping = 0;
  double measured_mm = 0;
  double size_per_diameter = 0;
  std::optional<double> day{};  ///< since the first date
  bool held_out = false;
};

/// All measured values, held out or not.
std::vector<PartsRow> rows_of(const std::vector<machine::Job>& jobs, const std::vector<std::string>& hold_out);

/// In the order in which they are tried; see fit_parts().
std::vector<PartsUnknown> unknowns_of(const std::vector<machine::Job>& jobs, const std::vector<PartsRow>& rows);

/// Days of an ISO date, "2026-11-03" or "2026-11-03T14:30"; nothing for anything else.
std::optional<double> days_of(const std::string& date);

/// The experiment that would tell an unknown, alone or from another one.
std::string suggestion_for(const PartsUnknown& unknown, const PartsUnknown* confounded_with);

/// The tool of a feature: its own, or the job's only one.
int tool_of(const machine::Job& job, const machine::Feature& feature);

}  // namespace camber::calib
