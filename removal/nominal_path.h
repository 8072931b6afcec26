#pragma once
// The programmed path stamp by stamp, for those who do not keep all of it.
#include <cstddef>
#include <memory>
#include <vector>

#include "removal/tool_path.h"

namespace camber::removal {

/// A stamp of nominal_path() and its number there; of `run` the count is not known yet.
using TakeNominal = StampSink;

/// Gives all stamps of nominal_path() in order, and returns its runs. Called twice it gives the same.
std::vector<ToolRun> follow_nominal_path(const nc::Interpretation& program, const std::vector<bool>& selected,
                                         const StampPath& path, const kinematics::PartPath* rotary,
                                         const TakeNominal& take);

/// The same for a path whose stamps come one by one.
class NominalFollower {
 public:
  NominalFollower(const nc::Interpretation& program, const std::vector<bool>& selected,
                  const kinematics::PartPath* rotary, TakeNominal take);
  ~NominalFollower();
  NominalFollower(const NominalFollower&) = delete;
  NominalFollower& operator=(const NominalFollower&) = delete;
  /// All stamps of the path in order, with their runs.
  void add(const ToolRun& run, const Stamp& stamp);
  /// Gives the rest, and returns the runs.
  std::vector<ToolRun> finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::removal
