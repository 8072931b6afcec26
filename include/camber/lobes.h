#pragma once
// Stability lobes of a tool: critical depths over the spindle speed.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "camber/job.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct LobesOptions {
  std::optional<int> tool{};  ///< not given: the job's only one
  double radial_mm = 0;       ///< radial depth of cut
  std::vector<double> speeds_rpm{};
  bool up = false;                      ///< up-milling; else down
  bool zero_order = false;              ///< mean directions, fast, without flip lobes; else semi-discretisation
  double chip_mm = 0.05;                ///< chip thickness at which a force law that is not linear counts
  double process_damping_N_per_mm = 0;  ///< C of the force C b v / cutting speed; 0: none
};

struct LobePoint {
  double speed_rpm = 0;
  double depth_mm = 0;    ///< critical depth; infinite: no limit was found
  double chatter_hz = 0;  ///< frequency at the border
  std::string border{};   ///< "hopf", "flip" or "none"
};

struct LobesResult {
  int tool = 0;
  std::vector<LobePoint> lobes{};         ///< one per speed
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string csv{};                      ///< the table, as `camber lobes` writes it
  std::string plot{};                     ///< a picture, SVG
  std::string json{};                     ///< modes and lobes, as `camber lobes --json` writes them
  std::string printed{};                  ///< as `camber lobes` prints them
};

/// The job's program is not needed. Throws InputError, Cancelled.
CAMBER_API LobesResult lobes(const Job& job, const LobesOptions& options, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
