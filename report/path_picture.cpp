#include "report/path_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.h"

namespace camber::report {
namespace {

constexpr double kChordFraction = 1.0 / 20000;  ///< of the greatest extent
constexpr std::size_t kLongestStep = 48;        ///< points that are left out at once
constexpr double kFeedStep = 1.0 / 50;          ///< of the highest feed: no eye tells such colours from each other
constexpr double kFeedStepGrowth = 1.25;        ///< programmed feeds change seldom: most points are saved elsewhere

bool cuts(const nc::Move& m) { return m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc; }

double extent_mm(const nc::Interpretation& program) {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (const nc::Move& m : program.moves)
    if (cuts(m)) {
      low = low.cwiseMin(m.start_mm).cwiseMin(m.end_mm);
      high = high.cwiseMax(m.start_mm).cwiseMax(m.end_mm);
    }
  return std::max(1e-3, (high - low).maxCoeff());
}

class Drawer {
 public:
  Drawer(const nc::Interpretation& program, const BlockRanges& rewritten, bool feeds)
      : program_(program), rewritten_(rewritten), feeds_(feeds) {}

  PathPicture draw(double chord_mm) {
    out_.chord_mm = chord_mm;
    for (const nc::Move& m : program_.moves) {
      if (m.kind == nc::MoveKind::dwell || m.reference || m.start_mm == m.end_mm) {
        if (m.kind != nc::MoveKind::arc) continue;  // a full turn ends where it starts
      }
      if (out_.points.empty() || m.start_mm != out_.points.back()) add(m.start_mm, PathKind::start, m, true);
      const PathKind kind = kind_of(m);
      int n = 1;
      if (m.kind == nc::MoveKind::arc) {
        const nc::Arc& arc = program_.arcs[m.arc];
        n = chords_of(arc.sweep_rad, (m.start_mm - arc.center_mm).norm(), chord_mm);
      }
      for (int i = 1; i <= n; ++i)
        add(i == n ? m.end_mm : nc::point_at(program_, m, static_cast<double>(i) / n), kind, m, i == n);
    }
    return std::move(out_);
  }

 private:
  PathKind kind_of(const nc::Move& m) const {
    if (m.kind == nc::MoveKind::rapid) return PathKind::rapid;
    const auto behind = std::upper_bound(rewritten_.begin(), rewritten_.end(), std::pair{m.block, ~0u});
    const bool changed = m.editable && behind != rewritten_.begin() && m.block <= std::prev(behind)->second;
    if (m.kind == nc::MoveKind::arc) return changed ? PathKind::arc : PathKind::kept_arc;
    return changed ? PathKind::line : PathKind::kept_line;
  }

  void add(const Vec3& p, PathKind kind, const nc::Move& move, bool end) {
    out_.points.push_back(p);
    out_.kind.push_back(kind);
    out_.block.push_back(move.block);
    out_.ends.push_back(end ? 1 : 0);
    if (!feeds_) return;
    out_.tool.push_back(static_cast<std::uint32_t>(std::max(0, program_.state_of(move).tool)));
    out_.feed_mm_per_min.push_back(feed_of(move));
  }

  const nc::Interpretation& program_;
  const BlockRanges rewritten_;
  const bool feeds_;
  PathPicture out_;
};

double to_segment_mm(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double t = ab.squaredNorm() > 0 ? std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * ab).norm();
}

/// The greatest of the finite ones; 0: none.
float greatest(const std::vector<float>& feeds) {
  float most = 0;
  for (const float feed : feeds)
    if (std::isfinite(feed)) most = std::max(most, feed);
  return most;
}

bool alike(const std::vector<float>& feeds, std::size_t a, std::size_t b, double step) {
  if (feeds.empty()) return true;
  if (std::isnan(feeds[a]) || std::isnan(feeds[b])) return std::isnan(feeds[a]) && std::isnan(feeds[b]);
  return std::abs(feeds[a] - feeds[b]) <= step;
}

class Thinner {
 public:
  Thinner(const PathPicture& full, double chord_mm, double feed_step, double speed_step)
      : full_(full), feed_step_(feed_step) {
    out_.chord_mm = full.chord_mm + chord_mm;
    out_.feed_step_mm_per_min = full.speed_mm_per_min.empty() ? feed_step : speed_step;
    out_.thinned = true;
  }

