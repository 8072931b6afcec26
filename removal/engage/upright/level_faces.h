#pragma once
// Level faces of the stock across a cutter's wall: which share of the width that a sampled point stands for they leave
// in material.
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

/// Half the widths of an envelope's rings that stand upright, mm; 0 for the others.
std::vector<float> wall_half_widths_mm(const EnvelopeGrid& envelope);

/// Where a ring of the cutter's wall may be cut in two by level faces.
struct RingPlace {
  const BlankCell* blank;    ///< at the point; null: solid
  const std::int32_t* ids;   ///< the same of the stamps that the stock's voxels name
  Vec3 point_mm, normal;     ///< of the envelope
  double half_width_mm = 0;  ///< of the ring
  double axial_mm = 0;       ///< how far along the axis the stamps' floors are displaced
};

/// Part of the ring's width that lies in material, up and down from its point, mm; nothing where from >= to.
struct RingPart {
  double from_mm, to_mm;
  /// In 255ths of the ring's width.
  std::uint8_t cut_255(double half_width_mm) const;
  /// By a face at a height, below which the material lies or above it.
  void cut_by(double face_mm, bool below) {
    if (below)
      to_mm = std::min(to_mm, face_mm);
    else
      from_mm = std::max(from_mm, face_mm);
  }
  double middle_mm() const { return (from_mm + to_mm) / 2; }
};

/// Level faces are the blank's, and the floors cut by the stamps that the cell names: id - first_id of `tips`.
RingPart part_in_material(const RingPlace& ring, const TipView& tips, std::int32_t first_id, const CutterShape& shape);

}  // namespace camber::removal::upright
