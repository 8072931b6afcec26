#pragma once
// Engages and carves stamp by stamp for a tool axis of any direction. DeflectedEngager and RigidEngager
// (removal/engagement.h) pass paths that are not upright to this class.
#include <cstddef>
#include <memory>
#include <span>

#include "removal/engage/tilted/chip_reader.h"
#include "removal/engagement.h"

namespace camber::removal::tilted {

/// Does what DeflectedEngager does, for stamps of any pose. With ReadingRule::rigid all rows of the deflections must be
/// 0, and the chips are those that RigidEngager defines.
class Engager {
 public:
  Engager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
          std::int32_t first_id, const ReadingRule& rule);
  ~Engager();

  void remember(std::size_t from, std::span<const float> rows, std::size_t row_size);
  void start(std::size_t from, std::size_t count, const DeflectionTable& deflections);
  std::span<const DeflectedChipSample> read(std::size_t k);
  double glance(std::size_t k);
  double glance_of(std::span<const DeflectedChipSample> chips) const;
  void cut(std::size_t k);
  /// Marks the present stock: go_back() returns to it, within the same stretch.
  void keep();
  void go_back();
  double commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Does what removal::sweep does, for stamps of any pose.
double sweep(Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps, const SweepOptions& options);

}  // namespace camber::removal::tilted
