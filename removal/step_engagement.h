#pragma once
// Engagement and carving of one tooth passing after another, where the path is made while the tool cuts.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "removal/cutter.h"
#include "removal/engagement.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::removal {

/// Where tips of a run may stand.
struct TipBox {
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();
  bool contains(const Vec3& tip_mm) const;
};

/// The chips of the undeflected cutter, stamp by stamp, as RigidEngager has them for a whole run. Each stamp is read
/// from the stock as the ones before it left it, so that nothing depends on how many are known at once. For one run of
/// one upright tool, and one thread.
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
  /// As Stock::distance_mm, of the stock as it stands.
  double distance_mm(const Vec3& place_mm) const;
  /// Writes all pending tiles to the stock and goes on. Returns the volume removed since the last time, mm^3.
  double flush();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::removal
