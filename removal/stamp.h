#pragma once
// A stamp: the cutter at one tooth passing. What passes from the timed path to removal.
#include <cstdint>

#include "base/geometry.h"

namespace camber::removal {

struct Stamp {
  double t_s = 0;
  Vec3 tip_mm = Vec3::Zero();
  Vec3 feed_per_tooth_mm = Vec3::Zero();  ///< motion since the stamp before, one tooth passing earlier
  double share = 0;                       ///< of `move`'s length at which the tip stands, 0 to 1
  bool first = false;                     ///< after a rapid, a dwell or a tool change: no tooth passed just before
  std::uint32_t move = 0;  ///< index into Interpretation::moves, where the tip is (not what is commanded)
};

}  // namespace camber::removal
