#include "copymill/felt_hardness.h"

#include <algorithm>
#include <cmath>

namespace camber::copymill {

std::uint64_t FeltHardness::cell(const Vec3& place, int di, int dj) const {
  const auto index = [&](double v, int shift) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(std::lround(v / cell_mm_) + shift));
  };
  return index(place.x(), di) << 32 | index(place.y(), dj);
}

void FeltHardness::feel(const Vec3& chips, double ratio) {
  constexpr double kForget = 0.2;
  const auto [found, first] = ratio_.try_emplace(cell(chips, 0, 0), static_cast<float>(ratio));
  if (first) return;
  const double before = found->second;
  found->second = static_cast<float>(ratio > before ? ratio : before + kForget * (ratio - before));
}

double FeltHardness::at(const Vec3& chips) const {
  double out = 1;
  for (int di = -1; di <= 1; ++di)
    for (int dj = -1; dj <= 1; ++dj)
      if (const auto found = ratio_.find(cell(chips, di, dj)); found != ratio_.end())
        out = std::max(out, static_cast<double>(found->second));
  return out;
}

}  // namespace camber::copymill
