#pragma once
// Chips of one stamp.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"

namespace camber::removal {

class EnvelopeBlocks;

/// What one envelope point takes at one stamp.
struct Chip {
  std::uint32_t point = 0;     ///< index into EnvelopeGrid
  float thickness_mm = 0;      ///< uncut, along the envelope normal, > 0
  bool after_tooth = false;    ///< bounded below by what the tooth before left, not by older surface
  bool own_surface = false;    ///< an older surface that the same tool cut
  std::uint8_t cut_255 = 255;  ///< how much of the ring's width is in the cut, in 255ths
  double width_share() const { return cut_255 / 255.0; }
};

/// The same of the points of a block (removal/envelope_blocks.h).
struct ChipBlock {
  std::uint32_t block = 0;
  std::uint16_t after_tooth = 0, own_surface = 0;  ///< a bit a point
  /// 0: no chip; negative: no chip, the material lies that far outwards along the normal
  std::array<float, 8> thickness_mm{};
  std::array<std::uint8_t, 8> cut_255{};
};

std::vector<Chip> chips_of(const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips);

/// Volume that the chips of one stamp hold, mm^3: sum of (h - H h^2 + K h^3 / 3) dA, with the mean and Gaussian
/// curvature of the envelope. Source: parallel surfaces (Steiner).
double chip_volume_mm3(const EnvelopeGrid& envelope, std::span<const Chip> chips);
double chip_volume_mm3(const EnvelopeGrid& envelope, const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips);

}  // namespace camber::removal
