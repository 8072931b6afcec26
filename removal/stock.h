#pragma once
// The stock: a narrow-band signed distance field (OpenVDB), negative inside the material, and for every voxel
// the stamp that set it last; bodies for building a stock (box, cylinder, mesh); points for drawing a stock.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/geometry.h"

namespace camber::removal {

constexpr int kTileVoxels = 16;  ///< along an edge of a tile

/// Voxel or tile coordinates; voxel i stands at i * voxel_mm.
using Index3 = std::array<int, 3>;

struct Tile;  // removal/field/tile.h

class Stock {
 public:
  static constexpr std::int32_t kUncut = -1;

  /// Samples a signed distance (mm, negative inside, 1-Lipschitz) over a box. `band_voxels`: half width of the
  /// narrow band; values are clipped to it. Outside the box is air.
  Stock(const std::function<double(const Vec3&)>& distance_mm, const Vec3& min_mm, const Vec3& max_mm, double voxel_mm,
        double band_voxels);
  /// Reads what save() wrote, with its voxels; the band is widened or narrowed to `band_voxels`. Throws InputError
  /// [file-missing], [vdb-format], [vdb-voxel] (the file's voxels are not voxel_mm wide, or are shifted or turned).
  static Stock load(const std::string& path, double voxel_mm, double band_voxels);
  Stock(const Stock& other);
  Stock& operator=(const Stock&) = delete;
  Stock(Stock&&) noexcept;
  ~Stock();

  double voxel_mm() const { return voxel_mm_; }
  double band_mm() const { return band_mm_; }  ///< largest magnitude of a value
  const Vec3& min_mm() const { return min_mm_; }
  const Vec3& max_mm() const { return max_mm_; }

  /// Trilinear distance at a point, clipped to the band.
  double distance_mm(const Vec3& point) const;
  float voxel(const Index3& index) const;
  std::int32_t stamp(const Index3& index) const;

  /// Fast repeated reading by one thread while the stock is unchanged.
  class Probe {
   public:
    explicit Probe(const Stock& stock);
    Probe(Probe&&) noexcept;
    ~Probe();
    /// The value of the voxel nearest to a point, clipped to the band.
    float nearest(const Vec3& point) const;
    /// See Stock::distance_mm.
    double distance_mm(const Vec3& point) const;

   private:
    struct Access;
    std::unique_ptr<Access> access_;
    double voxel_mm_, per_mm_;
  };

  /// Tiles are numbered so that tile t owns the voxels t * kCore ... t * kCore + kCore - 1. Thread safe.
  void load(const Index3& tile, Tile& out) const;
  /// A cube of side^3 voxels from `first` on, rows along z, then y, then x; `stamp` null: not needed. Thread safe.
  void read(const Index3& first, int side, float* distance, std::int32_t* stamp) const;
  /// False where no stamp has set a voxel of the tile's core. Thread safe.
  bool is_cut(const Index3& tile) const;
  /// True if the tile and its upper layer contain only air. Thread safe.
  bool is_air(const Index3& tile) const;
  /// True where the tile and its upper layer are deeper in material than the band. Thread safe.
  bool is_solid(const Index3& tile) const;
  struct StoredTile {
    Index3 index;
    const Tile* tile;
  };
  /// Writes the cores of tiles back, each once. Not thread safe.
  void store(std::span<const StoredTile> tiles);
  /// Clears all stamp ids: the stock becomes a blank.
  void clear_stamps();
  /// Sets everything to air and frees the memory.
  void clear();
  /// From now on copies share what the stock is at this moment, and each has only what it changes for itself: a copy
  /// takes hardly any memory or time. What is the same along a flat face is kept once. Not thread safe; copies may then
  /// be made and cut by different threads.
  void share();
  /// share(), after which what was shared before and is hidden now takes no memory, unless another copy has it.
  void share_as_one();
  /// A copy for who reads and cuts within a box alone, mm: elsewhere it has what was shared, if anything was. Takes as
  /// long as what of its own the stock has there, and as all of its own where nothing is shared.
  Stock copy_within(const Vec3& min_mm, const Vec3& max_mm) const;
  /// Ends the sharing: the stock takes over what no other copy has, and copies the rest. Not thread safe.
  void unshare();

