#pragma once
// Which chips the points of patches take from the tiles, for a cutter whose axis points anywhere. As
// removal/engage/upright/chip_reader.h, with places and normals carried between the tool's frame and the part's.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/engage/upright/bend_memory.h"
#include "removal/engage/upright/patch_lanes.h"
#include "removal/engagement.h"
#include "removal/field/cell.h"
#include "removal/field/tilted/carve.h"
#include "removal/field/upright/tile_arena.h"
#include "removal/simd/upright_kernels.h"
#include "removal/tool_path.h"

namespace camber::removal::tilted {

/// What a reading counts as a chip.
struct ReadingRule {
  bool rigid = false;  ///< the motion bounds the chip sharply: the cutter is not deflected
  int pitches = 1;     ///< see RigidEngager
};

/// Reads for one stretch. Definitions of depth and chip thickness: removal/engagement.h.
class ChipReader {
 public:
  /// A point whose chip the fields of the stamps around decide.
  struct Shallow {
    std::uint32_t point;
    std::uint8_t cut_255;
    float cap_mm, limit_mm;  ///< what the motion allows; the largest depth that counts
    float below_blank_mm;
    CellShare share;    ///< in its cell
    std::int32_t cell;  ///< in the arena
    Vec3 place_mm;      ///< that is judged; on the ring, above or below the point by `up_mm`
    double up_mm;
    std::size_t first_pair;
  };
  /// A stamp that left a surface.
  struct OtherStamp {
    std::int32_t stamp = -1;
    Frame frame{ToolPose{}};
    std::size_t turned_from = static_cast<std::size_t>(-1);  ///< Reading::number
    Mat3 turn = Mat3::Identity();                            ///< from that stamp's frame to this one's
  };
  /// What one thread needs; may be used for stamp after stamp.
  struct Buffers {
    std::vector<Shallow> shallow;
    std::size_t pairs = 0;  ///< of the lists below (upright::PairLanes); they are longer
    std::vector<float> x, y, z, nx, ny, nz, guess_x, guess_y, guess_z, known, farther, thickness;
    std::vector<std::int32_t> row, id;
    std::vector<OtherStamp> others;  ///< that were needed last, by the lowest bits of their numbers
  };

  /// As upright::ChipReader.
  ChipReader(const EnvelopeGrid& envelope, const upright::PatchLanes& lanes, std::span<const Stamp> all,
             std::span<const Stamp> stamps, std::int32_t first_id, double voxel_mm, const DeflectionTable& deflections,
             const upright::BendMemory& memory, const ReadingRule& rule);

  /// A stamp that is read.
  struct Reading {
    std::size_t k;       ///< of the stretch
    std::size_t number;  ///< of all stamps
    Frame frame;
    ToothMotion motion;
    /// How much more than its motion allows a point may take, since the stamp before was deflected otherwise when it
    /// left the surface there.
    double reach_mm, axial_reach_mm;
  };
  Reading reading_of(std::size_t k) const;

  /// Lists the patches that may take a chip.
  void find_patches(const upright::TileArena& arena, const Reading& stamp, std::vector<std::int32_t>& out) const;
  /// Appends the chips that the stamp takes with the points of these patches.
  void read(const upright::TileArena& arena, const Reading& stamp, std::span<const std::int32_t> patches,
            Buffers& buffers, std::vector<DeflectedChipSample>& out) const;

 private:
  /// Of the stock below a point.
  struct Depth {
    float mm;
    std::array<float, 3> deeper;  ///< by a deflection in x, y and z of the tool
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
  float farther_mm(const upright::TileArena& arena, const Shallow& p, std::int32_t id, const Frame& frame) const;
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
  std::vector<float> wall_half_mm_;  ///< of the rings (removal/engage/upright/level_faces.h)
};

}  // namespace camber::removal::tilted
