#pragma once
// Tool engagement: finds the chip at every point of the cutter's envelope at every stamp, from the stock that the
// previous stamps left, and carves the stock. This is the door of removal/engage/.
//
// Overview
//
// A stamp is the cutter at one tooth passing (removal/tool_path.h). The cutter's surface, the envelope, is sampled by
// points on rings, one rotation step apart (removal/cutter.h). For every stamp an engager answers one question per
// point: how thick is the material below it, measured against the envelope's normal, and how much of that did the tool
// move into since the last tooth? The smaller of the two is the uncut chip thickness. Forces follow from the chips in
// deflection/; after that the engager removes the cutter's volume from the stock.
//
// - RigidEngager: the cutter is not deflected. Stamps are processed in batches: the chips of all stamps of a batch are
//   read from the unchanged tiles, then the batch is cut. engage/upright/block_reader reads eight points at a time.
//   With a SparseChipSink only some stamps are read; the caller interpolates the rest.
// - DeflectedEngager: the cutter is deflected, and its deflection depends on the chips. It takes one stamp at a time:
//   read() with the current deflection, as often as that changes, then cut(). engage/upright/chip_reader reads patches
//   of the envelope and also returns how each depth changes with the deflection.
// - StepEngager: for a path that is made while it is cut.
// - sweep(): carves without reading chips, for blanks, targets and checks.
//
// Upright paths use engage/upright/ and field/upright/; every other path uses engage/tilted/ and field/tilted/, which
// work in the tool's frame of each stamp. An engager chooses when it is made (engage/engaged_path.h). Where a cut
// changes slowly, a glance (engage/patch_reading.h) at an eighth of the envelope shows whether a stamp has to be read
// at all.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber {
class Stage;
}

namespace camber::removal {

class DeflectedPath;  // removal/engage/engaged_path.h
struct KnownRun;      // removal/known_run.h

namespace upright {
struct BlockPoints;  // removal/simd/upright_block_kernels.h
struct BlockBounds;
}  // namespace upright

// Definitions of depth and chip thickness
//
// Depth. A trilinear field rounds the ridges where two cuts meet, and most of a finishing chip lies near a ridge (6 %
// of its volume was lost at 0.1 mm voxels). So the depth of a point is the largest of the smooth fields that meet in
// its voxel cell: the blank's, read trilinearly, and those of the stamps that the cell's corners name, each evaluated
// at the point itself. For deflected stamps the difference between the corners' values and the undeflected cutter's is
// added, with the trilinear weights.
//
// Chip. h = min(d, max(0, B + (k1 f_m^2 + k2 f_t^2) / 2)): d is the depth of the point in the stock left by the
// previous stamp; f its motion since then; B, f_m, f_t the components of f along the normal, the meridian and the
// circle of latitude; k1 and k2 the curvatures of the envelope there.
//
// Deflected cutters. The previous stamp left the surface below a point at another rotation step, with another
// deflection, than it has at the point. Therefore h = d up to B + ... + r with r the largest deflection of the previous
// stamp, also where B is negative; beyond that h = B + ...
//
// Level faces. A level face of the stock (the blank's top, the floor of an earlier pass, an allowance on a floor)
// divides a whole ring of a cutter's wall at once. The chip then has the fraction of the ring width that is in
// material, and the thickness in the middle of that part.
//
// Poses. An upright path (ToolPose::upright()) is engaged and cut column by column, any other in the tool's frame of
// each stamp; chips and deflections are in that frame.
//
// Threads. Space is divided into tiles; each tile processes the stamps in order, and tiles are processed in parallel.
// Results do not depend on the number of threads.

/// The chip at one envelope point at one stamp.
struct ChipSample {
  std::uint32_t point = 0;     ///< index into EnvelopeGrid
  float thickness_mm = 0;      ///< uncut, along the envelope normal, > 0
  bool after_tooth = false;    ///< bounded by the surface of the previous tooth, not by an older one
  bool own_surface = false;    ///< an older surface that the same tool cut
  std::uint8_t cut_255 = 255;  ///< fraction of the ring width in the cut, in 255ths
  double width_fraction() const { return cut_255 / 255.0; }
};

/// The chip samples of one block of EnvelopeBlocks.
struct ChipBlock {
  std::uint32_t block = 0;
  std::uint16_t after_tooth = 0, own_surface = 0;  ///< one bit per point
  /// 0: no chip; negative: no chip; distance to the material along the outward normal
  std::array<float, 8> thickness_mm{};
  std::array<std::uint8_t, 8> cut_255{};
};

/// Two neighbouring rings by four rotation steps, all of one pitch; the steps of a ring side by side. Lanes beyond an
/// edge of the grid have no point (kNoPoint).
class EnvelopeBlocks {
 public:
  static constexpr int kSteps = 4, kRings = 2, kLanes = kSteps * kRings;
  static constexpr std::uint32_t kNoPoint = 0xffffffff;

