#pragma once
// State of a compensation while its rounds run. compensate.cpp has the order of the steps; the steps are in
//   loop_start.cpp   the program as given: its error, what of it is compensated
//   loop_rounds.cpp  rounds of shifts, and what is kept of each
//   loop_levers.cpp  lower feeds and second cuts, within a machine time
//   loop_versions.cpp  the programs in which runs are cut twice
//   loop_finish.cpp  the figures of the program that is written
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compensate/choice.h"
#include "compensate/compensate.h"
#include "compensate/feed_lever.h"
#include "compensate/guard.h"
#include "compensate/passes.h"
#include "compensate/sensitivity.h"
#include "compensate/splits.h"
#include "compensate/step_model.h"

namespace camber::compensate {

inline constexpr double kRowReach_mm = 1.0;  ///< rows farther apart are not linked

/// A program whose path is shifted: the given one, or one in which runs are cut twice. Its moves to compensate are the
/// given program's, so that places on `path` have the same indices in every version.
struct Version {
  std::vector<bool> compensated{};  ///< one per move
  std::vector<bool> first_cuts;     ///< one per move: of a run that is cut again; empty: none
  std::optional<ShiftPath> path;
  std::optional<Sensitivity> sensitivity;
  std::vector<double> stiffness;     ///< stiffness of the path, one per point
  double free_angle_growth_rad = 0;  ///< largest, before the path was made stiffer there
  std::vector<RowLink> links;
  std::optional<Splits> splits;
  bool split_once = false;
  std::vector<double> link_stiffness;  ///< one per link of the path that the splits leave
  std::optional<FeedLever> feeds;
  bool feeds_stuck = false;                     ///< a lower feed brought nothing
  std::vector<std::size_t> passes;              ///< runs that are cut twice
  std::vector<std::uint32_t> moves;             ///< this version's, one per move of the given program; empty: the same
  std::optional<nc::RepeatedText> repeated{};   ///< text of the given program with runs repeated
  std::shared_ptr<const Trial> best_shifted{};  ///< best of the rounds without lower feeds

  // While it is the active one, the set-up and the job have these.
  simulate::SimulatedProgram program;
  std::vector<simulate::PathFraction> stamps;
  machine::Operations operations;
  std::vector<Vec3> bending;  ///< TrialRunner::bending
};

/// Judged errors, each of an area.
struct JudgedErrors {
  std::vector<double> error_um, area_mm2;
};

class Loop {
 public:
  Loop(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options);

  void start(CompensationResult& out);
  /// Rounds of shifts from the last trial on.
  void converge(CompensationResult& out);
  /// Uses lower feeds and second cuts for what no shift removes, step by step of machine time, until the tolerance is
  /// kept; with a budget its least error.
  void spend_time(CompensationResult& out);
  /// Runs rounds that lift the path where the best round's surface lies deeper than the limit.
  void stay_out_of_part(CompensationResult& out);
  /// Takes the best round that keeps the limits; the given program where none is better.
  void choose(CompensationResult& out);
  void finish(CompensationResult& out);
  /// The other grid and the uncertainty; the text last, since its header may tell of them.
  void check(CompensationResult& out);

 private:
  using Prepare = std::function<void(std::vector<Observation>&)>;
  /// A round before its prediction.
  struct PlannedRound {
    std::shared_ptr<const Trial> from;  ///< trial whose error it goes by
    std::shared_ptr<Trial> made;        ///< with its text only
    Round round{};
    bool shows_gain = true;  ///< the change of the error shows the sensitivity
  };
  using Fit = std::size_t(ShiftPath&, std::span<const Observation>, const FitShiftOptions&);  ///< fit_shift, fit_lifts

  bool has(machine::Lever lever) const {
    return job_.compensation.has(lever) && !(feed_unusable_ && lever == machine::Lever::feed);
  }
  /// Extra machine time for the least error; not given: as much as the tolerance takes.
  std::optional<double> budget_percent() const {
    return options_.time_budget_percent ? options_.time_budget_percent : job_.compensation.time_budget_percent;
  }
  double tolerance_mm() const { return job_.compensation.half_width_um() / 1000; }
  /// Decides on splits. Where the control stops at every corner, a split would be a stop: the feed falls to nothing
  /// there, and the mark that this leaves is a new error, which the next round answers with new splits.
  double spacing_mm() const;
  FitShiftOptions fit_options(std::span<const double> stiffness, std::span<const RowLink> links,
                              std::span<const double> link_stiffness) const;
  /// The path with all its points, by which errors are judged.
  FitShiftOptions fit_options() const;
  std::function<void(double)> progress(const std::string& what) const {
    return simulate::progress_of(options_.progress, what);
  }

  // loop_start.cpp
  void read_given(const simulate::Prediction& prediction, CompensationResult& out);
  void check_levers(const std::vector<bool>& selected);
  void begin_version(Version& version);
  void expect_hidden_rows(Trial& given);
  void look_out(CompensationResult& out);
  void choose_bounds(Trial& given);
  std::vector<double> bounds_of_bow(const Trial& given);

