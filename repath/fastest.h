#pragma once
// The length of segments, and where it must be the feed, with which a machine is fastest.
#include <vector>

#include "machine/machine.h"
#include "repath/contour.h"
#include "repath/resegment.h"

namespace camber::repath {

struct Candidate {
  double length_factor = 1;  ///< of L_b, or of the old mean length
  double feed_factor = 1;
  ContourFigures figures{};
};

struct FastestOptions {
  ResegmentOptions layout{};  ///< with length_mm > 0 no length is looked for
  double contour_mm = 0;  ///< most that the predicted axes may stray from the old path; 0: 5 % more than they do with
                          ///< the old blocks, or the tolerance, whichever is more
  bool keep_old = true;   ///< where nothing is faster than the old program, that is what comes out
  bool fewest_blocks = false;  ///< a shorter length is only taken where it saves more than 0.5 % of the time
  nc::InterpreterOptions interpreter;
};

struct Fastest {
  Resegmentation path;
  std::vector<Candidate> tried;
  std::size_t chosen = 0;  ///< of `tried`
  double contour_limit_mm = 0;
  bool gains = true;         ///< false: nothing is faster than the old program, which `path` then is
  bool within_limit = true;  ///< false: no candidate keeps to it; the one that strays least is chosen
};

/// Lays the program out with lengths from ten times L_b down to L_b and predicts each on the machine; the fastest of
/// those that keep to the contour is chosen. After two in a row that keep to it and are no better the shorter ones are
/// not tried (with fewest_blocks all are). Lower feeds (down to half) are tried only where none keeps to it at the
/// programmed one, with the three lengths that strayed least. `before`: the figures of the old program.
Fastest find_fastest(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
                     const ContourFigures& before, const FastestOptions& options);

}  // namespace camber::repath
