#pragma once
// What has to be removed: blank minus part, as cells and holes.
#include <functional>
#include <utility>
#include <vector>

#include "plan/cell_grid.h"

namespace camber::plan {

struct RemovalInput {
  Solid blank{}, part{};
  /// Holes of a part that comes with its holes filled.
  std::vector<Hole> part_holes{};
  std::vector<Solid> fixtures{};
  FaceOptions faces{};
  /// Planes of a blank that comes as heights only.
  std::array<std::vector<AxisPlane>, 3> blank_planes{};
  /// Smallest thickness of a cell, mm; thinner ones do not count. At least the tolerance of the planes.
  double tolerance_mm = 0.01;
  /// Diameter of the smallest mill; 0: there is none, and everything is divided.
  double narrowest_mm = 0;
  /// Whether earlier set-ups have machined a place, and the planes of what they have.
  std::function<bool(const Vec3&)> machined{};
  std::array<std::vector<AxisPlane>, 3> machined_planes{};
};

struct RemovalVolume {
  explicit RemovalVolume(CellGrid cells) : grid(std::move(cells)) {}

  CellGrid grid;
  std::vector<Hole> holes;  ///< those that the blank does not have yet; volumes are what the blank has there
  std::vector<InnerCorner> corners;
  double blank_mm3 = 0, part_mm3 = 0;
  double cells_mm3 = 0, holes_mm3 = 0;  ///< to be removed
  double outside_mm3 = 0;               ///< volume of the part where there is no blank
  double free_form_mm2 = 0;
  Bounds blank_bounds;
  Solid stays;              ///< part with its holes filled, and fixtures
  double narrowest_mm = 0;  ///< see RemovalInput

  double removal_mm3() const { return blank_mm3 - part_mm3; }
  /// (cells + holes) / removal - 1.
  double balance() const;
};

/// Planes are those of the faces of part and blank; short walls do not divide into slivers narrower than
/// `narrowest_mm`. Holes are taken out of the part first and the rest is divided as if
/// they were not there.
RemovalVolume removal_volume(const RemovalInput& input);

}  // namespace camber::plan
