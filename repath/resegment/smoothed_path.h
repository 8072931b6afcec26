#pragma once
// What laying out a path again needs and what does not depend on the length of the segments.
#include <map>
#include <utility>
#include <vector>

#include "repath/resegment/resegmentation.h"
#include "repath/run_text.h"

namespace camber::repath {

class SmoothCurve;

/// Corners and curves of a path, made once; then laid out with as many lengths as wanted. See lay_out().
class SmoothedPath {
 public:
  /// At least two points, no two that follow each other alike.
  SmoothedPath(std::vector<Vec3> points, const ResegmentOptions& options, double increment_mm);
  ~SmoothedPath();
  SmoothedPath(SmoothedPath&&) noexcept;

  const std::vector<Vec3>& points() const { return old_; }
  /// `mark_corners`: segments end where the reach of a corner begins and ends, and Layout::place is filled.
  Layout lay_out(double length_mm, bool mark_corners = false) const;

 private:
  struct Piece;
  class Layouter;
  void smooth(std::size_t first, std::size_t last);
  void straight(std::size_t first);
  std::vector<std::size_t> leaves(const SmoothCurve& curve, std::size_t first) const;
  double to_path_mm(const Vec3& p, std::size_t segment) const;

  std::vector<Vec3> old_;
  double tolerance_, increment_;
  std::size_t corners_ = 0;
  std::vector<char> corner_at_;  ///< of each old point: 0 none, 1 an edge, 2 a sharp corner
  std::vector<Piece> pieces_;
};

/// The runs of a program, ready to be laid out with several lengths and feeds.
class Resegmenter {
 public:
  /// `program` and `moves` must outlive it. Of the options tolerance, corners and number style count.
  Resegmenter(const nc::Program& program, const nc::Interpretation& moves, const ResegmentOptions& options);
  ~Resegmenter();

  /// Uses the length, the block time and the factors of `options`.
  Resegmentation lay_out(const ResegmentOptions& options);

 private:
  struct Prepared;
  class Writer;
  const Prepared& prepared(const BlockRun& stretch);

  const nc::Program& program_;
  const nc::Interpretation& moves_;
  ResegmentOptions options_;
  TextStyle style_;
  std::vector<BlockRun> runs_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Prepared> prepared_;  ///< by a stretch's first and last move
};

}  // namespace camber::repath
