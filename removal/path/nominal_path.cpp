#include "removal/tool_path.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

namespace camber::removal {
namespace {

constexpr double kStraight_mm = 5e-5;  // a vertex nearer than this to the chord past it needs no stamp
constexpr double kFarther = 1.5;       // a step longer than this many feeds per tooth is divided
constexpr double kStill_mm = 1e-6;
constexpr double kStill = 1e-9;          // axis and spin
constexpr double kTurn_rad = kPi / 720;  // between stamps of a tip that stands still, where no motion is known

double turn_between(const ToolPose& a, const ToolPose& b) {
  if (a.axis == b.axis && a.spin_rad == b.spin_rad) return 0;
  return Eigen::AngleAxisd(Mat3(tool_frame(a).transpose() * tool_frame(b))).angle();
}

class NominalBuilder {
 public:
  NominalBuilder(const nc::Interpretation& program, const std::vector<bool>& selected,
                 const kinematics::PartPath* rotary, const TakeNominal& take)
      : program_(program), selected_(selected), rotary_(rotary), take_(take) {}

  void begin_run(const ToolRun& run) { runs_.push_back({run.tool, count_, 0, run.kind}); }
  void end_run() { runs_.back().count = count_ - runs_.back().from; }
  void copy(const Stamp& stamp) {
    newest_ = stamp;
    take_(runs_.back(), count_++, stamp);
  }

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
    const Vec3 goal = pose_of({stamp.move, stamp.fraction}).tip_mm;
    for (std::uint32_t m = at_.move; m < stamp.move; ++m)
      if (turns(m) || turns(m + 1) || !straight_past(m, goal)) reach(stamp, {m, 1});
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

  std::vector<ToolRun> take_runs() { return std::move(runs_); }

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

  ToolPose pose_of(const Place& p) const {
    return rotary_ ? rotary_->pose_at(p.move, p.fraction) : nc::pose_at(program_, program_.moves[p.move], p.fraction);
  }
  bool turns(std::uint32_t move) const { return rotary_ && rotary_->turn_rad(move) > 0; }
  double length_mm(std::uint32_t move) const {
    return rotary_ ? rotary_->length_mm(move) : nc::length_mm(program_, program_.moves[move]);
  }
  /// A turn of the tool counts as the way of a point beside the tip.
  static double with_turn(double way_mm, double turn_rad) {
    return way_mm + kinematics::PartPath::kLever_mm * turn_rad;
  }

  bool straight_past(std::uint32_t move, const Vec3& goal) const {
    const Vec3 from = newest_.pose.tip_mm, chord = goal - from, vertex = program_.moves[move].end_mm - from;
    const double length = chord.norm();
    if (length <= kStraight_mm) return vertex.norm() <= kStraight_mm;
    const double along = vertex.dot(chord) / length;
    return along >= 0 && along <= length && (vertex - along / length * chord).norm() <= kStraight_mm;
  }

  /// Stamps up to a place, no farther apart than the axes' own.
  void reach(const Stamp& stamp, const Place& to) {
    const double from_fraction = at_.move == to.move ? at_.fraction : 0.0;
    const int pieces = pieces_of(stamp, to.move, to.fraction - from_fraction);
    for (int i = 1; i <= pieces; ++i)
      put(stamp, {to.move, from_fraction + (to.fraction - from_fraction) * i / pieces}, false);
    at_ = to;
  }

  int pieces_of(const Stamp& stamp, std::uint32_t move, double fraction) const {
    double way = fraction * length_mm(move), step = stamp.feed_per_tooth_mm.norm();
    if (turns(move)) {
      const double turn_rad = fraction * rotary_->turn_rad(move);
      way = with_turn(way, turn_rad);
      step = with_turn(step, stamp.first ? 0 : turn_between(last_.pose, stamp.pose));
      if (step <= kStill_mm) step = with_turn(0, kTurn_rad);
    }
    return step > kStill_mm && way > kFarther * step ? static_cast<int>(std::ceil(way / step - 1e-9)) : 1;
  }

