#pragma once
// The envelope's points in blocks of eight, as removal/block_kernels.h reads them.
#include <cstdint>
#include <vector>

#include "removal/block_kernels.h"
#include "removal/cutter.h"

namespace camber::removal {

/// Two neighbouring rings by four rotation steps, all of one pitch; the steps of a ring side by side. Where an edge
/// of the grid leaves places over, these are no points.
class EnvelopeBlocks {
 public:
  static constexpr int kSteps = 4, kRings = 2, kLanes = kSteps * kRings;
  static constexpr std::uint32_t kNoPoint = 0xffffffff;

  /// `band_mm`, `voxel_mm`: of the stock that is read.
  EnvelopeBlocks(const EnvelopeGrid& envelope, double voxel_mm, double band_mm);

  struct Block {
    int ring = 0;  ///< the lower one
    int step = 0;  ///< of the pitch, the first
  };
  const Block& block(std::uint32_t i) const { return block_[i]; }
  std::size_t size() const { return block_.size(); }
  /// Index into the grid; kNoPoint.
  std::uint32_t point(std::uint32_t block, int lane) const {
    return point_[block * static_cast<std::uint32_t>(kLanes) + static_cast<std::uint32_t>(lane)];
  }
  const float* cos_phi(std::uint32_t block) const { return cos_phi_.data() + kLanes * block; }
  const float* sin_phi(std::uint32_t block) const { return sin_phi_.data() + kLanes * block; }
  /// Blocks from here on lie higher above the tip.
  int up_to(double height_mm) const;
  /// How far seen from above a point of a block lies from the block's centre, at most.
  double widest_mm() const { return widest_mm_; }
  float wall_half_mm(int lane_of_all) const { return wall_half_[static_cast<std::size_t>(lane_of_all)]; }
  BlockPoints points() const;
  BlockBounds bounds() const;

 private:
  void add(const EnvelopeGrid& envelope, const std::vector<float>& wall_half_mm, int ring, int step, int first_of_pitch,
           double voxel_mm, double band_mm);

  std::vector<Block> block_;
  std::vector<float> lowest_;  ///< of the points of each block and all after it
  std::vector<std::uint32_t> point_;
  std::vector<float> x_, y_, z_, nx_, ny_, nz_, cos_phi_, sin_phi_, k1_, k2_, wall_half_;
  double widest_mm_ = 0;
  std::vector<float> bottom_, centre_x_, centre_y_, centre_z_, reach_, normal_x_, normal_y_, normal_z_, spread_;
};

}  // namespace camber::removal
