#pragma once
// Finds the place of the actual axes on the programmed path. They are behind the command, often by several short
// blocks.
#include <cstdint>
#include <functional>
#include <vector>

#include "feedmodel/timed_path.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// A place on the programmed path.
struct PathPlace {
  std::uint32_t move = 0;
  double u = 0;            ///< fraction of the move's length, in [0, 1]
  double distance_mm = 0;  ///< distance of the actual position from that place
};

struct PathTrackerOptions {
  /// The path is searched ahead of the last place over this length, the way the axes went since the last sample
  /// and twice their distance from the command (which bounds how far round a corner they can be behind).
  double search_mm = 0.5;
};

/// Share u in [from_u, to_u] of a move's length that lies closest to a point, and its distance. For a full or
/// repeated turn the closest one after from_u counts.
PathPlace closest_on_move(const nc::Interpretation& program, std::uint32_t move, const Vec3& point_mm, double from_u,
                          double to_u);

/// Measure of a path that nc::Move alone does not describe (part_tracking.h).
struct PathMeasure {
  /// Does what closest_on_move does, for the tool of the sample.
  std::function<PathPlace(std::uint32_t move, double from_u, double to_u)> closest{};
  std::function<double(std::uint32_t move)> length_mm{};
};

/// Follows the samples of predict_feed in order. The place of a sample is the closest point of the programmed path
/// between the last place and the commanded move, searched a little further than the axes went: it never goes
/// back, never passes the command, and does not jump to a neighbouring row or to the start of a closed figure. Only a
/// position more than 1 mm off the path found so is looked for on all moves up to the command.
/// During a move to or from a reference point the place is the start of that move, wherever the axes are.
/// When the axes rest at the end of a motion the place is the end. Linear time over the whole path.
class PathTracker {
 public:
  explicit PathTracker(const nc::Interpretation& program, const PathTrackerOptions& options = {})
      : program_(program), options_(options) {}

  /// For a path that is measured otherwise; `closest` is asked for the sample that is passed.
  PathTracker(const nc::Interpretation& program, PathMeasure measure)
      : program_(program), measure_(std::move(measure)) {}

  PathPlace operator()(const TimedSample& sample);

 private:
  PathPlace closest(std::uint32_t move, const TimedSample& sample, double from_u) const {
    return measure_.closest ? measure_.closest(move, from_u, 1.0)
                            : closest_on_move(program_, move, sample.position_mm, from_u, 1.0);
  }
  double length_of(std::uint32_t move) const {
    return measure_.length_mm ? measure_.length_mm(move) : nc::length_mm(program_, program_.moves[move]);
  }
  /// The closest place between the last one and the commanded move.
  PathPlace search_all(const TimedSample& sample, PathPlace best) const;

  const nc::Interpretation& program_;
  PathTrackerOptions options_{};
  PathMeasure measure_{};
  PathPlace place_;
  Vec3 last_position_mm_ = Vec3::Zero();
  bool started_ = false;
};

}  // namespace camber::feedmodel
