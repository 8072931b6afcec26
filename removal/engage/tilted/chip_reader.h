#pragma once
// Reads from the stock's tiles which chips the points of a tilted cutter take. The counterpart of
// removal/engage/upright/chip_reader.h: places and normals are carried between the tool's frame and the part's.
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
#include "removal/field/tilted/carve.h"
#include "removal/field/upright/tile_arena.h"
#include "removal/simd/upright_kernels.h"
#include "removal/tool_path.h"

namespace camber::removal::tilted {

/// Decides what a reading counts as a chip.
struct ReadingRule {
  bool rigid = false;  ///< the motion bounds the chip sharply: the cutter is not deflected
  int pitches = 1;     ///< largest number of passings back to the surface of a chip, see RigidEngager
};

/// Reads the chips of one stretch. removal/engagement.h defines depth and chip thickness.
class ChipReader {
 public:
  /// A point near the surface: its chip follows from the fields of the stamps around it.
  struct Shallow {
    std::uint32_t point;
    std::uint8_t cut_255;
    float cap_mm, limit_mm;  ///< what the motion allows; the largest depth that counts
    float below_blank_mm;
    CellShare share;    ///< position within its cell
    std::int32_t cell;  ///< number of the cell in the arena
    Vec3 place_mm;      ///< place that is judged: on the ring, above or below the point by `up_mm`
    double up_mm;
    std::size_t first_pair;
  };
  /// A stamp that left a surface.
  struct OtherStamp {
    std::int32_t stamp = -1;
    StampFrame frame{ToolPose{}};
    std::size_t turned_from = static_cast<std::size_t>(-1);  ///< Reading::number
    Mat3 turn = Mat3::Identity();                            ///< rotation from that stamp's frame to this one's
  };
  /// Working memory of one thread; is used again for every stamp.
  struct Buffers {
    std::vector<Shallow> shallow;
    std::size_t pairs = 0;  ///< entries in use of the lists below (upright::PairLanes), which are longer
    std::vector<float> x, y, z, nx, ny, nz, guess_x, guess_y, guess_z, known, farther, thickness;
    std::vector<std::int32_t> row, id;
    std::vector<OtherStamp> others;  ///< stamps needed last, indexed by the lowest bits of their numbers
  };

  /// Parameters: see upright::ChipReader. `rule` says what counts as a chip.
  ChipReader(const EngagedRun& run, const upright::PatchLanes& lanes, std::span<const Stamp> stamps,
             const DeflectionTable& deflections, const upright::BendMemory& memory, const ReadingRule& rule);

  /// A stamp that is read.
  struct Reading {
    std::size_t k;       ///< index in the stretch
    std::size_t number;  ///< index among all stamps
    StampFrame frame;
    ToothMotion motion;
    /// Chip that a point may take beyond its motion bound, mm: the stamp before had another deflection when it left the
    /// surface there.
    double reach_mm, axial_reach_mm;
    bool sharp;  ///< the motion bounds the chip sharply: the cutter is rigid, or the stamps before have yet to cut
  };
  Reading reading_of(std::size_t k, bool sharp = false) const;

  /// Lists the patches that may take a chip.
  void find_patches(const upright::TileArena& arena, const Reading& stamp, std::vector<std::int32_t>& out) const;
  /// Appends the chips that the stamp takes with the points of these patches.
  void read(const upright::TileArena& arena, const Reading& stamp, std::span<const std::int32_t> patches,
            Buffers& buffers, std::vector<DeflectedChipSample>& out) const;

 private:
  /// Thickness of the stock below a point.
  struct Depth {
    float mm;
    std::array<float, 3> deeper;  ///< derivatives by a deflection along the tool's x, y and z
    bool own_surface;
  };
  upright::TiltedPlace place_of(const upright::TileArena& arena, const Reading& stamp) const;
  upright::StampBend bend_of(const Reading& stamp) const;
  void sort_points(const upright::TileArena& arena, const Reading& stamp, const upright::LaneReading& reading,
                   int first_lane, int count, Buffers& buffers, std::vector<DeflectedChipSample>& out) const;
  bool reach_below_blank(const upright::TileArena& arena, const Reading& stamp, Shallow& p) const;
  bool place_in_ring(const upright::TileArena& arena, const Reading& stamp, float half_mm, float axial_mm, Shallow& p,
                     Buffers& buffers) const;
  static void make_room(Buffers& buffers);
  void add_pairs(const upright::TileArena& arena, const Reading& stamp, Shallow& p, Buffers& buffers) const;
  float farther_mm(const upright::TileArena& arena, const Shallow& p, std::int32_t id, const StampFrame& frame) const;
  void thin_pairs(Buffers& buffers) const;
  void thin_general(Buffers& buffers) const;
  Depth depth(const upright::TileArena& arena, const Reading& stamp, const Shallow& p, std::size_t end_pair,
              Buffers& buffers) const;
  OtherStamp& other(std::int32_t stamp, Buffers& buffers) const;
  static const Mat3& turn_to(const Reading& from, OtherStamp& to);
  Vec3 normal(std::uint32_t point) const { return {envelope_.nx[point], envelope_.ny[point], envelope_.nz[point]}; }

  const EnvelopeGrid& envelope_;
  const upright::PatchLanes& lanes_;
  upright::PointLanes view_;
  std::span<const Stamp> all_, stamps_;
  std::int32_t first_id_;
  double voxel_mm_;
  const DeflectionTable& deflections_;
  const upright::BendMemory& memory_;
  ReadingRule rule_;
  const upright::Kernels& kernels_;
  float node_step_mm_;
  double max_curved_per_mm_ = 0;
  std::vector<float> wall_half_mm_;  ///< half widths of the rings (removal/engage/upright/level_faces.h)
};

}  // namespace camber::removal::tilted
