#pragma once
// Compensation of a program: predict it, shift each path point against its error, predict the emitted text again.
// This is the door of compensate/.
//
// Overview
//
// Input is a job whose program has been read, timed and checked (simulate/setup.h). Each round has these steps:
//
// 1. attribution   finds, for every point of the surface, the place on the path that generated it; hidden_rows gives
//                  the expected error where a neighbouring row has cut that place away.
// 2. row_form      subtracts what keeps the same form across a row (the bow of a ball), which no shift removes.
// 3. fit_shift     fits the shifts of the path nodes (shift_path) to the errors by least squares, smoothly along the
//                  path and from row to row (row_links), divided by the local sensitivity (sensitivity: a deeper cut
//                  deflects more). splits decides where lines get more nodes.
// 4. trial         emits the shifted program (nc/emit), reads the text again, times, cuts and judges it.
// 5. judge         decides whether another round is worth its prediction, and with which step.
//
// Afterwards the guard lifts the path where the surface lies deeper in the part than the limit, the levers lower feeds
// (feed_lever, feed_choice) or repeat runs (passes) where the job allows it, and judge takes the best round
// within the limits. remaining_error, error_split, safety, path_quality and uncertainty describe what comes out;
// verify judges an emitted program from its text. state.h has the state of all this and says where each step is.
//
// The reference is error_um: the machined surface minus the one that the commanded path leaves with a rigid tool, along
// the normal. All lengths are mm unless the name says otherwise. docs/compensation.md has equations and figures.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "compensate/error_split.h"
#include "compensate/finishing.h"
#include "compensate/measured.h"
#include "compensate/path_quality.h"
#include "compensate/recheck.h"
#include "compensate/remaining_error.h"
#include "compensate/safety.h"
#include "compensate/trial.h"
#include "compensate/uncertainty.h"
#include "machine/job_file.h"
#include "removal/stock.h"
#include "simulate/setup.h"

