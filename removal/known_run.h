#pragma once
// What engagement needs of all stamps of a run, found once: a run that is cut in pieces is long, and some of it may not
// be in memory.
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/sparse_list.h"
#include "removal/tool_path.h"

namespace camber::removal {

/// Tips in whole steps of a box, x, y and z, by number.
using TipSteps = std::array<SparseList<std::int32_t>, 3>;

/// A run whose stamps are all upright.
struct KnownRun {
  std::span<const Stamp> stamps;                      ///< by number; those that are not kept may not be read
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();  ///< bounding box of all its tips
  std::shared_ptr<const TipSteps> tips{};             ///< positions of the stamps that are kept

  /// kept: of `stamps`, ascending; what stamps within reach of a piece that is cut have.
  KnownRun(std::span<const Stamp> stamps, const Vec3& min_mm, const Vec3& max_mm, std::span<const ListRange> kept);
  /// A run that is in memory as a whole. Precondition: its stamps are upright.
  explicit KnownRun(std::span<const Stamp> stamps);
};

/// all_upright() of the stamps of a run; `known` (null: nothing is known of them) is of these very stamps.
bool upright_run(std::span<const Stamp> stamps, const KnownRun* known);

/// Whole steps of a box that is min_mm + extent_mm, for vector kernels: a billionth of its size each.
float tip_step_mm(const Vec3& extent_mm);
std::int32_t tip_steps(double tip_mm, double min_mm, float step_mm);

}  // namespace camber::removal
