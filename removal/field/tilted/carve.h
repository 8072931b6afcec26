#pragma once
// Cutting a tile with a cutter whose axis points anywhere.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/tool_pose.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/field/profile_rows.h"
#include "removal/field/stamp_deflection.h"
#include "removal/field/tile.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::removal::tilted {

/// A place and the directions of a tool there.
struct Frame {
  Vec3 tip_mm;
  Mat3 to_part;  ///< columns: the tool's x, y, z
  explicit Frame(const ToolPose& pose) : tip_mm(pose.tip_mm), to_part(tool_frame(pose)) {}

  Vec3 in_tool(const Vec3& point) const { return to_part.transpose() * (point - tip_mm); }
  Vec3 in_part(const Vec3& point) const { return tip_mm + to_part * point; }
  Vec3 axis() const { return to_part.col(2); }
};

/// How far any point of the stock has moved against the cutter since the first stamp, at most, mm, for every stamp:
/// what a stamp changes at a place within the stock differs from what another changes by no more than the difference.
std::vector<double> way_mm(std::span<const Stamp> stamps, const Vec3& stock_min_mm, const Vec3& stock_max_mm);

/// What is known of the rows (along z) of a tile's voxels.
///
/// The distance to a cutter is 1-Lipschitz, and material is only removed: a row whose voxels all lie by `d` above what
/// the cutter at one stamp would leave is not changed before the cutter has moved, or bends, by d. So each row keeps
/// the way (way_mm()) at which it must be looked at again.
struct RowsDue {
  static constexpr int kRows = Tile::kSide * Tile::kSide;
  std::array<float, kRows> due{};
  float first = 0;  ///< no row is due before

  RowsDue() { forget(); }
  /// All, for ways that count anew.
  void forget() {
    due.fill(-1);
    first = -1;
  }
};

/// One stamp in a tile.
struct Carving {
  const CutterShape& shape;
  const ProfileRows& profile;  ///< of the shape
  const Frame& frame;
  double voxel_mm, band_mm;
  std::int32_t id;
  double way_mm;         ///< of the stamp
  double shrink_mm = 0;  ///< the cutter is smaller by this
};

/// stock = max(stock, -cutter) where that is more; voxels that change take the id. True where one did.
bool carve(Tile& tile, RowsDue& rows, const Index3& index, const Carving& stamp);

/// With the deflected cutter.
class DeflectedCarver {
 public:
  /// Both must outlive it.
  DeflectedCarver(const EnvelopeGrid& envelope, const DeflectionTable& deflections)
      : envelope_(envelope), deflections_(deflections) {}
  bool carve(Tile& tile, RowsDue& rows, const Index3& index, const Carving& stamp, const StampDeflection& deflection);

 private:
  void settle(const StampDeflection& deflection);

  const EnvelopeGrid& envelope_;
  const DeflectionTable& deflections_;
  // Voxels that the stamp may change, and their places in the tool's frame:
  std::vector<int> voxel_;
  std::vector<float> x_, y_, z_, zero_, one_, thickness_;
  std::vector<std::int32_t> row_;
};

}  // namespace camber::removal::tilted