  /// Volume of material in the box, mm^3 (first-order smeared step over one voxel each way).
  double volume_mm3() const;
  /// Indices of the tiles with a part of the narrow band, in a fixed order.
  std::vector<Index3> surface_tiles() const;
  std::size_t memory_bytes() const;
  /// Writes the distance field (name "stock", level set) as .vdb. Throws InputError [file-unwritable].
  void save(const std::string& path) const;

 private:
  struct Impl;
  Stock(double voxel_mm, double band_mm, const Vec3& min_mm, const Vec3& max_mm, std::unique_ptr<Impl> impl);
  double voxel_mm_, band_mm_;
  Vec3 min_mm_, max_mm_;
  std::unique_ptr<Impl> impl_;
};

/// Fraction of a voxel that is material, from its distance: 1 inside, 0 outside, linear over one voxel each way.
double material_fraction(double distance_mm, double voxel_mm);

/// Signed distance to an upright cylinder, exact. base: centre of its lower face.
double cylinder_distance_mm(const Vec3& point, const Vec3& base_mm, double radius_mm, double height_mm);

/// Signed distance to a box, exact.
double box_distance_mm(const Vec3& point, const Vec3& min_mm, const Vec3& max_mm);

class MeshDistance {
 public:
  /// Reads a binary or ASCII STL (mm) and samples its distance on voxels within band_mm of its surface. Throws
  /// InputError [file-missing], [stl-format], [stl-empty], [stl-open] (an edge without a second triangle: the mesh
  /// has no inside), [voxel-memory] (before anything is built).
  MeshDistance(const std::string& stl_path, double voxel_mm, double band_mm);
  ~MeshDistance();
  MeshDistance(MeshDistance&&) noexcept;

  /// Trilinear, clipped to +-band_mm.
  double distance_mm(const Vec3& point) const;
  const Vec3& min_mm() const { return min_mm_; }
  const Vec3& max_mm() const { return max_mm_; }

 private:
  struct Impl;
  Vec3 min_mm_, max_mm_;
  std::unique_ptr<Impl> impl_;
};

/// Crossing of a grid line with the surface of the stock.
struct StockCrossing {
  Vec3 place_mm;
  Vec3 outward;  ///< along the line: an axis or its opposite
};

struct StockShape {
  double cell_mm = 0;  ///< grid whose points stand at whole multiples of it; a whole number of voxels
  std::vector<StockCrossing> crossings;
};

/// Crossings of the stock's surface with the lines of the finest grid that has no more than `max_crossings`; 1 or
/// more. Each lies where the voxels put it, but for a thousandth of a cell
/// between the two points. Features thinner than a cell between two grid points are missed.
StockShape stock_shape(const Stock& stock, std::size_t max_crossings);

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
  /// The part of `cut` that differs from `before`, in tiles that `reach` meets. `stamps`: of its surface only
  /// what these have set last (half open); not given: all that has a stamp.
  StockPart(const Stock& cut, const Stock& before, const Region& reach,
            std::optional<std::array<std::int32_t, 2>> stamps = {});

  /// The union of several parts; joining it gives what joining them in their order gives.
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
    std::uint64_t first = 0;  ///< index of its first cut voxel in the lists below
  };

  void add_joined(const Index3& tile, std::span<const std::pair<const StockPart*, std::size_t>> parts);

  std::vector<OfTile> tile_;  ///< ascending
  std::vector<float> distance_;
  std::vector<std::int32_t> stamp_;
};

/// Largest difference of two stocks within a band of a voxel about the surface of either, mm, in the tiles that a
/// region meets. Both have the same voxels and box.
double largest_difference_mm(const Stock& a, const Stock& b, const Region& region);

/// Collects the union of parts, equal to StockPart(span) of all of them in the order of adding. Of n parts at most
/// about log2(n) joined ones are in memory, and each part is joined about as often.
class JoinedParts {
 public:
  void add(StockPart part);
  /// All so far; begins anew.
  StockPart take();

 private:
  struct Group {
    StockPart part;
    std::size_t of = 1;  ///< parts in it
  };
  void join_last_two();

  std::vector<Group> groups_;  ///< in order, each of more parts than the next
};

}  // namespace camber::removal
