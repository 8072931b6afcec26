#pragma once
// Reads from the stock's tiles which chips an undeflected upright cutter takes, block of eight points by block.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/engage/upright/level_faces.h"
#include "removal/engage/upright/stamp_tips.h"
#include "removal/engagement.h"
#include "removal/field/upright/tile_arena.h"
#include "removal/tool_path.h"

namespace camber::removal::upright {

/// Reads the chips of one run of one tool. removal/engagement.h defines depth and chip thickness.
class BlockReader {
 public:
  /// Working memory of one thread; is used again for every stamp.
  struct Buffers {
    std::vector<std::int32_t> blocks;
    std::vector<std::uint32_t> hit_block, hit_deep;
    std::vector<float> hit_thickness;
    std::vector<std::int32_t> lane, cell, hit;
    std::vector<float> cap, thickness, depth;
    std::vector<std::int32_t> blank_point, blank_lane, blank_cell;
    std::vector<float> blank_thickness;
    std::array<std::vector<float>, 3> blank_fraction;
    std::array<std::vector<float>, 3> share;
    std::vector<ChipBlock> chips;
  };

  /// Ids in the stock are first_id + number in `tips`; smaller ids count as blank. Above `top_mm` there is air.
  /// `pitches`: largest number of tooth passings back to the surface of a chip, see RigidEngager.
  BlockReader(const EnvelopeGrid& envelope, const EnvelopeBlocks& blocks, StampTips tips, std::int32_t first_id,
              double voxel_mm, double top_mm, int pitches);

  /// Adds a stamp that the stock may name from now on.
  void append(const Vec3& tip_mm) { tips_.append(tip_mm); }
  const StampTips& tips() const { return tips_; }

  /// Returns the chips of a stamp. `earlier`: stamps of the batch that are not in the tiles yet and may have cut what
  /// this one meets.
  std::span<const ChipBlock> read(const TileArena& arena, const Stamp& stamp, std::span<const std::int32_t> earlier,
                                  Buffers& buffers) const;
  /// Returns the sum of the chip thicknesses in an eighth of the blocks, always the same ones (engage/patch_reading.h).
  double glance(const TileArena& arena, const Stamp& stamp, std::span<const std::int32_t> earlier,
                Buffers& buffers) const;
  /// Returns the same sum from chips that were read.
  double glance_of(std::span<const ChipBlock> chips) const;

 private:
  /// The blocks that glance() reads, with their bounds.
  struct GlancedBlocks {
    std::vector<std::int32_t> block;
    std::vector<float> x, y, z, bottom, reach, nx, ny, nz, spread;
    BlockBounds bounds() const;
  };
  static GlancedBlocks glanced_blocks(const BlockBounds& all);
  StampPlace place_of(const TileArena& arena, const Stamp& stamp) const;
  std::span<const ChipBlock> read_found(const TileArena& arena, const Stamp& stamp, const StampPlace& place, int found,
                                        std::span<const std::int32_t> earlier, Buffers& buffers) const;
  /// A shallow point, or a deep one that stamps not in the arena may have cut.
  struct Point {
    Vec3 place_mm, normal;
  };
  Point point(const Stamp& stamp, int lane) const;
  void make_room(Buffers& b) const;
  void thin_general(const TileArena& arena, const Stamp& stamp, const ShallowPoints& points, float* out) const;
  static Point raised(Point point, float up_mm);
  RingPart part_of_ring(const TileArena& arena, const Stamp& stamp, const ShallowPoints& points, int i) const;
  float thin(const TileArena& arena, int cell, const Point& point) const;
  void thin_by_blank(const TileArena& arena, const ShallowPoints& points, Buffers& b) const;
  float below_blank(const TileArena& arena, const ShallowPoints& points, int i, float up_mm, float thinnest) const;
  float thickness_over(std::span<const std::int32_t> earlier, const Point& point) const;

  const EnvelopeGrid& envelope_;
  const EnvelopeBlocks& blocks_;
  StampTips tips_;
  std::int32_t first_id_;
  double voxel_mm_, top_mm_;
  int pitches_;
  double max_curved_per_mm_ = 0;  ///< largest curvature of the envelope, 1/mm
  GlancedBlocks glanced_;
};

}  // namespace camber::removal::upright
