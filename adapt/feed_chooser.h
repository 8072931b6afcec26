#pragma once
// The feeds of a program for what its loads allow, with the control in the loop.
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "adapt/feed_cells.h"
#include "adapt/observed_loads.h"
#include "nc/emit.h"
#include "nc/move_map.h"
#include "simulate/predict_path.h"

namespace camber::adapt {

// Few feeds along a path that stay below a ceiling.

struct FeedBounds {
  double lowest_mm_per_s = 0, highest_mm_per_s = 0;
  double step_fraction = 0.05;  ///< neighbouring feeds differ by more than this
  double change_s = 0.03;       ///< time that a change of feed must save
  double min_length_mm = 0.2;   ///< least length of a block that a split makes
};

/// By cell.
struct FeedCeiling {
  std::vector<double> allowed_mm_per_s;    ///< by the loads; infinite: no limit; below zero: not known
  std::vector<double> reachable_mm_per_s;  ///< greatest speed that the control reaches there
};

/// Feeds of all cells, one per cell: the least time,
///
///   sum length / min(F, reachable) + changes * change_s -> min,  F <= allowed, lowest <= F <= highest
///
/// over levels that differ by the step (Viterbi along each stretch of cells whose feed may change); then every run of
/// equal cells is raised to the least ceiling of its cells, but to no speed that the control does not reach, and runs
/// that differ by less than a step become one. The programmed feed stays where it differs by less than a step and
/// keeps the ceiling, or where the axes are slower anyway; kept cells have it too, and those of which nothing is known.
/// Where no level keeps the ceiling the feed is the lowest.
std::vector<double> plan_feeds(const FeedCells& cells, const FeedCeiling& ceiling, const FeedBounds& bounds);

/// By cell: the least value within `reach_mm` along its chain. Values below zero (not known) stay and count for no
/// other cell.
std::vector<double> least_within(const FeedCells& cells, std::span<const double> values, double reach_mm);

// What several predictions show of the greatest feed within the limits.

/// By cell: the fastest speed seen that kept the limits, and the slowest one that did not. The model of the loads
/// (LoadCurve) extrapolates from one observation; between two observations the feed is interpolated.
class FeedBrackets {
 public:
  explicit FeedBrackets(const FeedCells& cells) : cells_(cells), kept_(cells.size()), exceeded_(cells.size()) {}

  /// A prediction: the actual speed of each cell, and its greatest load / limit. 0: no load was observed there; the
  /// passings of its neighbours count for a cell, since at another feed they fall elsewhere.
  void add(std::span<const double> speed_mm_per_s, std::span<const double> load_of_limit);

  /// The speed of a cell at which load / limit is about `aim`, never above the slowest one that exceeded the limits.
  /// `modelled`: what the loads last observed allow; the least where the limits were never exceeded.
  double speed_mm_per_s(std::size_t cell, double modelled, double aim) const;

 private:
  static constexpr std::size_t kNeighbours = 2;
  struct Seen {
    double speed_mm_per_s = 0, load_of_limit = 0;  ///< speed 0: never
  };

  const FeedCells& cells_;
  std::vector<Seen> kept_, exceeded_;
};

/// A program with other feeds, as the machine runs it.
struct FeedCandidate {
  std::vector<double> feed_mm_per_s;   ///< commanded, one per cell
  std::vector<double> speed_mm_per_s;  ///< greatest actual speed, one per cell
  nc::Emission emission;
  simulate::SimulatedProgram program;
  nc::MoveMap map;                 ///< from its moves to the given program's
  machine::Operations operations;  ///< the job's, with the lines of the emitted program
};

/// Time of the moves that are milled, from tooth passing to tooth passing.
double milling_time_s(const simulate::SimulatedProgram& program);

/// Emits, times and corrects. Everything passed must outlive the object.
///
/// The axes are not where the command is: after a change of feed the actual speed follows over the lag of the position
/// loop and the length of the ramp. A slow passage therefore begins before and ends after the place that needs it, by
/// as much as the feed model shows to be necessary: where the actual speed exceeds what the loads allow the passage is
/// widened, at last lowered. A feed that the axes do not reach within its blocks is lowered to the speed that they do
/// reach.
class FeedChooser {
 public:
  FeedChooser(const machine::Job& job, const simulate::SimulatedProgram& given, const FeedCells& cells);

  /// allowed_mm_per_s: see allowed_feeds(). rounds: of emitting and timing, at most.
  std::shared_ptr<FeedCandidate> choose(std::span<const double> allowed_mm_per_s, std::span<const Contact> contacts,
                                        int rounds = kRounds) const;
  /// The program with these feeds.
  std::shared_ptr<FeedCandidate> with(std::vector<double> feed_mm_per_s) const;
  /// Every feed that may be changed is the given one.
  std::shared_ptr<FeedCandidate> with_constant(double feed_mm_per_s) const;

  const FeedBounds& bounds() const { return bounds_; }
  /// By cell: greatest actual speed with the highest feed everywhere.
  const std::vector<double>& top_speed_mm_per_s() const { return top_speed_; }
  static constexpr int kRounds = 8;

 private:
  struct Ceiling;
  std::vector<double> ceiling_of(std::span<const double> allowed, std::span<const Contact> contacts) const;
  void slow_entries(std::span<const Contact> contacts, std::vector<double>& ceiling) const;
  bool lower_excesses(const FeedCandidate& candidate, std::span<const double> allowed, int round,
                      std::vector<double>& reach_mm, std::vector<double>& ceiling) const;
  bool lower_unreached(const FeedCandidate& candidate, std::vector<double>& reachable) const;
  std::vector<double> greatest_speeds(const FeedCandidate& candidate) const;

  const machine::Job& job_;
  const simulate::SimulatedProgram& given_;
  const FeedCells& cells_;
  FeedBounds bounds_;
  std::vector<double> radius_mm_;  ///< radius of the tool, by cell
  std::vector<double> top_speed_;
};

}  // namespace camber::adapt
