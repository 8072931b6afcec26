#pragma once
// The stock: a narrow-band signed distance field (OpenVDB), negative inside the material, and for every voxel
// the stamp that set it last.
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/geometry.h"

namespace camber::removal {

/// Voxel or tile coordinates; voxel i stands at i * voxel_mm.
using Index3 = std::array<int, 3>;

/// A dense working copy of a cube of voxels: `kCore` a side that the tile owns and one layer above (towards
/// +x, +y, +z) of its neighbours', so that every trilinear cell of the core is whole.
struct Tile {
  static constexpr int kCore = 16;
  static constexpr int kSide = kCore + 1;
  static constexpr int kVolume = kSide * kSide * kSide;
  std::array<float, kVolume> distance;
  std::array<std::int32_t, kVolume> stamp;  ///< -1: not cut

  static constexpr int offset(int i, int j, int k) { return (i * kSide + j) * kSide + k; }
};

class Stock {
 public:
  static constexpr std::int32_t kUncut = -1;

  /// Samples a signed distance (mm, negative inside, 1-Lipschitz) over a box. `band_voxels`: half width of the
  /// narrow band; values beyond it are cut off. Outside the box there is air.
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

  /// Many readings by one thread, while the stock stays as it is.
  class Probe {
   public:
    explicit Probe(const Stock& stock);
    Probe(Probe&&) noexcept;
    ~Probe();
    /// The value of the voxel nearest to a point, clipped to the band.
    float nearest(const Vec3& point) const;
    /// As Stock::distance_mm.
    double distance_mm(const Vec3& point) const;

   private:
    struct Access;
    std::unique_ptr<Access> access_;
    double voxel_mm_, per_mm_;
  };

  /// Tiles are numbered so that tile t owns the voxels t * kCore ... t * kCore + kCore - 1. Thread safe.
  void load(const Index3& tile, Tile& out) const;
  /// A cube of side^3 voxels from `first` on, rows along z, then y, then x; `stamp` null where not wanted. Thread safe.
  void read(const Index3& first, int side, float* distance, std::int32_t* stamp) const;
  /// False where no stamp has set a voxel of the tile's core. Thread safe.
  bool is_cut(const Index3& tile) const;
  /// True where the tile and its upper layer hold nothing but air. Thread safe.
  bool is_air(const Index3& tile) const;
  /// True where the tile and its upper layer are deeper in material than the band. Thread safe.
  bool is_solid(const Index3& tile) const;
  struct StoredTile {
    Index3 index;
    const Tile* tile;
  };
  /// Writes the cores of tiles back, each once. Not thread safe.
  void store(std::span<const StoredTile> tiles);
  /// Forgets which stamps cut what: the stock is a blank.
  void clear_stamps();
  /// Leaves air everywhere, and gives the memory back.
  void clear();

  /// Volume of material in the box, mm^3 (first-order smeared step over one voxel each way).
  double volume_mm3() const;
  /// Coordinates of tiles that hold a part of the narrow band, in a fixed order.
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

/// Share of a voxel that is material, from its distance: 1 inside, 0 outside, linear over one voxel each way.
double material_share(double distance_mm, double voxel_mm);

/// Signed distance to an upright cylinder, exact. base: middle of its lower face.
double cylinder_distance_mm(const Vec3& point, const Vec3& base_mm, double radius_mm, double height_mm);

/// Signed distance to a box, exact.
double box_distance_mm(const Vec3& point, const Vec3& min_mm, const Vec3& max_mm);

}  // namespace camber::removal
