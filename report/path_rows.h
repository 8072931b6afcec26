#pragma once
// What the page shows along the path: places, feeds and loads in time order.
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "feedmodel/timed_path.h"
#include "simulate/predict_path.h"

namespace camber::report {

inline constexpr double kNothingHere = std::numeric_limits<double>::quiet_NaN();

/// A moment of the program. NaN: nothing is known or nothing is cut here.
struct PathRow {
  double t_s = 0;
  Vec3 place_mm = Vec3::Zero();  ///< position of the tool's tip, actual axes
  Vec3 command_mm = Vec3::Zero();
  std::uint32_t block = 0;  ///< 1-based line being commanded
  bool cutting = false;     ///< G1, G2, G3
  double feed_command_mm_per_min = 0;
  double feed_mm_per_min = 0;           ///< actual
  double force_N = kNothingHere;        ///< greatest lateral force
  double deflection_um = kNothingHere;  ///< at the contact's height
  double chip_um = kNothingHere;        ///< thickest chip
  double margin = kNothingHere;         ///< greatest depth over critical depth; above 1 the cut chatters
  double error_um = kNothingHere;       ///< error of greatest magnitude of the surface made here
  double shift_um = kNothingHere;       ///< distance from the path of the given program
  // Of programs with rotary motion.
  Vec3 axis = Vec3::UnitZ();       ///< axis of the tool, in the part's frame
  Vec3 rotary_rad = Vec3::Zero();  ///< a, b, c, actual
  std::uint32_t tool = 0;          ///< number
};

/// One run of the program: as given, or compensated.
struct PathRun {
  std::string name;  ///< "before", "after"; of a single run empty
  std::string program_text;
  std::vector<PathRow> rows;  ///< in time order; empty: no plots
};

/// Takes the samples of predict_feed. Of each `period_s` the first, the slowest and the fastest sample are kept.
class PathCollector {
 public:
  explicit PathCollector(const nc::Interpretation& program, double period_s = 0.01)
      : program_(program), period_s_(period_s) {}
  void add(std::span<const feedmodel::TimedSample> samples);
  /// Samples in the part's frame, and the joints at them.
  void add(std::span<const feedmodel::TimedSample> samples, std::span<const feedmodel::JointSample> joints);
  std::vector<PathRow> take();

 private:
  PathRow row_of(const feedmodel::TimedSample& sample) const;
  void add(const PathRow& row);
  void close_period();

  const nc::Interpretation& program_;
  double period_s_, ends_s_ = 0;
  bool open_ = false;
  PathRow first_, slowest_, fastest_;
  std::vector<PathRow> rows_;
};

/// The program as the job's machine runs it, timed once more. `also` (may be empty) gets the same samples.
std::vector<PathRow> rows_of_program(const simulate::SimulatedProgram& program, const machine::Machine& machine,
                                     const feedmodel::JointSampleSink& also = {});

/// The rows from the first cut of `path` to its last one, with some of the way there and back; all where it has none.
std::vector<PathRow> rows_of_cut(std::vector<PathRow> rows, const removal::StampPath& path);

/// Gives each row the loads of the stamps from it to the next row (or, where there is none, of the last one, if the
/// next is the following tooth passing). `loads` and `chatter`: one per stamp, or none.
void add_loads(std::vector<PathRow>& rows, const removal::StampPath& path, std::span<const simulate::StampLoad> loads,
               std::span<const simulate::ChatterMargins::Passage> chatter);

/// Gives the rows the error of greatest magnitude of the surface that their stamps made.
void add_errors(std::vector<PathRow>& rows, const removal::StampPath& path,
                std::span<const removal::SurfacePoint> surface);

/// Gives each cutting row of a changed program how far that program's path lies there from the path of the given
/// program, worked out every half millimetre; what the control does to corners is in neither. Both paths are followed
/// together, so that a neighbouring row of a raster is not taken for the way.
void add_shifts(std::vector<PathRow>& rows, const nc::Interpretation& program, const nc::Interpretation& as_given);

/// Indices, ascending, of at most about `max_rows` rows: of each run of neighbours the first and, for every quantity,
/// those with its least and its greatest value. All where there are no more than `max_rows`.
std::vector<std::size_t> rows_to_draw(std::span<const PathRow> rows, std::size_t max_rows);

}  // namespace camber::report
