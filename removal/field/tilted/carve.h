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
struct StampFrame {
  Vec3 tip_mm;
  Mat3 to_part;  ///< columns: the tool's x, y, z
  explicit StampFrame(const ToolPose& pose) : tip_mm(pose.tip_mm), to_part(tool_frame(pose)) {}

  Vec3 in_tool(const Vec3& point) const { return to_part.transpose() * (point - tip_mm); }
  Vec3 in_part(const Vec3& point) const { return tip_mm + to_part * point; }
  Vec3 axis() const { return to_part.col(2); }
};

/// Distance by which points of the stock have moved against the cutter since the first stamp.
struct Way {
  double any_mm = 0;  ///< any point at most: what a stamp changes at a place differs by no more than the difference
  /// Up the cutter's axis, at most: what a stamp leaves above its lowest plane differs by no more than the difference.
  /// Less than before where the cutter draws back.
  double up_mm = 0;
};
/// Returns the way of every stamp, for places within the stock.
std::vector<Way> ways(std::span<const Stamp> stamps, const Vec3& stock_min_mm, const Vec3& stock_max_mm);

/// Facts about the rows (along z) of a tile's voxels.
///
/// The distance to a cutter is 1-Lipschitz, and material is only removed: a row whose voxels all lie by `d` above what
/// the cutter at one stamp would leave is not changed before the cutter has moved, or bends, by d. So each row keeps
/// the way (Way::any_mm) at which it must be looked at again.
///
/// A cutter is above the plane through its tip, square to its axis. A row whose voxels all are what that plane leaves,
/// or lower, is not changed before the cutter has gone down its axis: under a flat bottom each row is done when the
/// bottom has passed, however long the tool stays above it.
class RowsDue {
 public:
  RowsDue() { forget(); }
  /// All, for ways that count anew.
  void forget() {
    any_.fill(-1);
    up_.fill(kNever);
    tile_ = {};
    of_i_.fill({});
  }

  /// The way of a stamp, with what its cutter bends by.
  struct Now {
    float any_mm;
    double up_mm;
  };
  bool due(const Now& now) const { return due(tile_, now); }
  bool due(const Now& now, int i) const { return due(of_i_[static_cast<std::size_t>(i)], now); }
  bool due(const Now& now, int i, int j) const { return now.any_mm > any_[at(i, j)] && now.up_mm > up_[at(i, j)]; }

  /// The row lies so far above what the cutter at `way` leaves; infinity: it is air.
  void set_above(int i, int j, const Way& way, float mm) { any_[at(i, j)] = static_cast<float>(way.any_mm) + mm; }
  /// And so far above what its lowest plane leaves; negative: partly below.
  void set_above_plane(int i, int j, const Way& way, float mm) { up_[at(i, j)] = way.up_mm + static_cast<double>(mm); }
  /// To be called when the rows of one i were looked at, and when all that were due in the tile were.
  void gather(int i, const Now& now);
  void gather();

 private:
  static constexpr std::size_t kSide = Tile::kSide;
  static constexpr double kNever = -1e300;
  /// When several rows are due: those that the plane has passed are not due before `up`, the others not before `any`.
  struct First {
    float any = -1;
    double up = kNever;
  };
  static std::size_t at(int i, int j) { return static_cast<std::size_t>(i) * kSide + static_cast<std::size_t>(j); }
  static bool due(const First& first, const Now& now) { return now.any_mm > first.any || now.up_mm > first.up; }

  std::array<float, kSide * kSide> any_{};
  std::array<double, kSide * kSide> up_{};
  std::array<First, kSide> of_i_{};
  First tile_{};
};

/// One stamp in a tile.
struct Carving {
  const CutterShape& shape;
  const ProfileRows& profile;  ///< rows of `shape`
  const StampFrame& frame;
  double voxel_mm, band_mm;
  std::int32_t id;
  Way way;               ///< way of the stamp
  double shrink_mm = 0;  ///< the cutter is smaller by this
};

/// Returns whether carving needs to look at the tile.
bool is_due(const RowsDue& rows, const Carving& stamp, const StampDeflection& deflection);

/// Sets stock = max(stock, -cutter); voxels that change take the id. Returns true if one did.
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
