#pragma once
// The undeflected cutter against the stock, batch by batch: the chips of a batch's stamps are read from the tiles as
// they stand, then the batch is cut.
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "removal/chip.h"
#include "removal/cutter.h"
#include "removal/envelope_blocks.h"
#include "removal/stamp.h"
#include "removal/stock.h"

namespace camber::removal {

/// Takes the chips of stamp `from` + k. Called by several threads at once, once for every k, in any order; what the
/// span holds is gone afterwards.
using ChipSink = std::function<void(std::size_t k, std::span<const ChipBlock>)>;

/// For one run of one tool. How depth and chip are defined: removal/stretch.h.
class Engager {
 public:
  /// As removal::Stretch; everything passed must outlive the object. `pitches`: how many tooth passings before a tooth
  /// the last one may be that has left it a chip; even teeth: 1. What the motion in so many allows is told too, with
  /// the thickness, then negative, of the chip after one.
  Engager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
          std::int32_t first_id, int pitches = 1);
  ~Engager();

  const EnvelopeBlocks& blocks() const;
  /// Cuts stamps[from] ... stamps[from + count - 1], which must come after all that were cut before. The stock itself
  /// lags behind: of what an earlier call cut, it gets what these stamps do not reach, of this one nothing.
  void engage(std::size_t from, std::size_t count, const ChipSink& sink);
  /// Writes the rest to the stock. Returns the volume that was taken since the last commit, mm^3.
  double commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::removal
