#pragma once
// Which chips a stamp of the undeflected cutter takes from the tiles as they stand.
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

/// For one run of one tool. Definitions of depth and chip thickness: removal/engagement.h.
class BlockReader {
 public:
  /// What one thread needs; may be used for stamp after stamp.
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
  /// `pitches`: motion in so many may make a chip, see RigidEngager.
  BlockReader(const EnvelopeGrid& envelope, const EnvelopeBlocks& blocks, StampTips tips, std::int32_t first_id,
              double voxel_mm, double top_mm, int pitches);

  /// One stamp more may be named by the stock.
  void append(const Vec3& tip_mm) { tips_.append(tip_mm); }
  const StampTips& tips() const { return tips_; }

  /// Chips of a stamp. `earlier`: stamps that the arena does not hold yet and that may have cut what this one meets.
  std::span<const ChipBlock> read(const TileArena& arena, const Stamp& stamp, std::span<const std::int32_t> earlier,
                                  Buffers& buffers) const;
  /// The thicknesses of these chips in some blocks of the envelope, always the same ones, summed up: how much material
  /// there is, at a small part of the cost.
  double glance(const TileArena& arena, const Stamp& stamp, std::span<const std::int32_t> earlier,
                Buffers& buffers) const;
  /// The same sum of chips that were read.
  double glance_of(std::span<const ChipBlock> chips) const;

 private:
  /// Blocks that glance() reads, with bounds of their own.
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
  double max_curved_per_mm_ = 0;  ///< of the envelope
  GlancedBlocks glanced_;
};

}  // namespace camber::removal::upright
