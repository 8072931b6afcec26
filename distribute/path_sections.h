#pragma once
// A prediction in sections of the path, for several processes: what each computes alone, and how the parts are joined.
//
// The path is cut in pieces (section_pieces.h). Every piece is computed by itself, from the stock that the pieces
// before it leave, so that the result does not depend on who computes it.
//
// 1. Sweep: each piece is carved alone out of the raw stock: the path as the machine runs it, the nominal path of the
//    target, and what lies above the allowance. The stock before a piece is the pointwise maximum of the parts before;
//    of the other sections it is joined section by section.
// 2. Solve: forces, deflections and marks of each piece from that stock. In rigid coupling this is all. In static
//    coupling the deflected cutter leaves another stock, so that rounds follow: each piece whose stock has changed by
//    more than kSettled_mm where it cuts, or which the tool enters bent in another way, is solved again from the parts
//    of the round before.
// 3. Merge: loads, marks and stock of all pieces become one prediction.
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/sparse_list.h"
#include "distribute/section_parts.h"
#include "distribute/section_pieces.h"
#include "distribute/section_stock.h"
#include "motion/path_stretch.h"
#include "simulate/pieces.h"

namespace camber::distribute {

// The programs of a job in a process that works on one section: of a long program it has no text, and of the path what
// lies near the section.

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

  /// The programs as the machine runs them.
  motion::PathStretch path() const;
  motion::PathStretch target_path() const;
  /// Outline of path(), where it is thin; else null.
  const motion::PathOutline* outline() const { return thin_ ? &thin_->path.outline : nullptr; }
  /// Where the pieces of any section lie on these two, or a little more.
  removal::Region reach(std::size_t section, std::size_t sections) const;
  NominalSection nominal(std::size_t section, std::size_t sections) const;
  /// Names what make_target() cannot take from of_target().
  void add_to(simulate::TargetWork& work) const;

  /// For the merge by the same process; nothing where texts were given up. Ends the object.
  std::optional<simulate::Programs> take();

 private:
  /// Paths of thin programs.
  struct Thin {
    motion::SparsePath path;
    std::optional<motion::SparsePath> original;  ///< path of a target that is another program
    motion::SparsePath nominal;                  ///< nominal path of the target
    std::optional<std::size_t> section{};
    std::size_t sections = 0;
    const motion::SparsePath& target() const { return original ? *original : path; }
  };
  void time_all(std::size_t longest_path);

  const machine::Job& job_;
  simulate::Programs read_;
  std::optional<Thin> thin_;
};

struct Swept {
  SweptSection section;
  OwnSweep own;
};
/// The sweep that the section keeps for itself (OwnSweep) is given piece by piece to `own`, and not kept. `programs`
/// are at the section, here and below.
SweptSection sweep_section(const machine::Job& job, const SectionPrograms& programs, std::size_t section,
                           std::size_t sections, const std::function<void(const removal::StockPart&)>& own,
                           Diagnostics& diagnostics);
/// The program's path alone, out of a stock.
Swept sweep_path_section(const machine::Job& job, const removal::Stock& blank, const motion::PathStretch& path,
                         const SectionPlace& place);

/// Change of the stock that a piece must feel, or of the deflection with which the tool enters it, before it is solved
/// again.
inline constexpr double kSettled_mm = 5e-5;

/// Rounds of static coupling, at most.
inline constexpr int kMaxSectionRounds = 12;

/// All sections' parts, in order; those of others may be what is within the section's region. `last`, `before_last`: of
/// the rounds of solving before this one; empty where there is none.
struct SectionParts {
  std::vector<SweptSection> swept;
  std::vector<SolvedSection> last, before_last;
  OwnSweep own_sweep;
  OwnSolution own_last, own_before_last;
  /// `last` is of a path much like this one, with as many pieces: the first round begins from what it left, instead of
  /// the sweeps, and solves all pieces.
  bool from_another_path = false;
};
struct SolveOptions {
  std::size_t section = 0, sections = 1;
  std::optional<std::size_t> turn_from{};  ///< see PredictOptions
  std::function<void(double)> progress{};
  const motion::PathOutline* outline = nullptr;  ///< outline of a path that is not in memory as a whole
};
struct Solved {
  SolvedSection section;
  OwnSolution own;
};
/// Solves a section; in a later round only the pieces whose stock has changed. `kept` (null: nothing is kept): the
/// section's target, made where it is empty, for the next round of the same section.
Solved solve_section(const machine::Job& job, const SectionPrograms& programs, const SectionParts& parts,
                     const SolveOptions& options, Diagnostics& diagnostics,
                     std::optional<simulate::Target>* kept = nullptr);
/// The same against a whole target; no contour.
Solved solve_path_section(const machine::Job& job, const simulate::Target& target, const motion::PathStretch& path,
                          const SectionPlace& place, const SectionParts& parts,
                          const std::function<void(double)>& progress);

/// Regions that a section reads of others' parts; the rest may be left out here. Empty where the section has nothing.
/// `programs` may be at another section.
removal::Region section_region(const machine::Job& job, const SectionPrograms& programs, std::size_t section,
                               std::size_t sections);
removal::Region section_region(const machine::Job& job, const motion::PathStretch& path, const SectionPlace& place,
                               std::size_t section);

/// Gives the parts of all sections one after the other, in order; each may be used up. Several times the same.
using EachSwept = std::function<void(const std::function<void(const SweptSection&)>& use)>;
using EachSolved = std::function<void(const std::function<void(SolvedSection&)>& use)>;
EachSwept each_of(const std::vector<SweptSection>& swept);
EachSolved each_of(std::vector<SolvedSection>& solved);

/// Joins the target's parts instead of sweeping it. `within` (null: everywhere) bounds what is joined and must outlive
/// the result, as what the parts come from must.
simulate::TargetWork joined_target(EachSwept swept, EachSolved solved, const removal::Region* within = nullptr);

/// The prediction of all parts. `solved`: of the last round. One part is looked at at a time. Target: made by
/// joined_target(), or whole; its map is used up.
simulate::Prediction merge_sections(const machine::Job& job, simulate::Target& target,
                                    const simulate::SimulatedProgram& program, const EachSwept& swept,
                                    const EachSolved& solved);
simulate::Prediction merge_sections(const machine::Job& job, const simulate::Target& target, removal::SurfaceMap map,
                                    const simulate::SimulatedProgram& program, const EachSwept& swept,
                                    const EachSolved& solved);

}  // namespace camber::distribute
