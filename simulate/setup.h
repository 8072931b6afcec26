#pragma once
// The way from a job's files to its first cut, the same for every command that cuts: read, time and stamp the program,
// check it, read what it is judged against, sweep that through the blank.
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "removal/height_map.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

/// A program and its target, before the first cut. Other programs of the same job (emitted ones, measured ones) may be
/// cut against the same target: predict(job, setup.target, ...).
struct Setup {
  SimulatedProgram program;
  std::optional<SimulatedProgram> original;  ///< what `target` was swept with; empty: `program`
  Target target;

  const SimulatedProgram& target_program() const { return original ? *original : program; }
  bool cleared = false;  ///< see SetupOptions::clearance
  Predictor predictor = simulate::predict;

  bool own_target() const { return !original; }
  /// Target::stamps where they are of `program`, else none.
  std::span<const PathFraction> own_stamps() const {
    return own_target() ? std::span(target.stamps) : std::span<const PathFraction>();
  }
};

struct SetupOptions {
  std::string program{};  ///< file; empty: the job's. Whatever it is, the target is the job's
  /// What the command asks of the program before the long work; errors that it adds to SetupFindings::program end it.
  /// The program's path is empty.
  std::function<void(const SimulatedProgram&)> check{};
  /// Looks at clearance before anything is swept, where check_heights() can.
  bool clearance = false;
  Predictor predictor = simulate::predict;  ///< for Setup::predictor
};

/// Where diagnostics go; may be one and the same.
struct SetupFindings {
  Diagnostics& program;   ///< of the program's text and motion, and of SetupOptions::check
  Diagnostics& original;  ///< of the text and motion of a target program that is another one
  Diagnostics& target;    ///< of stock, sweep and part
};

/// The target is [part] program where the job names one, else the job's program. Throws InputError.
Setup set_up(const machine::Job& job, const SetupOptions& options, const SetupFindings& findings);

/// What check_clearance() says, but for the machine's bodies, and whether anything is cut at all ([nothing-removed],
/// [allowance-too-large]), from a height map of the stock (height_survey.h). False where no height map describes the
/// job; nothing is said then. Requires a program that is timed. `original`: what the part is judged against, where it
/// is another program. `look` (may be empty) is shown the machined part.
bool check_heights(const machine::Job& job, const SimulatedProgram& program, const SimulatedProgram* original,
                   Diagnostics& diagnostics, const std::function<void(const removal::HeightMap& machined)>& look = {});

/// Collisions (collisions.h, machine_collisions.h), a region that begins in material (region.h), material above the
/// flutes (flute_reach.h).
void check_clearance(const machine::Job& job, const Setup& setup, Diagnostics& diagnostics);

/// Progress of several predictions: which one, and the fraction of it that is done.
using Progress = std::function<void(const std::string& what, double fraction)>;

/// `progress` of one of them; empty where that is.
std::function<void(double)> progress_of(const Progress& progress, std::string what);

/// The prediction of a program of which only the surface counts: no contacts (PredictOptions).
Prediction predict_surface(const Predictor& predictor, const machine::Job& job, const Target& target,
                           const SimulatedProgram& program, const Progress& progress, std::string what);

}  // namespace camber::simulate
