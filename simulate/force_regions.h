#pragma once
// Parts of the material that are harder or softer than the rest: what a tool feels there and no model knows.
#include <string>
#include <vector>

#include "base/geometry.h"

namespace camber::simulate {

struct ForceRegion {
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();
  double factor = 1;  ///< of the force on every edge in this box
};

class ForceRegions {
 public:
  static constexpr double kLeastFactor = 0.1, kGreatestFactor = 10;

  ForceRegions() = default;
  /// Where boxes overlap, the later one counts.
  explicit ForceRegions(std::vector<ForceRegion> regions) : regions_(std::move(regions)) {}

  bool none() const { return regions_.empty(); }
  /// True where a box meets one of the regions.
  bool meet(const Vec3& min_mm, const Vec3& max_mm) const;
  double factor_at(const Vec3& place_mm) const;

 private:
  std::vector<ForceRegion> regions_;
};

/// A table x_min,y_min,z_min,x_max,y_max,z_max,factor with that header, in mm. Throws InputError: [regions-column],
/// [regions-number], [regions-box] (a box without an inside), [regions-factor] (not 0.1 to 10), [regions-empty].
ForceRegions read_force_regions(const std::string& path);

}  // namespace camber::simulate
