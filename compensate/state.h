#pragma once
// State of a compensation, passed between free functions: what stays the same (Task), the programs whose path is
// shifted (Version), and what the rounds have found so far (State).
//
//   measure.h      predicts a program: the given one, or one with shifts
//   propose.h      fits the next shifts to an error and emits them (trial.h)
//   judge.h        figures of a trial, what is kept, when the rounds end
//   rounds.h       rounds of these three, of the best of them place by place, and those that keep out of the part
//   spend_time.h   lower feeds, and second cuts (second_cuts.h), within a machine time
//   outcome.h      the figures of the program that is written, and its text
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compensate/compensate_path.h"
#include "compensate/feed_lever.h"
#include "compensate/row_links.h"
#include "compensate/sensitivity.h"
#include "compensate/splits.h"
#include "nc/repeat.h"

namespace camber::compensate {

inline constexpr double kRowReach_mm = 1.0;  ///< rows farther apart are not linked

/// The given program as it was measured.
struct GivenProgram {
  std::shared_ptr<const Trial> trial;
  PlainFigures plain;
  std::vector<bool> reach;       ///< Observed::reach
  std::vector<double> bound_mm;  ///< Observation::bound_mm, one per point of the surface
  double depth_limit_um = 0;
  double time_s = 0;  ///< machine time
};

/// The task of a compensation. The first prediction sets `given` and `feed_unusable`; after that it does not change.
struct Task {
  const machine::Job& job;
  const CompensateOptions& options;
  Diagnostics& diagnostics;
  std::shared_ptr<const simulate::Setup> setup;
  GivenProgram given{};
  bool feed_unusable = false;  ///< no F word of the moves to compensate can be changed, and the job does not name feed

  bool has(machine::Lever lever) const {
    return job.compensation.has(lever) && !(feed_unusable && lever == machine::Lever::feed);
  }
  bool only_shifts() const {
    return !has(machine::Lever::feed) && !has(machine::Lever::passes) && !has(machine::Lever::allowance);
  }
  /// Extra machine time for the least error; not given: as much as the tolerance takes.
  std::optional<double> budget_percent() const {
    return options.time_budget_percent ? options.time_budget_percent : job.compensation.time_budget_percent;
  }
  double tolerance_mm() const { return job.compensation.half_width_um() / 1000; }
  /// Returns the spacing of the points on a long line. Where the control stops at every corner, a split would be a stop
  /// whose mark is a new error, which the next round would answer with new splits: there lines are not split.
  double spacing_mm() const;
};

/// Cuts of a version before the moves to compensate: repeated runs of them, or the passes before on another path.
struct EarlierCuts {
  std::vector<std::size_t> runs{};     ///< repeated runs: indices of pass_runs, each once per additional cut
  nc::RepeatedText text;               ///< text of the given program with the runs repeated
  std::vector<std::uint32_t> moves{};  ///< moves of this version, one per move of the given program
  double allowance_mm = 0;             ///< stock left by the first cuts, or by the passes before
  std::optional<PassBefore> pass_before{};
};

/// A program whose path is shifted: the given one, or one with other cuts before. Its moves to compensate are the
/// given program's, so that places on `path` have the same indices in every version.
struct Version {
  Version(ShiftedProgram shifted, std::vector<bool> moves_to_compensate, double spacing_mm);

  std::size_t index = 0;  ///< Trial::version
  ShiftedProgram source;
  std::vector<bool> compensated;  ///< one per move
  std::optional<EarlierCuts> repeated{};
  ShiftPath path;
  Sensitivity sensitivity;
  std::vector<double> stiffness;  ///< stiffness of the path, one per point
  std::vector<RowLink> links;
  Splits splits;
  bool split_once = false;
  std::vector<double> link_stiffness{};  ///< one per link of the path that the splits leave
  std::optional<FeedLever> feeds{};
  bool feeds_stuck = false;                     ///< a lower feed brought nothing
  std::shared_ptr<const Trial> best_shifted{};  ///< best of the rounds without lower feeds

  /// Runs that are cut again, see EarlierCuts.
  std::vector<std::size_t> passes() const { return repeated ? repeated->runs : std::vector<std::size_t>(); }
};

/// A trial that is kept, and its round.
struct Kept {
  std::shared_ptr<const Trial> trial;
  std::size_t round = 0;
};

/// The best round before the guard.
struct BeforeGuard {
  double correctable_um = 0;
  std::size_t round = 0;
  std::shared_ptr<const Emitted> emitted;
  std::size_t too_deep = 0;         ///< points of the surface below the depth limit
  std::int32_t deepest_stamp = -1;  ///< stamp that made the deepest of these points
};

struct RoundFigures {
  double rms_um = 0, p95_um = 0;  ///< judged error
  double depth_um = 0;            ///< gouge depth of 99.9 % of the surface
  bool out_of_question = false;   ///< the round takes too much machine time, or its passes before cut too deep
  double worse_um = 0;            ///< WorsePlaces::p999_um
};

/// What a round did, and where, for combine_rounds: no more than that, since every round is kept.
struct RoundPlaces {
  std::size_t version = 0;  ///< Trial::version
  std::vector<Vec3> shifts;
  std::vector<double> fractions;
  std::vector<bool> compensated;  ///< Observed::compensated
  struct OfPoint {
    float error_mm = 0;       ///< judged
    std::uint32_t lower = 0;  ///< ShiftPath::PointInterval that made it
    float upper_fraction = 0;
  };
  std::vector<OfPoint> points{};  ///< one per point of the surface
};

struct State {
  std::vector<std::unique_ptr<Version>> versions;
  Version* active = nullptr;  ///< its path is shifted
  std::vector<Round> rounds;
  std::vector<TimePoint> time_points;
  std::vector<RoundFigures> figures;  ///< one a round
  std::vector<RoundPlaces> places;    ///< one a round
  std::shared_ptr<const Trial> last;
  Kept best;
  Kept allowed;  ///< the best one that keeps the limits
  BeforeGuard free;
  /// Fraction by which the last round lowered the 95th percentile; none where it was rejected, or is the first.
  std::optional<double> last_gain;
  double step_fraction = 1;           ///< fraction of a step taken; less after over-corrections
  std::vector<Observation> expected;  ///< observations for the first round; empty: as observed
  std::size_t first_round = 0;        ///< first round of the active version
  double allowed_s = std::numeric_limits<double>::infinity();  ///< machine time
  Stop ended = Stop::rounds;                                   ///< why the rounds ended

  void activate(std::size_t version) { active = versions[version].get(); }
};

}  // namespace camber::compensate