  /// `band_mm`, `voxel_mm`: of the stock that is read.
  EnvelopeBlocks(const EnvelopeGrid& envelope, double voxel_mm, double band_mm);

  struct Block {
    int ring = 0;  ///< the lower one
    int step = 0;  ///< first rotation step, counted in the pitch
  };
  const Block& block(std::uint32_t i) const { return block_[i]; }
  std::size_t size() const { return block_.size(); }
  /// Index into the grid; kNoPoint.
  std::uint32_t point(std::uint32_t block, int lane) const {
    return point_[block * static_cast<std::uint32_t>(kLanes) + static_cast<std::uint32_t>(lane)];
  }
  const float* cos_phi(std::uint32_t block) const { return cos_phi_.data() + kLanes * block; }
  const float* sin_phi(std::uint32_t block) const { return sin_phi_.data() + kLanes * block; }
  /// First block that lies entirely above this height over the tip.
  int up_to(double height_mm) const;
  /// Largest horizontal distance of a point from the centre of its block.
  double widest_mm() const { return widest_mm_; }
  float wall_half_mm(int lane_of_all) const { return wall_half_[static_cast<std::size_t>(lane_of_all)]; }
  upright::BlockPoints points() const;
  upright::BlockBounds bounds() const;

 private:
  void add(const EnvelopeGrid& envelope, const std::vector<float>& wall_half_mm, int ring, int step, int first_of_pitch,
           double voxel_mm, double band_mm);

