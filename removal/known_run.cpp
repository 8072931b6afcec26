#include "removal/known_run.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace camber::removal {
namespace {

TipSteps steps_of(std::span<const Stamp> stamps, const Vec3& min_mm, const Vec3& max_mm,
                  std::span<const ListRange> kept) {
  const float step = tip_step_mm(max_mm - min_mm);
  TipSteps out{SparseList<std::int32_t>(stamps.size()), SparseList<std::int32_t>(stamps.size()),
               SparseList<std::int32_t>(stamps.size())};
  for (const ListRange& range : kept)
    for (std::size_t k = range.from; k < range.end; ++k)
      for (int a = 0; a < 3; ++a)
        out[static_cast<std::size_t>(a)].put(k, tip_steps(stamps[k].pose.tip_mm[a], min_mm[a], step));
  return out;
}

}  // namespace

float tip_step_mm(const Vec3& extent_mm) {
  constexpr double kSteps = 1 << 30;
  return static_cast<float>(std::max(1.0, extent_mm.maxCoeff()) / kSteps);
}

std::int32_t tip_steps(double tip_mm, double min_mm, float step_mm) {
  return static_cast<std::int32_t>(std::lround((tip_mm - min_mm) / static_cast<double>(step_mm)));
}

KnownRun::KnownRun(std::span<const Stamp> stamps_, const Vec3& min, const Vec3& max, std::span<const ListRange> kept)
    : stamps(stamps_),
      min_mm(min),
      max_mm(max),
      tips(std::make_shared<const TipSteps>(steps_of(stamps_, min, max, kept))) {}

KnownRun::KnownRun(std::span<const Stamp> stamps_) : stamps(stamps_) {
  assert(all_upright(stamps));
  min_mm = Vec3::Constant(std::numeric_limits<double>::infinity());
  max_mm = -min_mm;
  for (const Stamp& s : stamps) {
    min_mm = min_mm.cwiseMin(s.pose.tip_mm);
    max_mm = max_mm.cwiseMax(s.pose.tip_mm);
  }
  const ListRange all{0, stamps.size()};
  tips = std::make_shared<const TipSteps>(steps_of(stamps, min_mm, max_mm, std::span(&all, 1)));
}

bool upright_run(std::span<const Stamp> stamps, const KnownRun* known) {
  assert(!known || (known->stamps.data() == stamps.data() && known->stamps.size() == stamps.size()));
  return known || all_upright(stamps);
}

}  // namespace camber::removal
