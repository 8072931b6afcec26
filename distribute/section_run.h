#pragma once
// The stages of a prediction in sections: what is computed, and which parts are read for it.
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "distribute/path_sections.h"
#include "machine/job_file.h"

namespace camber::distribute {

// Parts of a prediction in sections, as files or messages.

enum class PartStage : std::uint8_t { sweep, solve };

/// Part of a distributed prediction: what one section has computed in one stage.
struct PartName {
  PartStage stage = PartStage::sweep;
  int round = 1;            ///< number of the solving round, from 1
  std::size_t section = 0;  ///< from 0
  std::size_t sections = 1;
  bool own = false;  ///< what only later stages of the same section read
};
/// "sweep-003-of-016.part", "solve-1-003-of-016.part", "own-sweep-003-of-016.part"; sections count from 1.
std::string file_name(const PartName& name);

/// Identifies one prediction. Parts whose key differs are refused, and the message names what differs.
struct PartKey {
  std::string job_path;  ///< absolute
  std::string hash;      ///< checksum over job, program and every file that the job reads
  std::size_t sections = 1;
  std::size_t forces_at = 0;
};

/// Where parts are kept for others.
class PartStore {
 public:
  virtual ~PartStore() = default;
  virtual bool has(const PartName& name) = 0;
  /// `write` gives the content piece by piece.
  using Write = std::function<void(const std::function<void(std::string_view)>& put)>;
  virtual void give(const PartName& name, const Write& write) = 0;
  /// Throws InputError where it is missing [part-missing], torn [part-torn] or of another prediction [part-version],
  /// [part-job].
  virtual std::string take(const PartName& name) = 0;
  /// The pieces of a part of this process, one after the other; each was given with its size before it, in 8 bytes.
  /// Throws as take(), at once.
  virtual std::function<std::string()> take_pieces(const PartName& name) = 0;
  /// Throws as take().
  virtual void check(const PartName& name) { take(name); }
};

/// Parts as files in FOLDER/parts, each written beside and renamed.
class PartFiles : public PartStore {
 public:
  PartFiles(std::string folder, PartKey key) : folder_(std::move(folder)), key_(std::move(key)) {}
  /// A whole part of this prediction.
  bool has(const PartName& name) override;
  void give(const PartName& name, const Write& write) override;
  std::string take(const PartName& name) override;
  std::function<std::string()> take_pieces(const PartName& name) override;
  void check(const PartName& name) override;
  std::string path(const PartName& name) const;

 private:
  /// The command that writes a part.
  std::string again(const PartName& name) const;
  void expect_there(const PartName& name) const;
  [[noreturn]] void refuse_torn(const PartName& name) const;
  void expect_own(const PartName& name, const std::string& version, const std::string& of_name,
                  const PartKey& key) const;

  std::string folder_;
  PartKey key_;
};

/// The key of the parts in a folder, with their hash. Throws InputError where there is no part [part-missing], or
/// where parts have different numbers of sections [part-sections].
PartKey find_parts(const std::string& folder);
/// The last round of solving that has a part which is of this prediction, or torn; 0: none.
int last_round(const std::string& folder, const PartKey& key);

PartKey part_key(const machine::Job& job, std::size_t sections, std::size_t forces_at);

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
