#pragma once
// Features of a part as a measuring machine reports them: [[feature]] of a job, and tables of measured values.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"

namespace camber::machine {

class TomlTable;

enum class FeatureKind { plane, bore, boss, slot_width, distance, wall, points };
inline constexpr std::array<std::string_view, 7> kFeatureKindWords{"plane",    "bore", "boss",  "slot_width",
                                                                   "distance", "wall", "points"};

/// How the instrument fits its points. plane, wall, points: least_squares and min_zone alone.
enum class FeatureFilter { least_squares, max_inscribed, min_circumscribed, min_zone };
inline constexpr std::array<std::string_view, 4> kFeatureFilterWords{"least_squares", "max_inscribed",
                                                                     "min_circumscribed", "min_zone"};

/// One value as the measuring machine reports it.
struct MeasuredValue {
  std::string feature;
  std::string part;  ///< serial number; empty: not told
  std::string date;  ///< as written, ISO 8601; empty: not told
  double value_mm = 0;
  std::optional<double> nominal_mm{}, lower_mm{}, upper_mm{};  ///< limits are absolute
  std::string kind{}, status{};                                ///< words of a QIF file: "Diameter", "PASS"
};

/// A feature of the part. Places are in the frame of the program.
///
///   plane        axis_mm[0]: the datum point; axis_mm[1]: on the plane. The outward normal is along the axis, the size
///                the distance of the plane from the datum point.
///   bore, boss   two points on the axis, top first where there is a depth; the size is the diameter.
///   slot_width   middle line of the slot from end to end, across the tool; the size is the width.
///   distance     of the middles of two other features (`of`), or of the surfaces at two points that face along the
///                line through them.
///   wall         two points on opposite faces; the size is the thickness.
///   points       places on the surface (points_mm); the size is the mean distance from it, nominal 0.
struct Feature {
  std::string name;
  FeatureKind kind = FeatureKind::bore;
  std::array<Vec3, 2> axis_mm{Vec3::Zero(), Vec3::Zero()};
  std::vector<Vec3> points_mm;
  std::array<std::string, 2> of;  ///< distance: names of the features; empty: axis_mm
  double nominal_mm = 0;
  std::optional<std::array<double, 2>> tol_mm;   ///< limits as deviations from the nominal size
  std::optional<double> depth_mm;                ///< below axis_mm[0], where it was measured; not given: all along
  std::optional<std::array<double, 2>> arc_rad;  ///< bore, boss: part of the circle, counter-clockwise from +X
  double extent_mm = 0;  ///< plane, wall, distance: radius about the axis that is probed; 0: all of the face
  int points = 0;        ///< number of points that the instrument takes; 0: every point of the predicted surface
  FeatureFilter filter = FeatureFilter::least_squares;
  std::optional<int> tool;  ///< that made the feature; not given: any
  bool align = false;       ///< the part is aligned by this feature before positions are judged
  std::vector<double> measured_mm;
  std::vector<MeasuredValue> measured;  ///< measured_mm as well, without a part

  /// Change of the size with the diameter of the tool that made it.
  double size_per_diameter() const;
};

/// [model_error]: standard errors of the model's predictions, as camber fit-parts tells them.
struct ModelError {
  double deflection = 0;  ///< relative, of forces times compliance
  double contour = 0;     ///< relative, of servo lag and corners
  double size_mm = 0;     ///< standard error of the diameter of a tool in its holder
};
std::optional<ModelError> read_model_error(TomlTable& top);

/// [[feature]] tables. Paths of `measured` count from `folder`. Problems go to the table's diagnostics.
std::vector<Feature> read_features(TomlTable& top, const std::filesystem::path& folder);

/// Mean of what was measured; nothing where nothing was. `part`: of this part alone; empty: of all.
std::optional<double> measured_mean_mm(const Feature& feature, const std::string& part = {});

/// Text of [[feature]] tables, with the measured values in place of tables, and of [model_error].
std::string features_text(const std::vector<Feature>& features, const std::optional<ModelError>& error);

}  // namespace camber::machine