namespace camber::compensate {

/// Why the rounds ended, judged on the emitted text. tolerance: it is within tolerance and depth limit; depth_limit:
/// the depth limit keeps the error over the tolerance; stalled: the rms no longer falls, or nothing is left that a
/// shift can correct.
enum class Stop { tolerance, stalled, rounds, depth_limit };
std::string to_string(Stop stop);

struct Round {
  removal::ErrorFigures error_um;  ///< judged error of the program that this round emitted, see PlainFigures
  ErrorSplit split;
  double largest_shift_mm = 0;
  std::size_t limited_points = 0;     ///< points whose shift was cut to max_shift_mm
  double gain = 1;                    ///< mean sensitivity of the error to the shift, by which the step was divided
  double step_fraction = 1;           ///< fraction of the step taken; less than 1 after an over-correction
  double overcorrected_fraction = 0;  ///< fraction of the area whose error changed its sign and is over the tolerance
  double deepest_um = 0;              ///< depth that 99.9 % of the compensated surface keeps
  bool guard = false;                 ///< a round of the guard against gouging
  bool combined = false;              ///< shifts of the rounds before, each where it left the least (rounds.h)
  double machine_time_s = 0;
  std::size_t slowed = 0;    ///< changes of feed: stretches of the path with a feed of their own, and their ends
  std::size_t repeated = 0;  ///< cuts that are added: runs of cuts between rapids once more, or several times
  int static_rounds = 0;
  std::size_t unsettled = 0;
};

/// Machine time against error: the best program that was found for a time.
struct TimePoint {
  double allowed_percent = 0;  ///< extra time; 0: only the path is shifted
  std::size_t round = 0;       ///< index into CompensationResult::rounds
};

/// Lines of the given program that are cut twice or more.
struct RepeatedRun {
  std::size_t first_line = 0, last_line = 0;
  int cuts = 2;
};

/// Expected error before the rounds start, um.
struct Outlook {
  double given_p95_um = 0;       ///< judged error of the given program
  double achievable_p95_um = 0;  ///< the same where shifts take away all that they can
};

/// The part of the given program that is compensated, and the reference that it is judged against.
struct Scope {
  Finishing finishing;
  std::vector<LineRole> lines;     ///< one per line of the given program
  machine::Operations operations;  ///< the job's, as lines of the given program
  bool own_target = true;          ///< the given program is the target
  machine::Reference reference = machine::Reference::commanded;
  bool feed_unusable = false;  ///< the levers by default have feed, but no F word can be changed
};

/// Error and machine time of the given program and of the emitted one.
struct FormFigures {
  removal::ErrorFigures before_um, after_um;  ///< judged: rounds[0] and rounds[best]
  PlainFigures plain_before, plain_after;
  ErrorSplit split_before, split_after;
  Outlook outlook;
  WorsePlaces worse;      ///< places of the emitted program with a greater error than in the given one
  double unseen_mm2 = 0;  ///< area of the nominal surface without a point
  /// Left out of the surface: see simulate::SurfaceRegion.
  double border_mm2 = 0, not_judged_mm2 = 0;
  bool between = false;
  feedmodel::FeedSummary feed_before, feed_after;
};

/// The emitted program of the best round.
struct RewrittenProgram {
  std::string text;
  std::vector<std::uint32_t> block_of_line;  ///< by line of `text`, see nc::Emission; empty: the given program
  std::size_t blocks_before = 0, blocks_after = 0, blocks_changed = 0;
};

/// Expected effect of a lever that was not used.
struct LeverOutlook {
  machine::Lever lever = machine::Lever::passes;
  double p95_um = 0;   ///< judged error that is expected to remain
  double extra_s = 0;  ///< additional machine time
};

/// Verdict on the emitted program, with the causes and limits that keep it from being better.
struct CompensationVerdict {
  bool better = true;  ///< the round is better than the given program, or that is good, and within limits
  bool within_tolerance = false;
  bool settled = true;  ///< every static solution of the first and the best round converged
  Stop stop = Stop::rounds;
  std::vector<CauseFigure> causes;   ///< causes of the remaining error, where it is over the tolerance
  std::vector<LeverOutlook> unused;  ///< levers that would bring more, where it is over the tolerance
  std::vector<BindingLimit> limits;  ///< limits that kept the path from the shifts that its error asks for
  /// Reasons why the figures of the given or the emitted program are not reliable (simulate/verdict.h); empty: none.
  std::vector<std::string> doubts;
};

/// Runs of the emitted program that are cut twice or more.
struct SecondCuts {
  std::vector<RepeatedRun> runs{};
  double allowance_mm = 0;  ///< left by the cuts before the last one; 0: no run is repeated
  std::string text{};       ///< the program whose path was shifted, where runs are cut twice; else empty
};

/// Stock that the passes before leave for the moves to compensate (pass_before.h).
struct PassBefore {
  double given_mm = 0, left_mm = 0;  ///< median over the surface: with the given and with the emitted program
};

/// Depth into the part.
struct Safety {
  double depth_limit_um = 0;     ///< limit of the job, or default_depth_limit_um
  bool own_depth_limit = false;  ///< the job gives the limit
  Depth before, after;           ///< depth of the compensated moves
  Depth others;                  ///< depth of the moves that are not compensated
  Depth without_bending;         ///< depth of the emitted program cut by a rigid tool
  bool within_part = true;       ///< `after` is within the depth limit
};

/// Shape of the emitted path, and what it does to the surface from row to row.
struct PathFigures {
  double max_shift_mm = 0;
  PathQuality quality;
  RowSteps row_steps;
  SurfaceSteps surface_steps;
  double row_turn_rad = 0;  ///< largest turn between neighbouring rows of one sense, bounded as angles between blocks
};

struct UncertaintyFigures {
  std::vector<Recheck> rechecks;  ///< one per voxel asked for
  std::optional<Band> band;
  std::vector<std::string> unknown_parameters;  ///< parameters with a standard error that this job does not have
  std::optional<MeasuredFit> measured;
};

struct Surfaces {
  std::vector<removal::SurfacePoint> before, after;            ///< the same points, in the same order
  std::vector<simulate::StampLoad> loads_before, loads_after;  ///< loads of the given and of the emitted program
  std::vector<simulate::ChatterMargins::Passage> chatter_before, chatter_after;
  removal::StockShape stock;  ///< left by the target program, for a picture
};

struct CompensationResult {
  kinematics::MachineProgram given;  ///< the program that was compensated, as it was read
  Scope scope;
  std::vector<Round> rounds;             ///< rounds[0]: the given program
  std::size_t best = 0;                  ///< index into rounds
  std::vector<TimePoint> time_points{};  ///< only with a lever that takes time; ascending
  RewrittenProgram emitted;
  FormFigures figures;
  CompensationVerdict verdict;
  SecondCuts passes;
  std::optional<PassBefore> pass_before{};  ///< not given: the passes before are as given
  Safety safety;
  PathFigures path;
  UncertaintyFigures uncertainty;
  Surfaces surfaces;
};

/// Thrown where the given program is beyond the model, so that no error is known to compensate. what() says why.
using camber::BeyondModel;

struct CompensateOptions {
  simulate::Progress progress;
  std::function<void(const Outlook&)> outlook{};  ///< called once, before the rounds
  std::size_t max_stock_crossings = 0;            ///< size of Surfaces::stock; 0: none
  bool keep_anyway = false;  ///< emit the round with the smallest error even if none is better than the given program
  /// Replaces the job's time budget.
  std::optional<double> time_budget_percent{};
  std::vector<double> recheck_voxels_mm{};    ///< predict both programs on these grids as well
  std::vector<ParameterGroup> uncertainty{};  ///< parameters for UncertaintyFigures::band
  simulate::Predictor predictor = simulate::predict;
  /// Comment lines for the emitted program, asked for when all else is known; empty: none.
  std::function<std::string(const CompensationResult&)> header{};
};

/// Throws InputError and BeyondModel. The program's text is not written anywhere.
CompensationResult compensate(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options);

}  // namespace camber::compensate
