#pragma once
// The stages of a prediction in sections: what is computed, and which parts are read for it.
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "distribute/part_files.h"
#include "distribute/sections.h"
#include "machine/job_file.h"

namespace camber::distribute {

/// Reports the stage that runs and, where it is known, the fraction of it that is done (0 to 1).
using PartProgress = std::function<void(const std::string& what, std::optional<double> share)>;

/// The stages of one prediction in sections. Programs are read once.
class SectionRun {
 public:
  static constexpr std::size_t kWholePath = std::numeric_limits<std::size_t>::max();
  /// longest_path: see SectionProgramsOptions. Throws InputError.
  SectionRun(const machine::Job& job, PartKey key, PartStore& store, PartProgress progress, Diagnostics& diagnostics,
             std::size_t longest_path = SectionProgramsOptions().longest_path);

  /// Computes a part unless it is there. False: it was.
  bool sweep(std::size_t section);
  bool solve(std::size_t section, int round);
  /// Text of a part made by this process that each other section needs, to send as a message.
  std::function<std::string(std::size_t section)> part_for_others(const PartName& name);
  /// Pieces that a round has solved again, in all sections; 0 in rigid coupling.
  std::size_t solved_again(int round);
  /// In one section.
  std::size_t solved_again_in(const PartName& name);
  bool is_static() const { return job_.simulation.coupling == machine::Coupling::static_; }
  /// The work that this process has done so far, from which the efficiency of many processes follows.
  const SectionWork& work() const { return work_; }
  /// The programs, for the merge by the same process (merge_parts); null where they are too long to be
  /// kept. Ends the run.
  std::shared_ptr<simulate::ReadPrograms> take_programs();

 private:
  PartName name(PartStage stage, int round, std::size_t section, bool own = false) const {
    return {stage, round, section, key_.sections, own};
  }
  bool is_there(const PartName& name);
  const removal::Region& region(std::size_t section);
  SectionParts parts_before(std::size_t section, int round);

  const machine::Job& job_;
  PartKey key_;
  PartStore& store_;
  PartProgress progress_;
  Diagnostics& diagnostics_;
  Diagnostics said_;  ///< messages about the job's program
  std::optional<SectionPrograms> programs_;
  std::optional<std::size_t> turn_from_;
  SectionWork work_;
  std::vector<removal::Region> regions_;  ///< regions of all sections, once one is asked for
  // In static coupling: of the section that was solved last, whose next round may follow.
  std::optional<simulate::Target> target_;
  std::size_t target_section_ = 0;
};

/// The part of a store.
template <class Part>
Part part_of(PartStore& store, const PartName& name) {
  return part_from<Part>(store.take(name));
}

}  // namespace camber::distribute
