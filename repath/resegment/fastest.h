#pragma once
// The length of segments, and where it must be the feed, with which a machine is fastest.
#include <functional>
#include <vector>

#include "feedmodel/timed_path.h"
#include "machine/machine_model.h"
#include "nc/interpreter.h"
#include "repath/resegment/resegmentation.h"

namespace camber::repath {

// Predicted time of a path, and deviation of the axes from the reference path.

struct ContourFigures {
  double time_s = 0;  ///< of the whole program
  double cutting_time_s = 0;
  double contour_max_mm = 0;  ///< distance of the predicted axes from the path that was meant, while cutting
  double contour_rms_mm = 0;  ///< over time
  std::vector<float> move_s;  ///< how long each move takes, to within the control's period; of a program against itself
};

/// The path that was meant: its chains of cutting moves, each with the rapid that leads to it.
class MeantPath {
 public:
  explicit MeantPath(const nc::Interpretation& meant);

 private:
  friend class Follower;
  std::vector<std::size_t> first_;  ///< of each chain's points; behind the last one their number
  std::vector<Vec3> points_;
  std::vector<double> along_;  ///< up to each point, from its chain's first
};

/// Predicts `program` on the machine, against the path that was meant. Both have the same chains of cutting moves, one
/// after another; the nearest point is looked for along the chain, no farther than a few millimetres ahead.
/// `moves`: ContourFigures::move_s is wanted.
ContourFigures contour_figures(const nc::Interpretation& program, const MeantPath& meant,
                               const machine::Machine& machine, bool moves = false);
ContourFigures contour_figures(const nc::Interpretation& program, const nc::Interpretation& meant,
                               const machine::Machine& machine);

struct Candidate {
  double length_factor = 1;  ///< of L_b, or of the old mean length
  double feed_factor = 1;
  CornerFeeds corners{};
  ContourFigures figures{};
};

/// Most that the predicted axes may stray from the path that was meant.
struct ContourLimit {
  double max_mm = 0, rms_mm = 0;

  bool holds(const ContourFigures& f) const { return f.contour_max_mm <= max_mm && f.contour_rms_mm <= rms_mm; }
  /// How much of it is used, of the one that is nearer to it: 1 at the limit.
  double fraction(const ContourFigures& f) const;
};

struct FastestOptions {
  ResegmentOptions layout{};  ///< with length_mm > 0 no length is looked for
  double contour_mm = 0;  ///< most that the predicted axes may stray from the old path, rms as they like; 0: neither in
                          ///< the largest nor in the rms more than they do with the old blocks (or the tolerance)
  bool keep_old = true;   ///< where nothing is faster than the old program, that is what comes out
  bool fewest_blocks = false;  ///< a shorter length is only taken where it saves more than 0.5 % of the time
  nc::InterpreterOptions interpreter;
  std::function<void(double)> progress{};  ///< fraction of the most trials that there may be
};

struct Fastest {
  Resegmentation path;
  std::vector<Candidate> tried;  ///< empty where the old program is so near to its feed that nothing can be gained
  std::size_t chosen = 0;        ///< of `tried`
  std::size_t unbounded = 0;     ///< of `tried`: the fastest one, whatever its contour
  ContourLimit limit;
  bool gains = true;         ///< false: nothing is faster than the old program, which `path` then is
  bool within_limit = true;  ///< false: no candidate keeps the limit; the one with the smallest deviation is chosen
};

/// Lays the program out with lengths from ten times L_b down to L_b at the programmed feed and predicts each on the
/// machine; after two in a row that are no faster the shorter ones are not tried (with fewest_blocks all are). Where
/// the fastest does not keep to the limit, feeds are looked for at that length: for some times of steps between corners
/// and some shares about corners the highest feed that keeps to it, which two or three trials find. The number of
/// trials is bounded by the length of the program, such that about three million blocks are predicted. The fastest
/// candidate that keeps to the limit is chosen. `before`: the figures of the old program.
Fastest find_fastest(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
                     const ContourFigures& before, const FastestOptions& options);

}  // namespace camber::repath
