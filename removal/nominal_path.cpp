#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "removal/tool_path.h"

namespace camber::removal {
namespace {

constexpr double kStraight_mm = 5e-5;  // a vertex nearer than this to the chord past it needs no stamp
constexpr double kFarther = 1.5;       // a step longer than this many feeds per tooth is divided
constexpr double kStill_mm = 1e-6;

class NominalBuilder {
 public:
  NominalBuilder(const nc::Interpretation& program, const std::vector<bool>& selected)
      : program_(program), selected_(selected) {}

  void begin_run(const ToolRun& run) { out_.runs.push_back({run.tool, out_.stamps.size(), 0, run.kind}); }
  void end_run() { out_.runs.back().count = out_.stamps.size() - out_.runs.back().from; }
  void copy(const Stamp& stamp) { out_.stamps.push_back(stamp); }

  /// Goes on to where the programmed path is nearest to a stamp of the axes.
  void follow(const Stamp& stamp) {
    if (open_ && !joined(at_.move, stamp.move)) close(stamp.move);
    if (!open_) {
      std::uint32_t first = stamp.move;
      while (first > next_ && joined(first - 1, first)) --first;
      at_ = {first, 0};
      open_ = true;
      put(stamp, at_, true);
    }
    const Vec3 goal = place_of({stamp.move, stamp.fraction});
    for (std::uint32_t m = at_.move; m < stamp.move; ++m)
      if (!straight_past(m, goal)) reach(stamp, {m, 1});
    reach(stamp, {stamp.move, stamp.fraction});
    next_ = stamp.move;
    last_ = stamp;
  }

  /// Covers what is left of the cut; `before`: a move that is reached only later.
  void close(std::uint32_t before) {
    if (!open_) return;
    std::uint32_t last = at_.move;
    while (last + 1 < before && joined(last, last + 1)) ++last;
    for (std::uint32_t m = at_.move; m <= last; ++m) reach(last_, {m, 1});
    next_ = last + 1;
    open_ = false;
  }

  StampPath take() { return std::move(out_); }

 private:
  struct Place {
    std::uint32_t move = 0;
    double fraction = 0;
  };

  /// True where the tool cuts from one move on to the other.
  bool joined(std::uint32_t from, std::uint32_t to) const {
    for (std::uint32_t m = from; m <= to; ++m)
      if (!selected_[m] || program_.state_of(program_.moves[m]).tool != program_.state_of(program_.moves[to]).tool)
        return false;
    return true;
  }

  Vec3 place_of(const Place& p) const { return nc::point_at(program_, program_.moves[p.move], p.fraction); }

  bool straight_past(std::uint32_t move, const Vec3& goal) const {
    const Vec3 from = out_.stamps.back().pose.tip_mm, chord = goal - from, vertex = program_.moves[move].end_mm - from;
    const double length = chord.norm();
    if (length <= kStraight_mm) return vertex.norm() <= kStraight_mm;
    const double along = vertex.dot(chord) / length;
    return along >= 0 && along <= length && (vertex - along / length * chord).norm() <= kStraight_mm;
  }

  /// Stamps up to a place, no farther apart than the axes' own.
  void reach(const Stamp& stamp, const Place& to) {
    const double from_fraction = at_.move == to.move ? at_.fraction : 0.0;
    const double way = (to.fraction - from_fraction) * nc::length_mm(program_, program_.moves[to.move]);
    const double step = stamp.feed_per_tooth_mm.norm();
    const int pieces = step > kStill_mm && way > kFarther * step ? static_cast<int>(std::ceil(way / step - 1e-9)) : 1;
    for (int i = 1; i <= pieces; ++i)
      put(stamp, {to.move, from_fraction + (to.fraction - from_fraction) * i / pieces}, false);
    at_ = to;
  }

  void put(const Stamp& like, const Place& at, bool first) {
    Stamp stamp = like;
    stamp.move = at.move;
    stamp.fraction = at.fraction;
    stamp.first = first;
    stamp.pose = nc::pose_at(program_, program_.moves[at.move], at.fraction);
    if (!first) stamp.feed_per_tooth_mm = stamp.pose.tip_mm - out_.stamps.back().pose.tip_mm;
    if (!first && stamp.feed_per_tooth_mm.norm() < kStill_mm) return;
    out_.stamps.push_back(stamp);
  }

  const nc::Interpretation& program_;
  const std::vector<bool>& selected_;
  StampPath out_;
  bool open_ = false;
  Place at_;                ///< of the last stamp, or a vertex that needed none
  std::uint32_t next_ = 0;  ///< moves before this one are covered
  Stamp last_;              ///< of the axes
};

}  // namespace

StampPath nominal_path(const nc::Interpretation& program, const std::vector<bool>& selected, const StampPath& path) {
  NominalBuilder builder(program, selected);
  for (const ToolRun& run : path.runs) {
    builder.begin_run(run);
    for (std::size_t k = run.from; k < run.from + run.count; ++k) {
      if (run.kind == RunKind::milling)
        builder.follow(path.stamps[k]);
      else
        builder.copy(path.stamps[k]);
    }
    const std::size_t after = run.from + run.count;
    builder.close(after < path.stamps.size() ? path.stamps[after].move
                                             : static_cast<std::uint32_t>(program.moves.size()));
    builder.end_run();
  }
  return builder.take();
}

}  // namespace camber::removal
