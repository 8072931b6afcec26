#pragma once
// Engagement and carving stamp by stamp for a cutter whose axis points anywhere: what DeflectedEngager and RigidEngager
// (removal/engagement.h) do for paths that are not upright.
#include <cstddef>
#include <memory>
#include <span>

#include "removal/engage/tilted/chip_reader.h"
#include "removal/engagement.h"

namespace camber::removal::tilted {

/// As DeflectedEngager, with stamps of any pose. Rigid: rows of the deflections must be 0, and chips are as those of
/// RigidEngager.
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
  /// From here on go_back() leaves the stock as it is now; until the next call, within one stretch.
  void keep();
  void go_back();
  double commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// As removal::sweep, with stamps of any pose.
double sweep(Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps, const SweepOptions& options);

}  // namespace camber::removal::tilted
