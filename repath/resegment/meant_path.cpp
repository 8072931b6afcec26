#include "repath/resegment/fastest.h"

#include <algorithm>
#include <cmath>

namespace camber::repath {
namespace {

constexpr double kAheadMm = 1.5;
constexpr double kArcStepMm = 0.05;
constexpr double kSameDistanceMm = 1e-9;

bool cuts(const nc::Move& m) { return m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc; }

/// Returns the number of each move's chain, from 1 on: chains are cutting moves that follow each other. 0: no cut.
std::vector<std::uint32_t> chains_of(const nc::Interpretation& program) {
  std::vector<std::uint32_t> out(program.moves.size(), 0);
  std::uint32_t chain = 0;
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (!cuts(program.moves[k])) continue;
    chain += k == 0 || out[k - 1] == 0;
    out[k] = chain;
  }
  return out;
}

}  // namespace

MeantPath::MeantPath(const nc::Interpretation& meant) {
  const auto add = [&](const Vec3& p) {
    const bool starts = points_.size() == first_.back();
    if (!starts && p == points_.back()) return;
    along_.push_back(starts ? 0 : along_.back() + (p - points_.back()).norm());
    points_.push_back(p);
  };
  const auto chains = chains_of(meant);
  for (std::size_t k = 0; k < chains.size(); ++k) {
    const nc::Move& m = meant.moves[k];
    if (chains[k] == 0) continue;
    if (first_.size() < chains[k]) {
      first_.push_back(points_.size());
      if (k > 0 && meant.moves[k - 1].kind == nc::MoveKind::rapid && !meant.moves[k - 1].reference)
        add(meant.moves[k - 1].start_mm);
      add(m.start_mm);
    }
    const double length = nc::length_mm(meant, m);
    const int n = m.kind == nc::MoveKind::arc ? std::max(1, static_cast<int>(std::ceil(length / kArcStepMm))) : 1;
    for (int i = 1; i <= n; ++i) add(nc::point_at(meant, m, static_cast<double>(i) / n));
  }
  first_.push_back(points_.size());
}

/// Tells how far a place that moves along the chains is away from them.
class Follower {
 public:
  explicit Follower(const MeantPath& meant) : first_(meant.first_), points_(meant.points_), along_(meant.along_) {}

  /// `chain`: from 1, never less than the time before. Of two segments as near as each other the later one counts:
  /// where a path goes back the way it came, a place whose lag cuts the turn would else stay on the way out.
  double distance_mm(const Vec3& p, std::uint32_t chain) {
    if (chain >= first_.size()) return 0;
    const std::size_t end = first_[chain];
    if (chain != chain_) at_ = first_[chain - 1], chain_ = chain;
    if (end - first_[chain - 1] < 2) return 0;
    Foot best = foot(p, at_);
    const double from = best.along_mm;
    for (std::size_t k = at_ + 1; k + 1 < end && along_[k] - from < kAheadMm + best.distance_mm; ++k)
      if (const Foot f = foot(p, k); f.distance_mm < best.distance_mm + kSameDistanceMm) best = f, at_ = k;
    return best.distance_mm;
  }

 private:
  /// The nearest point of segment k.
  struct Foot {
    double distance_mm, along_mm;
  };
  Foot foot(const Vec3& p, std::size_t k) const {
    const Vec3 a = points_[k], ab = points_[k + 1] - a;
    const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    return {(p - a - t * ab).norm(), along_[k] + t * (along_[k + 1] - along_[k])};
  }

  const std::vector<std::size_t>& first_;
  const std::vector<Vec3>& points_;
  const std::vector<double>& along_;
  std::size_t at_ = 0;
  std::uint32_t chain_ = 0;
};

ContourFigures contour_figures(const nc::Interpretation& program, const nc::Interpretation& meant,
                               const machine::Machine& machine) {
  return contour_figures(program, MeantPath(meant), machine, &program == &meant);
}

ContourFigures contour_figures(const nc::Interpretation& program, const MeantPath& meant,
                               const machine::Machine& machine, bool moves) {
  ContourFigures out;
  if (moves) out.move_s.assign(program.moves.size(), 0.0F);
  Follower follower(meant);
  const auto chains = chains_of(program);
  double squares = 0;
  std::size_t count = 0;
  const auto summary = feedmodel::predict_feed(program, machine, [&](std::span<const feedmodel::TimedSample> run) {
    for (const auto& sample : run) {
      if (moves) out.move_s[sample.move] += static_cast<float>(machine.control.period_s);
      if (chains[sample.move] == 0) continue;
      const double away = follower.distance_mm(sample.position_mm, chains[sample.move]);
      out.contour_max_mm = std::max(out.contour_max_mm, away);
      squares += away * away;
      ++count;
    }
  });
  out.time_s = summary.time_s;
  out.cutting_time_s = summary.cutting_time_s;
  out.contour_rms_mm = count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
  return out;
}

}  // namespace camber::repath
