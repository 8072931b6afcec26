#include "repath/resegment/resegmentation.h"

#include <algorithm>
#include <cmath>

#include "repath/program_point.h"
#include "repath/run_text.h"

namespace camber::repath {
namespace {

constexpr double kSmoothRad = 20 * kPi / 180;
constexpr double kMaxPerLineRad = kPi / 8;  ///< of the lines that stand for an arc; small arcs keep their shape
constexpr int kMinLines = 4;

bool is_arc(const nc::Move& m) { return m.kind == nc::MoveKind::arc; }

double radius_mm(const nc::Interpretation& moves, const nc::Move& m) {
  const nc::Arc& arc = moves.arcs[m.arc];
  const Vec3 from_centre = m.start_mm - arc.center_mm;
  return (from_centre - from_centre.dot(arc.normal) * arc.normal).norm();
}

/// Returns the radius of the curve in space: a helix has a larger one than its circle.
double radius_of_curvature_mm(const nc::Interpretation& moves, const nc::Move& m) {
  const double along = nc::length_mm(moves, m) / moves.arcs[m.arc].sweep_rad;
  return along * along / std::max(radius_mm(moves, m), 1e-9);
}

class Chooser {
 public:
  Chooser(const nc::Interpretation& moves, const BlockRun& run, const ShortArcRule& rule)
      : moves_(moves), run_(run), rule_(rule) {}

  bool stays(std::uint32_t m) const {
    if (!is_arc(moves_.moves[m])) return false;
    return !(is_short(m) && ((m > run_.first_move && is_short(m - 1) && smooth(m - 1)) ||
                             (m < run_.last_move && is_short(m + 1) && smooth(m))));
  }

 private:
  bool is_short(std::uint32_t k) const {
    const nc::Move& m = moves_.moves[k];
    double most = rule_.length_mm;
    if (is_arc(m)) most = std::min(most, std::sqrt(8 * radius_of_curvature_mm(moves_, m) * rule_.tolerance_mm));
    return nc::length_mm(moves_, m) < most;
  }

  /// At the end of move k.
  bool smooth(std::uint32_t k) const {
    const Vec3 in = nc::direction_at(moves_, moves_.moves[k], 1),
               out = nc::direction_at(moves_, moves_.moves[k + 1], 0);
    return in.dot(out) > std::cos(kSmoothRad);
  }

  const nc::Interpretation& moves_;
  const BlockRun& run_;
  const ShortArcRule& rule_;
};

}  // namespace

std::vector<BlockRun> between_arcs(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run,
                                   const ShortArcRule& rule) {
  const Chooser chooser(moves, run, rule);
  std::vector<BlockRun> out;
  const auto close = [&](std::uint32_t first, std::uint32_t behind) {
    while (behind > first && is_arc(moves.moves[behind - 1]) &&
           mode_is_used_behind(program, moves.moves[behind - 1].block))
      --behind;
    if (behind < first + 2) return;
    out.push_back(run);
    out.back().first_move = first;
    out.back().last_move = behind - 1;
  };
  std::uint32_t first = run.first_move;
  for (std::uint32_t m = run.first_move; m <= run.last_move; ++m) {
    if (!chooser.stays(m)) continue;
    close(first, m);
    first = m + 1;
  }
  close(first, run.last_move + 1);
  return out;
}

SpacePath space_path_of(const nc::Interpretation& moves, const BlockRun& run, double sagitta_mm) {
  SpacePath path;
  const auto add = [&](const nc::Move& move, const Vec3& p, std::uint32_t block) {
    const Vec3 point = program_point(moves, move, p);
    if (!path.points.empty() && path.points.back() == point) return;
    path.points.push_back(point);
    path.block.push_back(block);
  };
  const nc::Move& first = moves.moves[run.first_move];
  add(first, first.start_mm, first.block);
  for (std::uint32_t k = run.first_move; k <= run.last_move; ++k) {
    const nc::Move& m = moves.moves[k];
    if (is_arc(m)) {
      path.sagitta_mm = sagitta_mm;
      const double radius = std::max(radius_mm(moves, m), sagitta_mm);
      const double per_line = std::min(kMaxPerLineRad, 2 * std::acos(1 - sagitta_mm / radius));
      const int n = std::max(kMinLines, static_cast<int>(std::ceil(std::abs(moves.arcs[m.arc].sweep_rad) / per_line)));
      for (int i = 1; i < n; ++i) add(m, nc::point_at(moves, m, static_cast<double>(i) / n), SpacePath::kInside);
    }
    add(m, m.end_mm, m.block);
  }
  return path;
}

double segment_length_mm(double feed_mm_per_s, double block_time_s) { return feed_mm_per_s * block_time_s; }

double length_for(const nc::Interpretation& moves, const BlockRun& run, const ResegmentOptions& options) {
  constexpr double kMin = 0.01;
  if (options.length_mm > 0) return std::max(options.length_mm, kMin);
  double base = segment_length_mm(moves.moves[run.first_move].feed_mm_per_s, options.block_time_s);
  if (!(base > 0)) {
    for (std::uint32_t m = run.first_move; m <= run.last_move; ++m) base += nc::length_mm(moves, moves.moves[m]);
    base /= run.last_move - run.first_move + 1;
  }
  return std::max(options.length_factor * base, kMin);
}

}  // namespace camber::repath
