#pragma once
// A prediction put together from parts that were computed apart: pieces of the path, and a target that is joined
// instead of swept. For distribute/.
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "checks/setup_checks.h"
#include "machine/job_file.h"
#include "motion/path_stretch.h"
#include "removal/stock.h"
#include "simulate/cut.h"
#include "simulate/predict_path.h"
#include "simulate/setup.h"

namespace camber::simulate {

/// memory_factors() of a path of which some stamps are in memory.
MemoryFactors memory_factors(const machine::Job& job, const nc::Program& text, const nc::Interpretation& moves,
                             const motion::PathStretch& path, const StockSize& stock, const removal::Region* within);

/// What a prediction of the program in this stock needs. Error [voxel-memory], as check_memory(). Requires a program
/// that is timed.
MemoryEstimate check_memory_of(const machine::Job& job, const SimulatedProgram& program, const machine::Box& stock,
                               Diagnostics& diagnostics);

/// Where the tools of a program go that cut, beside the job's stock.
checks::Places places_of(const machine::Job& job, const SimulatedProgram& program, const machine::Box& stock);

/// The programs of a job.
struct Programs {
  SimulatedProgram program;
  std::optional<SimulatedProgram> original;  ///< the target's; empty: `program`

  const SimulatedProgram& of_target() const { return original ? *original : program; }
};
/// Reads, times and stamps both programs, as set_up(). Throws InputError.
Programs read_programs(const machine::Job& job, const SetupOptions& options, const SetupFindings& findings);

/// Programs that this process has read before, and what was said of the job's.
struct ReadPrograms {
  Programs programs;
  Diagnostics said;
};

/// Work on a target that is done elsewhere: each function joins what others have computed. Empty: computed here.
struct TargetWork {
  /// Takes what lies above the allowance off the blank. Returns the volume, mm^3, or more.
  std::function<double(removal::Stock& blank)> allowance{};
  /// Sweeps the nominal path through the blank. Returns the volume, mm^3, or more.
  std::function<double(removal::Stock& surface)> surface{};
  std::function<void(Target& target)> contour{};  ///< sets Target::contour_mm
  bool judged = true;  ///< false: nothing is judged: [part] mesh and Target::region are left out
  /// All that is read of blank and target lies here; null: everywhere. The target then has the cutters that reach in
  /// there, and no Target::stamps. Needs `surface`.
  const removal::Region* within = nullptr;
  /// The path of a target that SimulatedProgram::path has not got (`within` is given then): as the machine runs it, and
  /// nominal.
  const motion::SparsePath *path = nullptr, *nominal = nullptr;
};
Blank make_blank(const machine::Job& job, const SimulatedProgram& target, Diagnostics& diagnostics, double min_chip_mm,
                 const TargetWork& work);
Target make_target(const machine::Job& job, const SimulatedProgram& target, Diagnostics& diagnostics,
                   const TargetWork& work);
/// `read` (null: they are read): the programs, which are used up.
Setup set_up(const machine::Job& job, const SetupOptions& options, const SetupFindings& findings,
             const TargetWork& work, ReadPrograms* read = nullptr);

/// A part of a run of the path.
struct PieceCut {
  std::size_t run = 0, from = 0, count = 0;  ///< from: of the run
  machine::Coupling coupling = machine::Coupling::static_;
  const removal::Stock* before_run = nullptr;
  removal::SurfaceMap* surface = nullptr;
  const removal::Stock* target = nullptr;    ///< for the deflection at the contact
  std::optional<std::size_t> turn_from{};    ///< see PredictOptions
  const BendBefore* bend = nullptr;          ///< static: of the stamps before, where it is known
  const removal::KnownRun* known = nullptr;  ///< see CutOptions
  std::function<void(double)> progress{};
};
/// Cuts a part of a run; `stock` is as the stamps before it have left it.
CutResult cut_piece(removal::Stock& stock, const machine::Job& job, const motion::PathStretch& path,
                    const PieceCut& piece);

/// Stamps from ... from + count - 1 of a run. Those before them are in the stock, and `before` says how they were bent,
/// where that is known; contacts (one per stamp, or empty) are those of these stamps.
struct StampRange {
  std::span<const removal::Stamp> run;
  std::size_t from = 0, count = 0;
  std::span<const Contact> contacts{};
  std::int32_t first_id = 0;  ///< of the run
  const BendBefore* before = nullptr;
};
/// Cuts them alone, as cut() does; loads are those of these stamps.
CutResult cut_range(removal::Stock& stock, const machine::Tool& tool, const machine::Material& material,
                    const StampRange& range, const CutOptions& options);

/// Adds what a run, or a part of one, has given. In the order of the path.
void add_piece(const removal::ToolRun& run, CutResult piece, PathLoads& out);

/// The prediction from what a cut left: all points of Target::map with their errors, as SurfaceMap::take() returns
/// them.
Prediction judge(const machine::Job& job, const Target& target, const SimulatedProgram& program, PathLoads loads,
                 std::vector<removal::SurfacePoint> surface, std::unique_ptr<removal::Stock> machined);

}  // namespace camber::simulate
