#pragma once
// What some stamps have cut out of a stock, apart from the stock: parts are joined in any grouping.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/geometry.h"
#include "removal/stock.h"
#include "removal/tile_size.h"

namespace camber::removal {

/// A box of space, mm. Empty until something is added.
struct Region {
  Vec3 min_mm = Vec3::Constant(1e300), max_mm = Vec3::Constant(-1e300);

  void add(const Vec3& point) {
    min_mm = min_mm.cwiseMin(point);
    max_mm = max_mm.cwiseMax(point);
  }
  void add(const Region& other) {
    min_mm = min_mm.cwiseMin(other.min_mm);
    max_mm = max_mm.cwiseMax(other.max_mm);
  }
  bool empty() const { return min_mm.x() > max_mm.x(); }
  bool contains(const Vec3& point) const {
    return (point.array() >= min_mm.array()).all() && (point.array() <= max_mm.array()).all();
  }
  Region wider(double by_mm) const { return {min_mm.array() - by_mm, max_mm.array() + by_mm}; }
  /// True where a part of the tile is inside.
  bool meets(const Index3& tile, double voxel_mm) const;
  /// Tiles of a stock that the region meets and that are not air, ascending.
  std::vector<Index3> tiles_of(const Stock& stock) const;
};

/// The voxels that some stamps have cut, tile by tile.
///
/// Carving is a pointwise maximum: a stock joined with the parts that some stretches of a path have cut alone is the
/// one that all of them have cut. Of equal values the first part's stamp is kept, so that parts are joined in the order
/// of the path; the grouping does not matter. Air, where the whole band is cut away, has no stamp.
class StockPart {
 public:
  StockPart() = default;
  /// Of `cut`, which was `before`; both differ in the tiles that `reach` meets alone. `stamps`: of its surface only
  /// what these have set last (half open); not given: all that has a stamp.
  StockPart(const Stock& cut, const Stock& before, const Region& reach,
            std::optional<std::array<std::int32_t, 2>> stamps = {});

  /// What parts have cut together: joining it is as joining them in their order.
  explicit StockPart(std::span<const StockPart* const> parts);

  std::size_t tiles() const { return tile_.size(); }
  std::size_t voxels() const { return distance_.size(); }  ///< with a value of their own
  /// Cuts `stock` where the part is deeper, and where `within`, if given, meets the tile. Without `stamps` joined
  /// voxels count as blank.
  void join_to(Stock& stock, const Region* within = nullptr, bool stamps = true) const;

  /// The tiles that a region meets.
  StockPart within(const Region& region, double voxel_mm) const;

  void write(ByteWriter& out) const;
  /// Throws BytesMissing.
  static StockPart read(ByteReader& in);

 private:
  static constexpr std::size_t kVoxels = kTileVoxels * kTileVoxels * kTileVoxels;
  /// A bit for each voxel of a tile, rows along z, then y, then x.
  struct Mask {
    std::array<std::uint64_t, kVoxels / 64> bits{};
    bool has(std::size_t n) const { return (bits[n / 64] >> (n % 64) & 1u) != 0; }
    void set(std::size_t n) { bits[n / 64] |= std::uint64_t{1} << (n % 64); }
  };
  struct OfTile {
    Index3 index{};
    std::int32_t unused = 0;  ///< no byte of a file is left to chance
    Mask cut, air;
    std::uint64_t first = 0;  ///< of its cut voxels in the lists below
  };

  void add_joined(const Index3& tile, std::span<const std::pair<const StockPart*, std::size_t>> parts);

  std::vector<OfTile> tile_;  ///< ascending
  std::vector<float> distance_;
  std::vector<std::int32_t> stamp_;
};

/// Largest difference of two stocks within a band of a voxel about the surface of either, mm, in the tiles that a
/// region meets. Both have the same voxels and box.
double largest_difference_mm(const Stock& a, const Stock& b, const Region& region);

}  // namespace camber::removal
