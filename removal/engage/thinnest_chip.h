#pragma once
// The thickness below which a chip of rigid coupling counts as none.

namespace camber::removal {

/// Rigid coupling: chips that are no thicker count as none, mm. An axis under a position loop comes to rest like e^-t:
/// a flat bottom then goes down by less and less, and, far below what a field resolves, would carry the edge force of
/// its whole length for as long as a double still falls. No scale of a machine shows ten nanometres a tooth.
constexpr float kThinnestChip_mm = 1e-5f;

}  // namespace camber::removal