  // loop_rounds.cpp
  /// New shifts from the last trial's error, and their prediction. False: their text is the last trial's, and nothing
  /// is predicted.
  bool step(CompensationResult& out, double fraction, const Guard* guard);
  /// The text of new shifts, without its prediction. `prepare` may change the feeds of the path and the observations
  /// that the shifts are fitted to.
  PlannedRound plan_round(double fraction, const Guard* guard, const Prepare& prepare = {});
  /// Predicts a round; the path must have its shifts and feeds.
  void run_round(CompensationResult& out, PlannedRound planned);
  void fit_and_emit(const std::vector<Observation>& observations, double fraction, Fit* fit, Round& round, Trial& next);
  void predict_trial(Trial& trial, const std::string& what);
  WorsePlaces worse_of(const Trial& trial) const {
    return worse_places(given_trial_->surface, trial.surface, trial.observed, job_.compensation);
  }
  std::vector<Observation> wanted_of(const Observed& observed, const Guard* guard);
  void choose_splits(const std::vector<Observation>& observations, Fit* fit);
  void stiffen(const std::vector<MoveMap::MovePlace>& places);
  PlainFigures figures_of(const Trial& trial) const;
  void record(CompensationResult& out, Round round);
  void take(CompensationResult& out);
  bool done(const CompensationResult& out, const StepModel& model);
  bool worth_a_round(const CompensationResult& out, const StepModel& model);
  bool would_be_within(double effect);
  bool shift_pays(const Trial& trial, double p95_um, double effect);
  JudgedErrors errors_after_shift(const Trial& trial, double effect);
  bool ask_for_lifts(Guard& guard, double deepest_um);

  // loop_levers.cpp
  bool met(const CompensationResult& out) const;
  void lower_feeds(CompensationResult& out, double percent);
  bool feeds_pay(double percent);
  bool step_with_feeds(CompensationResult& out, double percent);
  std::vector<PassRun> runs_after_shifts();
  bool cut_twice(CompensationResult& out, double percent);
  void compensate_version(std::unique_ptr<Version> version, CompensationResult& out, double percent);
  nc::Emission first_cuts();

  // loop_versions.cpp
  std::unique_ptr<Version> version_with(const std::vector<PassRun>& runs, std::vector<std::size_t> chosen,
                                        const nc::Emission& first_cuts);
  void warn_of_run(std::uint32_t block, const std::string& why, const char* check);
  void fill_moves(const std::vector<std::uint32_t>& moves, Version& out) const;
  void activate(std::size_t version);
  void predict_version(CompensationResult& out);

  // loop_finish.cpp
  Stop verdict(const CompensationResult& out) const;
  std::vector<ProgramLine> lines_of(const Trial& trial, std::span<const std::int32_t> stamps) const;
  std::vector<BindingLimit> binding_limits(const CompensationResult& out);
  Tried tried(const CompensationResult& out) const;
  std::vector<std::uint32_t> given_blocks(std::vector<std::uint32_t> block_of_line) const;
  std::size_t count_changed(const Emitted& emitted) const;
  std::vector<nc::EditNotMade> in_given(std::vector<nc::EditNotMade> not_made) const;
  void say_passes(CompensationResult& out) const;
  void recheck_on(double voxel_mm, CompensationResult& out);
  const simulate::SimulatedProgram& given() const { return active_ == 0 ? setup_.program : versions_.front()->program; }

  machine::Job job_;
  Diagnostics& diagnostics_;
  const CompensateOptions& options_;
  simulate::Setup setup_;
  TrialRunner trials_;  ///< trials of the active version
  std::vector<std::unique_ptr<Version>> versions_;
  std::size_t active_ = 0;  ///< index of the version whose program the set-up has
  Version* now_ = nullptr;  ///< versions_[active_]

  bool feed_unusable_ = false;  ///< no F word of the moves to compensate can be changed, and the job does not name feed
  /// Fraction by which the last round lowered the 95th percentile; none where it was rejected, or is the first.
  std::optional<double> last_gain_;
  double share_ = 1;                                    ///< fraction of a step taken; less after over-corrections
  std::vector<Observation> expected_;                   ///< observations for the first round; empty: as observed
  std::shared_ptr<const Trial> last_, best_, allowed_;  ///< allowed_: the best one that keeps the limits
  std::shared_ptr<const Trial> given_trial_;
  std::size_t allowed_index_ = 0;
  std::vector<RoundFigures> figures_;  ///< one a round
  std::vector<bool> reach_;
  std::vector<double> bound_mm_;  ///< Observation::bound_mm, one per point of the surface
  double depth_limit_um_ = 0;
  std::size_t first_round_ = 0;                                 ///< first round of the active version
  bool too_slow_ = false;                                       ///< runs were not cut twice for want of time
  double allowance_mm_ = 0;                                     ///< allowance that first cuts leave
  double given_s_ = 0;                                          ///< machine time of the given program
  double allowed_s_ = std::numeric_limits<double>::infinity();  ///< machine time
  Stop ended_ = Stop::rounds;                                   ///< why the rounds ended
  Observed first_observed_;                                     ///< of the given program
  double free_correctable_um_ = 0;                              ///< correctable, best round before the guard
  std::size_t free_round_ = 0;                                  ///< number of that round
  std::shared_ptr<const Emitted> free_;                         ///< its program
};

}  // namespace camber::compensate
