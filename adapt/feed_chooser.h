#pragma once
// The feeds of a program for what its loads allow, with the control in the loop.
#include <memory>
#include <span>
#include <vector>

#include "adapt/feed_cells.h"
#include "adapt/feed_plan.h"
#include "adapt/observed_loads.h"
#include "nc/emit.h"
#include "nc/move_map.h"
#include "simulate/predict.h"

namespace camber::adapt {

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