  std::vector<Block> block_;
  std::vector<float> lowest_;  ///< lowest point of each block and of all blocks after it
  std::vector<std::uint32_t> point_;
  std::vector<float> x_, y_, z_, nx_, ny_, nz_, cos_phi_, sin_phi_, k1_, k2_, wall_half_;
  double widest_mm_ = 0;
  std::vector<float> bottom_, centre_x_, centre_y_, centre_z_, reach_, normal_x_, normal_y_, normal_z_, spread_;
};

std::vector<ChipSample> chips_of(const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips);

/// Volume of the chips of one stamp, mm^3: sum of (h - H h^2 + K h^3 / 3) dA, with the mean and Gaussian
/// curvature of the envelope. Source: parallel surfaces (Steiner).
double chip_volume_mm3(const EnvelopeGrid& envelope, std::span<const ChipSample> chips);
double chip_volume_mm3(const EnvelopeGrid& envelope, const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips);

/// Volume of the chips of a deflected cutter, mm^3: chip_volume_mm3 with the area that the edge really sweeps.
/// Chip thickness is along the normal n of the envelope, and the surface p + delta has the area
///   n . (d(p + delta)/dphi x d(p + delta)/ds) dphi ds = (1 + d(delta)/(r dphi) . t + d(delta)/ds . m) dA,
/// t along the circle of latitude, m along the meridian. A deflection that changes by 5 % of the path length of the
/// edge changes the volume by 5 %. `row`: the stamp's row of `deflections`.
double swept_chip_volume_mm3(const EnvelopeGrid& envelope, std::span<const ChipSample> chips,
                             const DeflectionTable& deflections, const float* row);

/// Receives the chips of stamp `from` + k. Called by several threads at once, once for every k, in any order; the
/// span is valid during the call only.
using ChipSink = std::function<void(std::size_t k, std::span<const ChipBlock>)>;

/// Callbacks for a stretch of which not every stamp is read. Functions are called by several threads at once.
struct SparseChipSink {
  ChipSink read;                                 ///< the chips of some stamps, at most once each
  std::function<bool(std::size_t k)> must_read;  ///< whatever its neighbours are like
  /// True where what was read at k lies on the line between a and b, a < k < b, all of them read.
  std::function<bool(std::size_t a, std::size_t k, std::size_t b)> on_line;
  /// k is not read: its loads lie on the line between a and b, a < k < b, which are read.
  std::function<void(std::size_t a, std::size_t k, std::size_t b)> between;
};

/// Engagement of the undeflected cutter, batch by batch: the chips of the stamps of a batch are read from the unchanged
/// tiles, then the batch is cut. For one run of one tool.
class RigidEngager {
 public:
  /// `blank`: the stock before stamps[0]. Ids in the stock are first_id + index; smaller ids count as blank.
  /// `pitches`: largest number of tooth passings between a tooth and the one that left the surface of its chip; 1 for
  /// uniform teeth. With more, points whose chip would need the motion in up to `pitches` passings are reported too,
  /// with a negative thickness. `known`: of these stamps, where they are a known run (known_run.h). Everything passed
  /// must outlive the object.
  RigidEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
               std::int32_t first_id, int pitches = 1, const KnownRun* known = nullptr);
  ~RigidEngager();

  const EnvelopeBlocks& blocks() const;
  /// Cuts stamps[from] ... stamps[from + count - 1], which must come after all that were cut before. The stock is
  /// written lazily: tiles that these stamps reach are written by a later call, or by commit().
  void engage(std::size_t from, std::size_t count, const ChipSink& sink);
  /// Reads some stamps only: the middle one between two others shows whether those between may be left out. A glance at
  /// an eighth of the envelope must find the material there that the line between their neighbours has. What is carved
  /// does not depend on it.
  void engage(std::size_t from, std::size_t count, const SparseChipSink& sink);
  /// Writes all pending tiles to the stock. Returns the volume removed since the last commit, mm^3.
  double commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Maximum tilt of the deflected envelope (a jump of the deflection at the entry of an edge is not a slope).
constexpr double kMaxTilt = 0.3;

/// A depth that exceeds the motion bound by less than this factor, or by less than its deflection, is attributed to the
/// surface of the previous tooth, which is more accurate than the bound.
constexpr float kBeyondCap = 2.0f;

/// Points up to this far outside the material are reported, with a negative thickness.
constexpr float kNear_mm = 0.1f;

/// A chip sample of a deflected cutter, and its change with the deflection.
struct DeflectedChipSample {
  ChipSample chip;     ///< its thickness is the smaller of the next two, negative for a point outside the material
  float depth_mm = 0;  ///< thickness of stock below the point, against the normal
  float cap_mm = 0;    ///< motion bound; the largest depth that counts where the depth is smaller
  std::array<float, 3> deeper{};  ///< d(depth)/d(deflection), by x, y and z
};

/// Engagement of the deflected cutter: read() returns the chips of a stamp with its current deflection and is called
/// again when that changes; then cut() carves the stamp, alone or together with stamps after it. For one run of one
/// tool.
class DeflectedEngager {
 public:
  static constexpr double kMaxDeflection_mm = 0.5;

  /// `blank`: the stock before stamps[0]. Ids in the stock are first_id + index; smaller ids count as blank. Requires
  /// an envelope with patches; everything passed must outlive the object. `known`: see RigidEngager.
  DeflectedEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
                   std::int32_t first_id, const KnownRun* known = nullptr);
  ~DeflectedEngager();

