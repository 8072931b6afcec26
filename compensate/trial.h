#pragma once
// A trial: a shifted path is emitted, read again from its text, timed, cut and judged.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/path_quality.h"
#include "kinematics/control_options.h"
#include "motion/operations.h"
#include "nc/emit.h"
#include "simulate/setup.h"

namespace camber::compensate {

/// The emitted program of some shifts.
struct Emitted {
  std::vector<bool> splits;  ///< points of the path at which lines are split
  nc::Emission emission;
  simulate::SimulatedProgram program;
  nc::MoveMap map;
  PathQuality quality;
  machine::Operations operations;  ///< operations of the job, with the emitted program's lines
};

struct Trial {
  std::size_t version = 0;  ///< version of the program: 0 the given one, else one with second cuts
  std::vector<Vec3> shifts;
  std::vector<double> fractions;               ///< fraction of the programmed feed, one per point of the path
  std::shared_ptr<const Emitted> emitted;      ///< none: the given program
  std::vector<removal::SurfacePoint> surface;  ///< the same points in the same order, whatever the shifts
  std::vector<simulate::StampLoad> loads;
  std::vector<simulate::ChatterMargins::Passage> chatter;
  std::vector<double> total_mm;  ///< error against the part's mesh, one per point; empty without a mesh
  int static_rounds = 0;
  std::size_t unsettled = 0;
  bool all_valid = true;                                    ///< the model holds everywhere (simulate/validity.h)
  double chip_mm3 = 0, stock_mm3 = 0;                       ///< volume of the chips, and of the stock that they leave
  std::shared_ptr<const simulate::PartSurvey> part_yields;  ///< null: the part is rigid
  Observed observed;

  void keep(simulate::Prediction prediction);
};

using kinematics::decimals_for;
using motion::moved_ranges;

/// A program whose path is shifted, and what its trials need beside the path.
struct ShiftedProgram {
  machine::Job job;  ///< the job, with its operations as lines of this program
  std::shared_ptr<const simulate::SimulatedProgram> program;
  const simulate::Target* target = nullptr;  ///< target of the job; outlives the object
  bool own_target = true;                    ///< see simulate::Setup
  simulate::Predictor predictor = simulate::predict;
  std::vector<simulate::PathFraction> stamps{};  ///< Target::stamps on the moves of `program`; none: another's target
  nc::EmitOptions decimals{};
  std::vector<Vec3> bending{};     ///< nominal_bending, where rows are hidden; else empty
  std::vector<bool> first_cuts{};  ///< whether each move belongs to a run that is cut again; empty: none does
  /// Kept between the rounds, whose shifts hardly change how the part yields; null: the target's, or not known yet.
  std::shared_ptr<const simulate::PartSurvey> part_yields{};
  /// What the tools before the first compensated move leave; of this program alone. Null: nothing is kept.
  std::shared_ptr<simulate::LeadingRuns> leading{};
};

/// The given program of a set-up, which is kept.
ShiftedProgram given_program(const machine::Job& job, const std::shared_ptr<const simulate::Setup>& setup);

/// Largest distance of the emitted arcs from the shifted points of an arc.
inline constexpr double kViaTolerance_mm = 0.0005;

/// Emits the path's shifts and feeds, and reads and times the text. `splits`: points of the path at which lines are
/// split. Does not throw for problems that were already reported for the given program.
std::shared_ptr<const Emitted> emit(const ShiftedProgram& from, const ShiftPath& path, const std::vector<bool>& splits,
                                    const std::vector<bool>& compensated);
/// Returns the emitted text alone. `header`: comment lines for it.
nc::Emission text_of(const ShiftedProgram& from, const ShiftPath& path, const std::vector<bool>& splits,
                     const std::string& header = {});
/// Predicts the emitted program, or the program itself where none was emitted.
simulate::Prediction predict(const ShiftedProgram& from, const Emitted* emitted,
                             const std::function<void(double)>& progress);
Observed observe(const ShiftedProgram& from, const ShiftPath& path, const Emitted* emitted,
                 const std::vector<removal::SurfacePoint>& surface);

}  // namespace camber::compensate
