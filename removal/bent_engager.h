#pragma once
// The bent cutter against the stock, stamp by stamp: the chips that a stamp takes with the bend it has, as often as its
// bend changes, then its cut.
#include <cstdint>
#include <memory>
#include <span>

#include "removal/chip_reader.h"
#include "removal/cutter.h"
#include "removal/shift_table.h"
#include "removal/stamp.h"
#include "removal/stock.h"

namespace camber::removal {

/// For one run of one tool. How depth and chip are defined: removal/stretch.h. No result depends on the number of
/// threads.
class BentEngager {
 public:
  /// No cutter may be bent farther.
  static constexpr double kMostBent_mm = 0.5;

  /// `blank`: the stock before stamps[0]. Ids in the stock are first_id + index; smaller ids count as blank. The
  /// envelope has patches. Everything passed must outlive the object.
  BentEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
              std::int32_t first_id);
  ~BentEngager();

  /// Begins with stamps[from] ... stamps[from + count - 1], which must come after all that were cut before. Row k of
  /// `shifts` is that of stamps[from + k]; it is read when its stamp and the next one are.
  void start(std::size_t from, std::size_t count, const ShiftTable& shifts);
  /// Chips that stamps[from + k] takes, its predecessors being cut. Points less than kNear_mm out of the material are
  /// among them, with a negative thickness. Gone at the next call.
  std::span<const BentChip> read(std::size_t k);
  void cut(std::size_t k);
  /// Writes what was cut to the stock. Returns the volume that was taken since the last commit, mm^3.
  double commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::removal
