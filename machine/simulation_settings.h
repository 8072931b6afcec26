#pragma once
// What of a program is simulated, and how.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/geometry.h"

namespace camber::machine {

/// Selection of moves to simulate, compensate or judge: moves that match every given criterion; none given: all.
struct Operations {
  std::vector<int> tools;
  std::vector<std::array<int, 2>> blocks;  ///< 1-based line ranges, inclusive
  std::string comments;                    ///< regular expression (ECMAScript, case-insensitive); empty: not given
  bool given() const { return !tools.empty() || !blocks.empty() || !comments.empty(); }
};

enum class Coupling { rigid, static_ };
/// Severity of a rapid through material, or of a shank or holder in stock.
enum class Collisions { error, warning, off };

struct Simulation {
  double voxel_mm = 0.1;
  Coupling coupling = Coupling::static_;
  std::optional<Collisions> collisions;  ///< not given: error; a warning where moves of the program are left out
  double rotation_step_rad = kPi / 180.0;
  double envelope_step_mm = 0;  ///< sample spacing along the profile; 0: chosen for the tool (simulate/predict_path.h)
  std::optional<double> max_memory_GB;  ///< not given: what the machine has (simulate/memory.h)
};

}  // namespace camber::machine
