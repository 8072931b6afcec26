#pragma once
// Cutting force, deflection and form error of a job.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camber/feed.h"
#include "camber/job.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

/// Weighted by area.
struct ErrorFigures {
  double min = 0, max = 0, mean = 0, rms = 0;
  double p95 = 0;  ///< 95th percentile of the magnitude
  double area_mm2 = 0;
};

/// A row of forces.csv: one spindle revolution or one block, whichever is shorter. Forces act on the tool, in the axes
/// of the part, which are the machine's where nothing turns it.
struct ForceRow {
  double t_s = 0;
  double x_mm = 0, y_mm = 0, z_mm = 0;              ///< tool tip at the first tooth passing of the row
  double fx_max_N = 0, fy_max_N = 0, fz_max_N = 0;  ///< signed values of maximum magnitude
  double f_max_N = 0;                               ///< largest force across the tool
  double fx_mean_N = 0, fy_mean_N = 0, fz_mean_N = 0;
  double dx_um = 0, dy_um = 0,
         dz_um = 0;  ///< deflection at the height of the contact, at the instant at which an edge passes it
  double mrr_mm3_per_s = 0, removed_mm3 = 0;
  double torque_max_Nm = 0, torque_mean_Nm = 0, power_W = 0;
  double h_max_mm = 0, h_mean_mm = 0;  ///< uncut chip thickness
  double specific_energy_MPa = 0;
  std::int64_t block = 0;     ///< 1-based line
  double f_axial_max_N = 0;   ///< along the tool, towards the spindle; signed, of maximum magnitude
  bool valid = true;          ///< the model holds in all of the row's tooth passings
  double chatter_margin = 0;  ///< depth over critical depth, the greatest of the row; above 1 the cut is unstable
  double chatter_hz = 0;      ///< frequency that is heard at its border
};

/// A row of form_error.csv: a point of the nominal surface.
struct ErrorPoint {
  double x_mm = 0, y_mm = 0, z_mm = 0, nx = 0, ny = 0, nz = 0;
  double error_um = 0;        ///< machined minus nominal surface, along the normal; positive: excess material
  double deflection_um = 0;   ///< part due to the deflection of tool and workpiece
  double contour_um = 0;      ///< part due to servo lag and corner rounding
  double total_error_um = 0;  ///< against the part's mesh; NaN without one
  double model_error_um = 0;  ///< with PredictOptions::trace: the feed model's error_um; else NaN
  double area_mm2 = 0;        ///< represented by the point
  std::int64_t block = 0;     ///< 1-based line that generated the surface here; 0: unknown
  std::int64_t tool = 0;      ///< 0: unknown
  bool valid = true;          ///< the model holds here; figures are of valid points
  double tool_deflection_um = 0, part_deflection_um = 0;  ///< parts of deflection_um; a rigid workpiece has none of it
};

/// A row of spindle_load.csv: the heaviest turn of the spindle in a line, for cutting alone.
struct SpindleLoadRow {
  std::int64_t tool = 0, line = 0;
  double power_W = 0, torque_Nm = 0;  ///< means over that turn
};

/// A vertex of a mesh.
struct MeshPoint {
  double x_mm = 0, y_mm = 0, z_mm = 0, nx = 0, ny = 0, nz = 0;
  double error_um = 0, deflection_um = 0, contour_um = 0;  ///< values of largest magnitude near it; machined part: zero
  std::int64_t block = 0;                                  ///< line that made the surface here; 0: unknown
};

/// Three points, counter-clockwise as seen from outside.
struct MeshTriangle {
  std::int64_t a = 0, b = 0, c = 0;
};

struct Mesh {
  std::vector<MeshPoint> points{};
  std::vector<MeshTriangle> triangles{};
};

struct PredictOptions {
  bool feed = false;            ///< also fill PredictResult::feed
  std::string output_folder{};  ///< also write the files of `camber predict` to this folder; empty: none
  std::size_t forces_at =
      0;  ///< with output_folder: line for which the forces over one revolution are written; 0: none
  /// Servo trace of the job's program: cuts where it measured the axes, not where the feed model has them. Empty: none.
  std::string trace{};
  std::string columns{};  ///< column map of the trace, as of `camber fit-feed --columns`; empty: none
  bool meshes = false;    ///< also fill the meshes of the result, and write them where there is an output_folder
  bool rows = true;       ///< fill the vectors and meshes of the result; else its figures alone
  std::string stock{};    ///< file: the machined stock; empty: none
  bool explain = false;   ///< PredictResult::printed also says how uncertain the margins of chatter are
  bool throw_if_unwritten = true;  ///< else PredictResult::unwritten says what of output_folder could not be written
};

/// Prediction of the feed model beside the measured motion of PredictOptions::trace.
struct TraceComparison {
  bool by_line = false;  ///< samples were matched by the line column; else by place
  std::int64_t samples = 0;
  double period_s = 0;
  double machine_time_s = 0;                        ///< by the feed model; PredictResult has the trace's
  double off_path_p95_um = 0, off_path_max_um = 0;  ///< distance of the axes from the programmed path in the cut
  ErrorFigures form_error_um{}, difference_um{};    ///< the feed model's; the trace's minus the feed model's
};

struct PredictResult {
  double machine_time_s = 0, cutting_time_s = 0;
  double force_max_N = 0;               ///< largest lateral force
  double chips_mm3 = 0, stock_mm3 = 0;  ///< removed volume, from the chips and from the stock
  ErrorFigures form_error_um{}, deflection_um{}, contour_um{};
  ErrorFigures tool_deflection_um{}, part_deflection_um{};  ///< parts of deflection_um
  double unseen_mm2 = 0;                                    ///< area of the nominal surface without a point
  std::optional<TraceComparison> trace{};
  std::vector<ForceRow> forces{};
  std::vector<ErrorPoint> form_error{};
  std::vector<FeedPoint> feed{};               ///< empty unless asked for
  std::vector<std::string> doubts{};           ///< reasons why the figures are not reliable; empty: none
  std::vector<Diagnostic> diagnostics{};       ///< warnings
  std::string json{};                          ///< all figures, as `camber predict --json` writes them
  std::string printed{};                       ///< the same, as `camber predict` prints them
  std::vector<Diagnostic> unwritten{};         ///< see PredictOptions::throw_if_unwritten
  std::vector<SpindleLoadRow> spindle_load{};  ///< by tool, then by line
  Mesh error_mesh{};                           ///< the surface with its form error; empty unless PredictOptions::meshes
  Mesh machined_mesh{};                        ///< the closed surface of the machined part; the same
};

/// If the figures are beyond the model or did not converge, `doubts` says so (exit status 3 on the command line).
/// Throws InputError, Cancelled.
CAMBER_API PredictResult predict(const Job& job, const PredictOptions& options = {}, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