  /// Sets the deflections of the stamps before stamps[from], where they were cut elsewhere: rows of the last ones, one
  /// after the other, and the largest of all. Call it before the first start().
  void remember(std::size_t from, std::span<const float> rows, std::size_t row_size, double largest_mm);
  /// Begins with stamps[from] ... stamps[from + count - 1], which must come after all that were cut before. Row k of
  /// `deflections` belongs to stamps[from + k]; it is read with its stamp and with the next one.
  void start(std::size_t from, std::size_t count, const DeflectionTable& deflections);
  /// Returns the chips that stamps[from + k] takes after its predecessors were cut; valid until the next call. Points
  /// less than kNear_mm outside the material are among them, with a negative thickness.
  std::span<const DeflectedChipSample> read(std::size_t k);
  /// Returns the sum of the chips of read() over a fixed set of patches of the envelope, at an eighth of the cost, for
  /// `count` stamps from stamps[from + k] on. All of them see the present stock. Where stamps before it have yet to
  /// cut, the motion, with the change of the deflection, is taken for the chip wherever the material is as thick. Valid
  /// until the next call.
  std::span<const double> glance(std::size_t k, std::size_t count);
  /// Returns the sum of glance() for chips that were read.
  double glance_of(std::span<const DeflectedChipSample> chips) const;
  /// Cuts `count` stamps from stamps[from + k] on, tile by tile.
  void cut(std::size_t k, std::size_t count = 1);
  /// Writes all pending tiles to the stock. Returns the volume removed since the last commit, mm^3.
  double commit();

 private:
  std::unique_ptr<DeflectedPath> path_;
};

struct SweepOptions {
  double shrink_mm = 0;       ///< cutter reduced by this along its normal (allowance of the blank)
  std::int32_t first_id = 0;  ///< id of stamps[0], written to the voxels that it sets last
  Stage* stage = nullptr;     ///< advanced by the stamps
};

/// Carves the undeflected cutter through the stock, without engagement. Returns the volume removed, mm^3.
double sweep(Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps, const SweepOptions& options);

/// Box that contains all tips of a run.
struct TipBox {
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();
  bool contains(const Vec3& tip_mm) const;
};

/// Reads the chips of the undeflected cutter stamp by stamp, with the same result as RigidEngager for a whole run. Each
/// stamp is read from the stock as the ones before it left it: the result does not depend on how many are known at
/// once. For one run of one upright tool, and one thread.
///
/// A stamp takes memory of 12 bytes for its place. Tiles of the stock stay in memory while they may be needed again, no
/// more than a few times as many as the cutter touches at once.
class StepEngager {
 public:
  /// `blank`: the stock before the first stamp. Ids in the stock are first_id + number; smaller ids count as blank.
  /// `pitches`: as RigidEngager has it. Everything passed must outlive the object.
  StepEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope, const TipBox& tips, std::int32_t first_id,
              int pitches = 1);
  ~StepEngager();

  const EnvelopeBlocks& blocks() const;
  /// Stamps that were cut.
  std::size_t count() const;
  /// The chips of a stamp in the stock as it stands. Requires an upright tool with its tip in the box. Valid until the
  /// next call.
  std::span<const ChipBlock> read(const Stamp& stamp);
  static constexpr int kAll = std::numeric_limits<int>::max();
  /// Reads tiles that a cutter with its tip there, or in the box nearest to it, would meet and that are not in memory,
  /// in `most` steps of about a tenth of a millisecond; what is not read beforehand is read by the stamp that comes
  /// near it. Gives up tiles that are not needed, as many at most.
  void approach(const Vec3& tip_mm, int most);
  /// Cuts a stamp. The stock is written lazily, tile by tile.
  void cut(const Stamp& stamp);
  /// Distance to the stock as it stands (Stock::distance_mm).
  double distance_mm(const Vec3& place_mm) const;
  /// Writes all pending tiles to the stock and goes on. Returns the volume removed since the last time, mm^3.
  double flush();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::removal
