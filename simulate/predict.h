#pragma once
// A whole prediction: program to timed path to stamps to forces, deflections and the form error of the part.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "feedmodel/timed_path.h"
#include "machine/job.h"
#include "nc/move.h"
#include "nc/program.h"
#include "removal/form_error.h"
#include "removal/stock.h"
#include "removal/tool_path.h"
#include "simulate/cut.h"
#include "simulate/holes.h"

namespace camber::simulate {

/// A program as it runs on the job's machine.
struct SimulatedProgram {
  nc::Program text;
  nc::Interpretation moves;
  std::vector<bool> selected;            ///< per move: milled by the job's operations
  std::vector<removal::HoleMove> holes;  ///< per move
  removal::StampPath path;
  feedmodel::FeedSummary feed;
};

/// Reads, interprets, checks and times a program. `samples` (may be empty) also receives the timed path.
/// Throws InputError.
SimulatedProgram simulate_motion(SourceText source, const machine::Job& job, const feedmodel::SampleSink& samples,
                                 Diagnostics& diagnostics);

/// A place on a program's moves.
struct PathFraction {
  std::uint32_t move = 0;
  float fraction = 0;  ///< of the move's length
};

/// Which points of a SurfaceMap are left out of a job's surface (simulate/region.h).
struct SurfaceRegion {
  std::vector<bool> left_out{};  ///< one per point; empty: none
  double border_mm2 = 0;         ///< left out: moves that the job leaves out cut deeper there
  double not_judged_mm2 = 0;     ///< left out: made by moves that [part] judged does not name
  bool between = false;          ///< moves that the job leaves out cut deeper everywhere: no border is left out
};

/// What the part is judged against, the nominal surface: the undeflected sweep of the target program's own moves
/// through the blank, without servo lag and corner rounding (removal::nominal_path).
struct Target {
  removal::Stock blank;          ///< before this job's first cut
  removal::Stock surface;        ///< the nominal one
  removal::CutterPlaces places;  ///< the nominal path's stamps, by the ids in `surface`
  std::optional<removal::MeshDistance> part;
  HoleStamps holes;                       ///< of the nominal path
  std::optional<removal::Stock> whole{};  ///< the stock before the allowance was taken off; empty: `blank`
  std::vector<PathFraction> stamps{};     ///< the nominal path's, on the target program's moves
  std::vector<float> contour_mm{};        ///< one per point of a SurfaceMap of this target; see Prediction::surface
  double unseen_mm2 = 0;                  ///< area of the nominal surface without a point
  SurfaceRegion region{};                 ///< what of the nominal surface is judged
  const removal::Stock& solid() const { return whole ? *whole : blank; }
};

/// Builds the blank (box or mesh, less what the target program, as the machine runs it, leaves with the cutter shrunk
/// by the allowance), sweeps the nominal path through it and marks it with the undeflected sweep as the machine runs
/// it. Throws InputError (stock missing, memory, nothing removed, sizes that differ by the factor of the inch).
Target make_target(const machine::Job& job, const SimulatedProgram& target, Diagnostics& diagnostics);

/// Sweeps the undeflected cutters of a path through the stock, each made smaller by shrink_mm along its normal; returns
/// the volume removed, mm^3. With shrink_mm > 0 holes are left out: an allowance lies on milled surface, they are made
/// from solid.
double sweep_path(removal::Stock& stock, const machine::Job& job, const removal::StampPath& path, double shrink_mm);

struct Prediction {
  CutResult cut;  ///< loads: one per stamp of the program; the volumes are without tapping, which has no chips
  HoleFigures holes;
  /// Of the target, but for what its holes made and what is not of the job's region (region.h). error_mm: machined
  /// minus nominal; contour_mm: the undeflected sweep of the target program as this machine runs it, minus nominal;
  /// their difference is what bending (and, in a compensated program, the shift) does.
  std::vector<removal::SurfacePoint> surface;
  std::vector<double> total_error_mm;   ///< against the part's mesh, one per point; empty without a mesh
  removal::ErrorFigures form_error_um;  ///< error_mm; the sum of the next two, point by point
  removal::ErrorFigures deflection_um, contour_um;
  double unseen_mm2 = 0;  ///< area of the nominal surface without a point
  /// Of the nominal surface, not in `surface`: see SurfaceRegion.
  double border_mm2 = 0, not_judged_mm2 = 0;
  bool between = false;
  std::unique_ptr<removal::Stock> machined;
  std::vector<int> slender_tools{};  ///< that cut, but are longer than the model covers (simulate/setup_checks.h)
};

/// `contacts`: also find where each stamp touches the target (only for the deflection at the contact).
struct PredictOptions {
  bool contacts = true;
  std::optional<std::size_t> turn_from;  ///< first stamp of a turn to keep in Prediction::cut.turn
  std::function<void(double)> progress;
  std::function<void()> surface_read;  ///< called when Target::surface is no longer needed
};

Prediction predict(const machine::Job& job, const Target& target, const SimulatedProgram& program,
                   const PredictOptions& options);

/// Chips and forces need samples about as fine as this along the profile: a hundredth of the diameter, 0.02 to 0.1 mm,
/// in which the edge lags by no more than a degree; the job's value where it gives one.
double envelope_step_mm(const machine::Job& job, const machine::Tool& tool);

}  // namespace camber::simulate
