#include "cli/program_figures.h"

namespace camber::cli {

ProgramFigures figures_of(const nc::Program& program, const nc::Interpretation& moves) {
  ProgramFigures f;
  for (const nc::Block& block : program.blocks) f.blocks += block.word_count > 0;
  for (const nc::Move& move : moves.moves) {
    if (move.kind != nc::MoveKind::linear && move.kind != nc::MoveKind::arc) continue;
    ++(move.kind == nc::MoveKind::arc ? f.arcs : f.lines);
    f.length_mm += nc::length_mm(moves, move);
  }
  return f;
}

}  // namespace camber::cli
