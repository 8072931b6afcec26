#pragma once
// Which moves of a program `post` rewrites, and what each truly does. Internal to repath/post/post_processing.cpp.
#include <vector>

#include "repath/post/post_plan.h"
#include "repath/post/post_processing.h"
#include "repath/post/tip_motion.h"

namespace camber::repath {

struct PostMotions {
  std::vector<TipMotion> motions;    ///< of the moves that are rewritten, in order
  std::vector<Barrier> before;       ///< plan_choices; one more than motions
  std::vector<std::size_t> of_move;  ///< index into motions; kKept: the move stays as it is
  std::vector<bool> first_of_run;    ///< motion: the move before it is not rewritten, dwells aside

  static constexpr std::size_t kKept = static_cast<std::size_t>(-1);
};

/// Requires moves.machine_origin_mm. Errors: post().
PostMotions post_motions(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
                         PostTarget target, Diagnostics& diagnostics);

}  // namespace camber::repath
