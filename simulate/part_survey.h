#pragma once
// How the part yields under the tool along a path: linear elasticity on the cells of the stock as it stands at places
// of the path.
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "deflection/part_compliance.h"
#include "machine/job_file.h"
#include "removal/form_error.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::simulate {

/// Compliance of the part at places of a path. Places are kept by the stretch between two rapids and by the share of
/// its stamps, so that they serve a compensated path as well, whose stretches are the same and hardly longer.
struct PartSurvey {
  struct Place {
    std::size_t stretch = 0;  ///< of the run
    double share = 0;         ///< of the stretch's stamps, 0 to 1
    Eigen::MatrixXd mm_per_N;
  };
  struct Run {
    std::size_t stretches = 0;
    std::vector<double> height_mm;  ///< see deflection::PartCompliance
    std::vector<Place> places;      ///< in the order of the path; none: the tool touches nothing there
  };
  std::vector<Run> runs;  ///< of the path; of runs that do not mill without places

  double cell_mm = 0;
  std::size_t cells = 0;   ///< at most
  std::size_t solved = 0;  ///< places
  double compliance_max_um_per_N = 0;
  double seconds = 0;

  /// Returns the part's compliance along a run of a path; nothing where none is to be added there.
  std::optional<deflection::PartCompliance> along(const removal::StampPath& path, std::size_t run) const;
  /// The path has the stretches of the one that was surveyed.
  bool fits(const removal::StampPath& path) const;
};

struct PartSurveyOptions {
  double cell_mm = 1;
  /// A place between two others is solved where the compliance there may be off the line between them by more than this
  /// fraction of it ...
  double tolerance = 0.03;
  double negligible_mm_per_N = 2e-6;  ///< ... or by this
  double apart_mm = 10;               ///< places are no farther apart on the path
};

/// Cells about as wide as the part is thin under its surface, as the job says, or as coarse as the number of cells
/// asks.
double part_cell_mm(const machine::Job& job, const removal::Stock& target,
                    std::span<const removal::SurfacePoint> points);

/// `blank`: the stock before the path, which is swept with undeflected tools. Throws InputError [workpiece-loose] where
/// nothing is held, or a load has nothing elastic to act on.
PartSurvey survey_part(const machine::Job& job, const removal::Stock& blank, const removal::StampPath& path,
                       const PartSurveyOptions& options);

// How thick the part is under its surface.

/// The way through a stock's material from a point of its surface, against the outward normal, mm; `longest_mm` or more
/// where it is longer. Within a voxel of the surface the way is not looked at.
double thickness_mm(const removal::Stock& stock, const Vec3& place_mm, const Vec3& outward, double longest_mm);

/// What a stock is like under a surface.
struct Thickness {
  double thin_mm = 0;            ///< that a twentieth of the area is no thicker than
  Vec3 place_mm = Vec3::Zero();  ///< of a point of about this thickness
  Vec3 outward = Vec3::UnitZ();
};

/// Looks at up to two thousand of the points. Empty where nothing is thinner than `longest_mm`, or there is no point.
std::optional<Thickness> thin_part(const removal::Stock& stock, std::span<const removal::SurfacePoint> points,
                                   double longest_mm);

/// How far a thin part reaches from where it hangs on: the shortest way, along the part and square to `outward`, to
/// where it is twice as thick or ends in the held level `bottom_mm`. Empty where no way leads there.
std::optional<double> reach_mm(const removal::Stock& stock, const Thickness& thin, double bottom_mm, double longest_mm);

}  // namespace camber::simulate
