#pragma once
// What has to be removed: blank minus part, as holes and as cells between the planes of the faces.
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "plan/faces.h"

namespace camber::plan {

enum class CellKind : unsigned char {
  air,        ///< nothing is there, and nothing is to be removed
  part,       ///< what is there stays
  clear,      ///< everything in it is to be removed
  contoured,  ///< a part of it stays; all faces there are upright or along the axes
  free_form,  ///< a part of it stays, with a free-form face; or the end of a free-form skin of the blank
  fixture     ///< the tool may not go there
};

struct GridCell {
  double blank_mm3 = 0, part_mm3 = 0, fixture_mm3 = 0;
  double free_form_mm2 = 0;        ///< area of the part's faces in it
  double overhang_mm2 = 0;         ///< area of these that looks down
  double blank_free_form_mm2 = 0;  ///< area of the blank's faces in it
  CellKind kind = CellKind::air;
  double removal_mm3() const { return blank_mm3 > part_mm3 ? blank_mm3 - part_mm3 : 0; }
};

struct CellIndex {
  int x = 0, y = 0, z = 0;
  bool operator==(const CellIndex&) const = default;
  auto operator<=>(const CellIndex&) const = default;
};

class CellGrid {
 public:
  /// Planes of an axis: ascending, two or more.
  explicit CellGrid(std::array<std::vector<AxisPlane>, 3> planes);

  /// Number of cells along an axis.
  int count(int axis) const { return static_cast<int>(planes_[static_cast<std::size_t>(axis)].size()) - 1; }
  double plane_mm(int axis, int i) const { return plane(axis, i).at_mm; }
  const AxisPlane& plane(int axis, int i) const {
    return planes_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)];
  }
  bool holds(const CellIndex& c) const;
  GridCell& at(const CellIndex& c) { return cells_[place(c)]; }
  const GridCell& at(const CellIndex& c) const { return cells_[place(c)]; }
  std::size_t place(const CellIndex& c) const;
  std::size_t size() const { return cells_.size(); }
  Vec3 low_mm(const CellIndex& c) const { return {plane_mm(0, c.x), plane_mm(1, c.y), plane_mm(2, c.z)}; }
  Vec3 high_mm(const CellIndex& c) const { return {plane_mm(0, c.x + 1), plane_mm(1, c.y + 1), plane_mm(2, c.z + 1)}; }
  double volume_mm3(const CellIndex& c) const;
  /// Number of the cell along an axis that a coordinate lies in; -1 or count(axis) beyond the ends.
  int cell_of(int axis, double at_mm) const;
  double face_mm2(const CellIndex& c, int axis) const;

  /// Adds the volume of a solid in each cell to `field`, exactly: each triangle is clipped to the cells' columns, and
  /// the space under it counts. Where given also the areas of free-form faces, and of those that look down.
  void add(const TriangleSolid& solid, double GridCell::*field, double GridCell::*free_form = nullptr,
           double GridCell::*overhang = nullptr);
  /// Sets the kinds. What is thinner than `tolerance_mm` over a cell's faces does not count; of a free-form surface,
  /// which a cell may hold a small part of, what is thinner over that part.
  void classify(double tolerance_mm);

 private:
  template <class Function>
  void each(Function f);
  double faces_mm2(const CellIndex& c) const { return face_mm2(c, 0) + face_mm2(c, 1) + face_mm2(c, 2); }
  void join_skins();

  std::array<std::vector<AxisPlane>, 3> planes_;
  std::vector<GridCell> cells_;
};

struct RemovalInput {
  TriangleSolid blank{}, part{};
  /// Holes of a part that comes with its holes filled.
  std::vector<Hole> part_holes{};
  std::vector<TriangleSolid> fixtures{};
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
  SolidBounds blank_bounds;
  TriangleSolid stays;      ///< part with its holes filled, and fixtures
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
