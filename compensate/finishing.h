#pragma once
// Selects which of the simulated moves are compensated.
#include <cstdint>
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "removal/form_error.h"
#include "simulate/predict_path.h"

namespace camber::compensate {

/// The simulated moves of one tool between two tool changes.
struct Operation {
  int tool = 0;
  std::size_t first_line = 0, last_line = 0;  ///< 1-based
  double surface_fraction = 0;                ///< fraction of the machined surface that it made
  std::size_t moves = 0, compensated_moves = 0;
};

struct Finishing {
  std::vector<bool> moves;  ///< one per move of the program: compensated
  std::vector<Operation> operations;
};

/// Least fraction of the surface that a finishing operation makes.
inline constexpr double kFinishingFraction = 0.05;

/// Returns, of the moves that the job simulates, those that [compensation] operations names by tool, lines and
/// comments; where it names none, the operations that made at least kFinishingShare of the surface (`surface`: of the
/// given program; empty: all operations).
///
/// A comment names the moves behind it, up to the next tool change or the next comment; comments on lines behind each
/// other, without a move between them, are one heading.
Finishing find_finishing(const machine::Job& job, const simulate::SimulatedProgram& program,
                         const std::vector<removal::SurfacePoint>& surface);
/// The same before the program is cut, by the surface that its moves would make without deflection. `target`: swept by
/// the program itself.
Finishing expected_finishing(const machine::Job& job, const simulate::SimulatedProgram& program,
                             const simulate::Target& target);
/// Number of runs of the program's path before the first one that has a stamp on a compensated move.
std::size_t runs_before(const simulate::SimulatedProgram& program, const std::vector<bool>& compensated);

/// Role of a line of a program in a compensation.
enum class LineRole : std::uint8_t { none, compensated, only_simulated };
/// Returns one role per line; a line that both kinds of moves come from counts as compensated. Moves whose words may
/// not be changed are simulated only.
std::vector<LineRole> line_roles(const simulate::SimulatedProgram& program, const std::vector<bool>& compensated);

/// Error [cutter-radius] at the first of `moves` that runs under G41 or G42: its path is made by the control, the text
/// has no words for it. Error [nothing-to-compensate] where there is no move, or none whose words may be changed.
void check_compensated(const simulate::SimulatedProgram& program, const std::vector<bool>& moves,
                       Diagnostics& diagnostics);

}  // namespace camber::compensate
