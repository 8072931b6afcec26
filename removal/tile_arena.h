#pragma once
// Working copies of all tiles that a stretch of undeflected stamps reaches.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "removal/block_kernels.h"
#include "removal/cutter.h"
#include "removal/slot_map.h"
#include "removal/stamp.h"
#include "removal/stock.h"

namespace camber::removal {

class TileArena {
 public:
  /// Loads what is not air, instead of what was loaded before. Tile 0 is air all over and stands for all others.
  /// `blank`: the stock before the first stamp.
  void load(const Stock& stock, const Stock& blank, const CutterShape& shape, std::span<const Stamp> stamps);

  std::size_t size() const { return count_; }  ///< with tile 0
  const Index3& index(std::size_t tile) const { return index_[tile]; }
  Tile& operator[](std::size_t tile) { return tiles_[tile]; }
  /// Distances of the blank there; null where the blank is solid.
  const float* blank(std::size_t tile) const {
    return blank_[tile] < 0 ? nullptr : blanks_.data() + static_cast<std::size_t>(blank_[tile]) * Tile::kVolume;
  }
  /// The tiles of stamps[k] that are not air.
  std::span<const std::int32_t> reached_by(std::size_t k) const { return reached_[k]; }

  ArenaView view() const;
  /// Of a stamp that moves at most by its feed; see StampPlace::least_mm.
  StampPlace place_of(const Stamp& stamp, double least_mm) const;

 private:
  void list_tiles(const Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps);
  void load_tiles(const Stock& stock, const Stock& blank);

  double voxel_ = 0;
  SlotMap slots_;
  std::vector<std::vector<std::int32_t>> reached_;
  std::vector<Index3> index_;
  std::size_t count_ = 0, room_ = 0;
  std::unique_ptr<Tile[]> tiles_;  ///< not cleared
  std::vector<std::int32_t> blank_;
  std::vector<float> blanks_;
};

}  // namespace camber::removal
