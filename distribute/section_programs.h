#pragma once
// The programs of a job in a process that works on one section: of a long program it has no text, and of the path what
// lies near the section.
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/sparse_list.h"
#include "distribute/section_pieces.h"
#include "distribute/section_stock.h"
#include "motion/path_stretch.h"
#include "simulate/pieces.h"

namespace camber::distribute {

struct SectionProgramsOptions {
  /// A path of more stamps is not kept as a whole, if it is upright: it is timed again for the section that is asked
  /// for.
  std::size_t longest_path = 2'000'000;
  /// Whether the machine can run the program; may throw InputError.
  std::function<void(const simulate::SimulatedProgram&)> check{};
};

/// The stamps of a section's pieces on the programmed path.
struct NominalSection {
  removal::StampPath path{};  ///< all runs; stamps from `first` on; empty where `thin` has them
  std::size_t first = 0;
  const motion::SparsePath* thin = nullptr;
  SectionPlace place;

  motion::PathStretch stretch() const { return thin ? thin->stretch() : motion::PathStretch(path, first); }
};

class SectionPrograms {
 public:
  /// Reads and times the programs. Throws InputError.
  SectionPrograms(const machine::Job& job, const SectionProgramsOptions& options,
                  const simulate::SetupFindings& findings);

  /// False: paths and texts are as a whole in memory, as `program` has them.
  bool thin() const { return thin_.has_value(); }
  const simulate::SimulatedProgram& program() const { return read_.program; }
  /// Its path is that of `program`, or of another one.
  const simulate::SimulatedProgram& of_target() const { return read_.of_target(); }
  /// All that is read from here on is of this section, or lies near it. Where paths are thin, the programs are timed
  /// once more, unless it was the last one.
  void go_to(std::size_t section, std::size_t sections);

  /// As the machine runs them.
  motion::PathStretch path() const;
  motion::PathStretch target_path() const;
  /// Of path(), where it is thin; else null.
  const motion::PathOutline* outline() const { return thin_ ? &thin_->path.outline : nullptr; }
  /// Where the pieces of any section lie on these two, or a little more.
  removal::Region reach(std::size_t section, std::size_t sections) const;
  NominalSection nominal(std::size_t section, std::size_t sections) const;
  /// Names what make_target() cannot take from of_target().
  void add_to(simulate::TargetWork& work) const;

  /// For the merge by the same process; nothing where texts were given up. Ends the object.
  std::optional<simulate::Programs> take();

 private:
  /// Of thin programs.
  struct Thin {
    motion::SparsePath path;
    std::optional<motion::SparsePath> original;  ///< of a target that is another program
    motion::SparsePath nominal;                  ///< of the target
    std::optional<std::size_t> section{};
    std::size_t sections = 0;
    const motion::SparsePath& target() const { return original ? *original : path; }
  };
  void time_all(std::size_t longest_path);

  const machine::Job& job_;
  simulate::Programs read_;
  std::optional<Thin> thin_;
};

}  // namespace camber::distribute