  void put(const Stamp& like, const Place& at, bool first) {
    Stamp stamp = like;
    stamp.move = at.move;
    stamp.fraction = at.fraction;
    stamp.first = first;
    stamp.pose = pose_of(at);
    if (!first) stamp.feed_per_tooth_mm = stamp.pose.tip_mm - newest_.pose.tip_mm;
    if (!first && still(stamp.pose)) return;
    copy(stamp);
  }

  bool still(const ToolPose& pose) const {
    const ToolPose& last = newest_.pose;
    return (pose.tip_mm - last.tip_mm).norm() < kStill_mm && (pose.axis - last.axis).norm() < kStill &&
           std::abs(pose.spin_rad - last.spin_rad) < kStill;
  }

  const nc::Interpretation& program_;
  const std::vector<bool>& selected_;
  const kinematics::PartPath* rotary_;
  const TakeNominal& take_;
  std::vector<ToolRun> runs_;
  std::size_t count_ = 0;
  Stamp newest_;  ///< that was taken
  bool open_ = false;
  Place at_;                ///< place of the last stamp, or of a vertex that needed none
  std::uint32_t next_ = 0;  ///< moves before this one are covered
  Stamp last_;              ///< last stamp of the axes
};

}  // namespace

struct NominalFollower::Impl {
  TakeNominal take;
  NominalBuilder builder;
  std::uint32_t moves;  ///< moves of the program
  std::optional<std::size_t> run_from{};

  Impl(const nc::Interpretation& program, const std::vector<bool>& selected, const kinematics::PartPath* rotary,
       TakeNominal take_)
      : take(std::move(take_)),
        builder(program, selected, rotary, take),
        moves(static_cast<std::uint32_t>(program.moves.size())) {}

  void end_run(std::uint32_t next_move) {
    if (!run_from) return;
    builder.close(next_move);
    builder.end_run();
  }
};

NominalFollower::NominalFollower(const nc::Interpretation& program, const std::vector<bool>& selected,
                                 const kinematics::PartPath* rotary, TakeNominal take)
    : impl_(std::make_unique<Impl>(program, selected, rotary, std::move(take))) {}
NominalFollower::~NominalFollower() = default;

void NominalFollower::add(const ToolRun& run, const Stamp& stamp) {
  if (impl_->run_from != run.from) {
    impl_->end_run(stamp.move);
    impl_->builder.begin_run(run);
    impl_->run_from = run.from;
  }
  if (run.kind == RunKind::milling)
    impl_->builder.follow(stamp);
  else
    impl_->builder.copy(stamp);
}

std::vector<ToolRun> NominalFollower::finish() {
  impl_->end_run(impl_->moves);
  return impl_->builder.take_runs();
}

std::vector<ToolRun> follow_nominal_path(const nc::Interpretation& program, const std::vector<bool>& selected,
                                         const StampPath& path, const kinematics::PartPath* rotary,
                                         const TakeNominal& take) {
  NominalFollower follower(program, selected, rotary, take);
  for (const ToolRun& run : path.runs)
    for (std::size_t k = run.from; k < run.from + run.count; ++k) follower.add(run, path.stamps[k]);
  return follower.finish();
}

StampPath nominal_path(const nc::Interpretation& program, const std::vector<bool>& selected, const StampPath& path,
                       const kinematics::PartPath* rotary) {
  StampPath out;
  // Room for a few more than the axes have: a list that doubles would be in memory one and a half times.
  out.stamps.reserve(path.stamps.size() + path.stamps.size() / 8);
  out.runs = follow_nominal_path(program, selected, path, rotary,
                                 [&](const ToolRun&, std::size_t, const Stamp& stamp) { out.stamps.push_back(stamp); });
  return out;
}

}  // namespace camber::removal
