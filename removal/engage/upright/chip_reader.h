#pragma once
// Reads from the stock's tiles which chips the points of a deflected upright cutter take: the depth of the stock below
// each point, and the bound that the motion sets.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/engage/engaged_path.h"
#include "removal/engage/upright/bend_memory.h"
#include "removal/engage/upright/patch_lanes.h"
#include "removal/engagement.h"
#include "removal/field/cell.h"
#include "removal/field/upright/tile_arena.h"
#include "removal/tool_path.h"

namespace camber::removal::upright {

/// Reads the chips of one stretch. removal/engagement.h defines depth and chip thickness.
class ChipReader {
 public:
  /// A point near the surface: its chip follows from the fields of the stamps around it.
  struct Shallow {
    std::uint32_t point;
    std::uint8_t cut_255;
    float cap_mm, limit_mm;  ///< motion bound; largest depth that counts
    float below_blank_mm;
    CellShare share;    ///< position within its cell
    std::int32_t cell;  ///< number of the cell in the arena
    double up_mm;       ///< height of the judged place above the point
    std::size_t first_pair;
  };
  /// Working memory of one thread; is used again for every stamp.
  struct Buffers {
    std::vector<Shallow> shallow;
    std::size_t pairs = 0;  ///< entries in use of the lists below (PairLanes), which are longer
    std::vector<float> x, y, z, nx, ny, nz, guess_x, guess_y, known, farther, thickness, guess_z;
    std::vector<std::int32_t> row;
  };

  /// `stamps`: those of the stretch. `deflections` is read as it stands at each call; `memory` has the rows of stamps
  /// that were cut.
  ChipReader(const EngagedRun& run, const PatchLanes& lanes, std::span<const Stamp> stamps,
             const DeflectionTable& deflections, const BendMemory& memory);

  /// A stamp that is read.
  struct Reading {
    std::size_t k;       ///< index in the stretch
    bool sharp = false;  ///< the motion bounds the chip sharply: the stamps right before it have yet to cut
  };
  Reading reading_of(std::size_t k, bool sharp = false) const { return {k, sharp}; }

  /// Lists the patches that may take a chip at stamp k.
  void find_patches(const TileArena& arena, const Reading& at, std::vector<std::int32_t>& out) const;
  /// Appends the chips that stamp k takes with the points of these patches. Points that the motion leads into the
  /// material, or that the deflection may, and that lie out of it by less than kNear_mm along the normal, say so by a
  /// negative thickness.
  void read(const TileArena& arena, const Reading& at, std::span<const std::int32_t> patches, Buffers& buffers,
            std::vector<DeflectedChipSample>& out) const;

 private:
  /// Thickness of the stock below a point.
  struct Depth {
    float mm;
    std::array<float, 3> deeper;  ///< derivatives by a deflection along x, y and z
  };
  /// A place and the stock around it.
  struct Place;
  float reach_mm(std::size_t k) const;
  float axial_reach_mm(std::size_t k) const;
  StampBend bend_of(std::size_t k) const;
  void sort_points(const TileArena& arena, const Reading& at, const LaneReading& reading, int first_lane, int count,
                   const StampBend& bend, Buffers& buffers, std::vector<DeflectedChipSample>& out) const;
  bool place_in_ring(const TileArena& arena, float half_mm, float axial_mm, Shallow& point) const;
  static void make_room(Buffers& buffers);
  void add_pairs(const TileArena& arena, const Stamp& stamp, Shallow& point, Buffers& buffers) const;
  float farther_mm(const TileArena& arena, const Shallow& point, const Place& place,
                   const std::array<std::int32_t, 8>& ids, std::int32_t id) const;
  void thin_pairs(Buffers& buffers) const;
  void thin_general(Buffers& buffers) const;
  Depth depth(const TileArena& arena, const Shallow& point, std::size_t end_pair, const Buffers& buffers) const;
  Vec3 normal(std::uint32_t point) const { return {envelope_.nx[point], envelope_.ny[point], envelope_.nz[point]}; }

  const EnvelopeGrid& envelope_;
  const PatchLanes& lanes_;
  PointLanes view_;
  std::span<const Stamp> all_, stamps_;
  std::int32_t first_id_;
  double voxel_mm_;
  const DeflectionTable& deflections_;
  const BendMemory& memory_;
  float node_step_mm_;
  const Kernels& kernels_;
  std::vector<float> wall_half_mm_;  ///< half widths of the rings (removal/engage/upright/level_faces.h)
};

}  // namespace camber::removal::upright
