#pragma once
// The deflections of one stamp, with bounds that tell where its envelope may be.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "removal/cutter.h"
#include "removal/deflection_table.h"

namespace camber::removal {

/// Deflected envelope of one stamp.
struct StampDeflection {
  static constexpr int kSectors = 32;
  const float* row = nullptr;
  double largest_mm = 0;  ///< bounds the length of every deflection in the row
  /// By the direction from the axis, sector 0 from -pi: bounds how far a deflection moves the envelope outwards there;
  /// negative where it moves inwards at least so far.
  std::array<float, kSectors> outward_mm{};
  double axial_mm = 0;  ///< bounds their axial parts, which count in both of the bounds above
};

/// Bends of the stamps of one table.
class StampDeflections {
 public:
  /// Both must outlive it.
  StampDeflections(const EnvelopeGrid& envelope, const DeflectionTable& deflections);
  StampDeflection of(std::ptrdiff_t stamp) const;

 private:
  const DeflectionTable& deflections_;
  int flutes_, spread_;
  int group_;                         ///< steps taken together: at most a degree
  std::uint32_t spread_sectors_ = 0;  ///< a bit for each sector within spread_ of sector 0
  std::vector<std::uint8_t> centre_;  ///< [node][group][flute]: the sector that the edge passes then
};

}  // namespace camber::removal
