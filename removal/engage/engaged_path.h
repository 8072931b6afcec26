#pragma once
// The two implementations behind an engager (removal/engagement.h): engage/upright/ for paths whose tools are upright,
// engage/tilted/ for all others.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "removal/engagement.h"

namespace camber::removal {

/// One run of one tool. Everything that it names must outlive what is made from it.
struct EngagedRun {
  Stock& stock;
  const Stock& blank;
  const EnvelopeGrid& envelope;
  std::span<const Stamp> stamps;
  std::int32_t first_id;
  const KnownRun* known = nullptr;  ///< run that the stamps belong to, where they are one run
};

/// True where the glance at k lies on the line between those at a and b.
inline bool on_line_of_glances(std::span<const double> glances, std::size_t a, std::size_t k, std::size_t b) {
  constexpr double kMaterialChange = 0.06;
  const double way = static_cast<double>(k - a) / static_cast<double>(b - a);
  const double expected = (1 - way) * glances[a] + way * glances[b];
  return expected > 0 && std::abs(glances[k] - expected) <= kMaterialChange * expected;
}

/// Does what RigidEngager says.
class RigidPath {
 public:
  virtual ~RigidPath() = default;
  virtual void engage(std::size_t from, std::size_t count, const ChipSink& sink) = 0;
  virtual void engage(std::size_t from, std::size_t count, const SparseChipSink& sink) = 0;
  virtual double commit() = 0;
};

/// Does what DeflectedEngager says.
class DeflectedPath {
 public:
  virtual ~DeflectedPath() = default;
  virtual void remember(std::size_t from, std::span<const float> rows, std::size_t row_size, double largest_mm) = 0;
  virtual void start(std::size_t from, std::size_t count, const DeflectionTable& deflections) = 0;
  virtual std::span<const DeflectedChipSample> read(std::size_t k) = 0;
  virtual std::span<const double> glance(std::size_t k, std::size_t count) = 0;
  virtual double glance_of(std::span<const DeflectedChipSample> chips) const = 0;
  virtual void cut(std::size_t k, std::size_t count) = 0;
  virtual double commit() = 0;
};

namespace upright {
std::unique_ptr<RigidPath> rigid_path(const EngagedRun& run, const EnvelopeBlocks& blocks, int pitches);
std::unique_ptr<DeflectedPath> deflected_path(const EngagedRun& run);
}  // namespace upright

namespace tilted {
std::unique_ptr<RigidPath> rigid_path(const EngagedRun& run, const EnvelopeBlocks& blocks, int pitches);
std::unique_ptr<DeflectedPath> deflected_path(const EngagedRun& run);
}  // namespace tilted

}  // namespace camber::removal
