#pragma once
// Level faces of the stock (top of the blank, floor of an earlier pass) divide the rings of a cutter's wall. This file
// finds which part of a ring's width lies in material.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "removal/cutter.h"
#include "removal/engage/upright/stamp_tips.h"
#include "removal/field/blank_edges.h"
#include "removal/field/cell.h"
#include "removal/tool_path.h"

namespace camber::removal::upright {

/// Returns half the width of each upright ring of an envelope, mm; 0 for rings that are not upright.
std::vector<float> wall_half_widths_mm(const EnvelopeGrid& envelope);

/// Place on a ring of the cutter's wall that level faces may divide.
struct RingPlace {
  const BlankCell* blank;    ///< cell of the blank at the point; null: solid
  const std::int32_t* ids;   ///< stamps that the eight voxels of the stock's cell name
  Vec3 point_mm, normal;     ///< point of the envelope and its outward normal
  double half_width_mm = 0;  ///< half the width of the ring
  double axial_mm = 0;       ///< how far along the axis the stamps' floors are displaced
};

/// Part of the ring's width that lies in material, up and down from its point, mm; nothing where from >= to.
struct RingPart {
  double from_mm, to_mm;
  /// Returns the part in 255ths of the ring's width.
  std::uint8_t cut_255(double half_width_mm) const;
  /// Cuts the part by a face at this height; `below`: the material lies below the face.
  void cut_by(double face_mm, bool below) {
    if (below)
      to_mm = std::min(to_mm, face_mm);
    else
      from_mm = std::max(from_mm, face_mm);
  }
  double middle_mm() const { return (from_mm + to_mm) / 2; }
};

/// Returns the part of a ring that lies between the level faces around it: those of the blank, and the floors cut by
/// the stamps that the cell names (index id - first_id in `tips`).
RingPart part_in_material(const RingPlace& ring, const TipView& tips, std::int32_t first_id, const CutterShape& shape);

}  // namespace camber::removal::upright
