#pragma once
// What the rules look at, worked out once.
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "checks/height_survey.h"
#include "machine/job_file.h"
#include "machine/tool_proposal.h"
#include "removal/form_error.h"
#include "simulate/predict_path.h"

namespace camber::plausibility {

/// Values with weights.
class Spread {
 public:
  void add(double value, double weight) {
    if (weight > 0) values_.emplace_back(value, weight), sorted_ = false, weight_ += weight;
  }
  bool empty() const { return values_.empty(); }
  double weight() const { return weight_; }
  /// The value below which this fraction of the weight lies.
  double at(double fraction) const;
  double median() const { return at(0.5); }

 private:
  mutable std::vector<std::pair<double, double>> values_;
  mutable bool sorted_ = true;
  double weight_ = 0;
};

/// One tool's work in the program.
struct ToolWork {
  int number = 0;
  const machine::Tool* tool = nullptr;          ///< tool of the job
  const machine::ToolProposal* said = nullptr;  ///< tool in the program's comments; null: not named
  bool mills = false;
  std::uint32_t first_move = 0;  ///< that cuts
  double milling_mm = 0;         ///< length of its milling moves
  double level_mm = 0;           ///< length of this at one height
  double sloping_mm = 0;         ///< length of this in lines that rise or fall by 2 to 80 degrees
  double rising_mm = 0;          ///< rising part of sloping_mm
  std::size_t holes = 0;         ///< moves that make holes
  Spread feed_per_tooth_mm, cutting_speed_m_per_min, spindle_rpm, feed_mm_per_min;  ///< in milling, by length
  checks::MoveCut cut;  ///< sum of its milling moves, where there is a survey
  std::uint32_t deepest_move = 0;
  Spread depth_mm;      ///< height of what each move removes, by length in material
  Spread power_W;       ///< for the chips alone, by length in material
  double plunge_W = 0;  ///< greatest of moves straight down
  std::uint32_t plunge_move = 0;
};

struct Evidence {
  const machine::Job& job;
  const simulate::SimulatedProgram& program;
  std::vector<machine::ToolProposal> said;  ///< tools in the program's comments
  std::vector<ToolWork> tools;              ///< those that cut, ascending
  std::optional<machine::Box> stock;        ///< where it is not a .vdb
  std::optional<checks::HeightSurvey> survey;
  bool elsewhere = false;         ///< path and stock lie apart, or their units do (checks::check_places)
  double specific_force_MPa = 0;  ///< tangential, of chips of 0.1 mm
  std::map<std::string, std::vector<std::string>> assumed;  ///< keys by table (machine/assumptions.h)

  Evidence(const machine::Job& job, const simulate::SimulatedProgram& program);
  /// Evidence of a job whose program is yet to be made: all of its tools.
  explicit Evidence(const machine::Job& job);
  Evidence(const Evidence&) = delete;
  Evidence& operator=(const Evidence&) = delete;

  /// An error, but a warning where one of these keys of [tool.N] or, with `of_stock`, the blank is only assumed: what
  /// nobody gave refuses no program.
  Severity error_of(int tool, std::initializer_list<std::string_view> keys, bool of_stock) const;
  Diagnostic at_job(Severity severity, std::string message, std::string check) const;
  Diagnostic at_move(Severity severity, std::uint32_t move, std::string message, std::string check) const;
};

// How near the cutters of a path come to the part: quick, from places along the path.

/// A cutter as spheres within it that touch its envelope where parts touch it: corner, bottom, wall.
struct CutterSpheres {
  explicit CutterSpheres(const machine::Tool& tool);
  struct Sphere {
    Vec3 centre_mm;  ///< in the tool's frame
    double radius_mm;
  };
  std::vector<Sphere> spheres;
  Vec3 middle_mm = Vec3::Zero();  ///< centre of a ball around all of them
  double reach_mm = 0;
};

/// Signed distance between a cutter and the part, negative where the cutter is in the part.
double clearance_mm(const removal::PartMesh& part, const CutterSpheres& cutter, const ToolPose& pose,
                    const Vec3& part_shift_mm = Vec3::Zero());

struct PartFit {
  struct Place {
    std::uint32_t move = 0;
    ToolPose pose;
    int tool = 0;
    double clearance_mm = 0;
  };
  std::vector<Place> places;       ///< evenly along the milling moves
  double gouge_mm = 0;             ///< deepest, positive
  std::uint32_t gouge_move = 0;    ///< where
  double gouging = 0;              ///< fraction of the places that cut into the part by more than kGouge_mm
  double cutting_in = 0;           ///< by more than kCutIn_mm
  double nearest_mm = 0;           ///< clearance that a hundredth of the places stays below
  std::optional<Vec3> shift_mm{};  ///< shift of the part with which path and part fit; where they do not fit without
};

/// A path may cut into the mesh by as much: chords, stock to leave below zero, rounding.
inline constexpr double kGouge_mm = 0.15;
/// Fraction of the places.
inline constexpr double kGouging = 0.02;

/// Less than a gouge, and too much for a path that only a shift makes fit.
inline constexpr double kCutIn_mm = 0.04;
inline constexpr double kCuttingIn = 0.05;

/// Milling moves of the program against the part's mesh.
PartFit fit_part(const machine::Job& job, const simulate::SimulatedProgram& program, const removal::PartMesh& part);

}  // namespace camber::plausibility
