#pragma once
// Engages and carves stamp by stamp for a tool axis of any direction, deflected or rigid.
#include <cstddef>
#include <memory>
#include <span>

#include "removal/engage/engaged_path.h"
#include "removal/engage/tilted/chip_reader.h"
#include "removal/engagement.h"

namespace camber::removal::tilted {

/// With ReadingRule::rigid all rows of the deflections must be 0, and the chips are those that RigidEngager defines.
class Engager : public DeflectedPath {
 public:
  Engager(const EngagedRun& run, const ReadingRule& rule);
  ~Engager() override;

  void remember(std::size_t from, std::span<const float> rows, std::size_t row_size, double largest_mm) override;
  void start(std::size_t from, std::size_t count, const DeflectionTable& deflections) override;
  std::span<const DeflectedChipSample> read(std::size_t k) override;
  std::span<const double> glance(std::size_t k, std::size_t count) override;
  double glance_of(std::span<const DeflectedChipSample> chips) const override;
  void cut(std::size_t k, std::size_t count) override;
  double commit() override;
  /// Marks the present stock: go_back() returns to it, within the same stretch.
  void keep();
  void go_back();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Does what removal::sweep does, for stamps of any pose.
double sweep(Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps, const SweepOptions& options);

}  // namespace camber::removal::tilted