  PathPicture run(double chord_mm) {
    const std::size_t n = full_.points.size();
    take(0, 0);
    for (std::size_t at = 0; at + 1 < n;) {
      std::size_t to = at + 1;
      while (to + 1 < n && to - at < kLongestStep && fits(at, to + 1, chord_mm)) ++to;
      take(at + 1, to);
      at = to;
    }
    return std::move(out_);
  }

 private:
  bool fits(std::size_t at, std::size_t end, double chord_mm) const {
    const std::size_t first = at + 1;
    if (full_.kind[end] != full_.kind[first]) return false;
    if (!full_.tool.empty() && full_.tool[end] != full_.tool[first]) return false;
    if (!alike(full_.feed_mm_per_min, first, end, feed_step_) ||
        !alike(full_.speed_mm_per_min, first, end, out_.feed_step_mm_per_min))
      return false;
    for (std::size_t k = first; k < end; ++k)
      if (to_segment_mm(full_.points[k], full_.points[at], full_.points[end]) > chord_mm) return false;
    return true;
  }

  /// Mean speed over the ways to the points from `first` to `last`.
  float mean_speed(std::size_t first, std::size_t last) const {
    double way = 0, time = 0;
    for (std::size_t k = std::max<std::size_t>(first, 1); first < last && k <= last; ++k) {
      const double piece = (full_.points[k] - full_.points[k - 1]).norm();
      way += piece;
      time += piece / full_.speed_mm_per_min[k];
    }
    return way > 0 && time > 0 ? static_cast<float>(way / time) : full_.speed_mm_per_min[last];
  }

  void take(std::size_t first, std::size_t k) {
    out_.points.push_back(full_.points[k]);
    out_.kind.push_back(full_.kind[k]);
    out_.block.push_back(full_.block[k]);
    out_.ends.push_back(full_.ends[k]);
    if (!full_.tool.empty()) out_.tool.push_back(full_.tool[k]);
    if (!full_.feed_mm_per_min.empty()) out_.feed_mm_per_min.push_back(full_.feed_mm_per_min[k]);
    if (!full_.speed_mm_per_min.empty()) out_.speed_mm_per_min.push_back(mean_speed(first, k));
  }

  const PathPicture& full_;
  const double feed_step_;
  PathPicture out_;
};

}  // namespace

double picture_chord_mm(const nc::Interpretation& program) { return kChordFraction * extent_mm(program); }

int chords_of(double sweep_rad, double radius_mm, double chord_mm) {
  const double radius = std::max(radius_mm, chord_mm);
  return std::max(6, static_cast<int>(std::ceil(std::abs(sweep_rad) / (2 * std::acos(1 - chord_mm / radius)))));
}

float feed_of(const nc::Move& move) {
  if (!cuts(move)) return std::numeric_limits<float>::quiet_NaN();
  return static_cast<float>(mm_per_min_from_mm_per_s(move.feed_mm_per_s));
}

PathPicture thinned_picture(PathPicture full, double chord_mm, std::size_t most) {
  if (full.points.size() <= most) return full;
  double feed_step = kFeedStep * std::max(greatest(full.feed_mm_per_min), greatest(full.speed_mm_per_min));
  double speed_step = feed_step;
  PathPicture out = Thinner(full, chord_mm, feed_step, speed_step).run(chord_mm);
  while (out.points.size() > most && chord_mm < 1e6) {
    chord_mm *= 2;
    speed_step *= 2;
    feed_step *= kFeedStepGrowth;
    out = Thinner(full, chord_mm, feed_step, speed_step).run(chord_mm);
  }
  return out;
}

PathPicture path_picture(const nc::Interpretation& program, const BlockRanges& rewritten, std::size_t most) {
  const double chord_mm = picture_chord_mm(program);
  return thinned_picture(Drawer(program, rewritten, false).draw(chord_mm), chord_mm, most);
}

PathPicture program_picture(const nc::Interpretation& program, std::size_t most) {
  const double chord_mm = picture_chord_mm(program);
  return thinned_picture(Drawer(program, {}, true).draw(chord_mm), chord_mm, most);
}

}  // namespace camber::report
