#pragma once
// Space cut into cells by the planes of the removal volume's faces, with exact volumes in each cell.
#include <array>
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

struct Cell {
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
  Cell& at(const CellIndex& c) { return cells_[place(c)]; }
  const Cell& at(const CellIndex& c) const { return cells_[place(c)]; }
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
  void add(const Solid& solid, double Cell::*field, double Cell::*free_form = nullptr,
           double Cell::*overhang = nullptr);
  /// Sets the kinds. What is thinner than `tolerance_mm` over a cell's faces does not count; of a free-form surface,
  /// which a cell may hold a small part of, what is thinner over that part.
  void classify(double tolerance_mm);

 private:
  template <class Function>
  void each(Function f);
  double faces_mm2(const CellIndex& c) const { return face_mm2(c, 0) + face_mm2(c, 1) + face_mm2(c, 2); }
  void join_skins();

  std::array<std::vector<AxisPlane>, 3> planes_;
  std::vector<Cell> cells_;
};

}  // namespace camber::plan
