#include "report/path_picture.h"

#include <algorithm>
#include <cmath>

namespace camber::report {
namespace {

constexpr double kChordShare = 1.0 / 20000;  ///< of the greatest extent
constexpr std::size_t kLongestStep = 48;     ///< points that are left out at once

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
  Drawer(const nc::Interpretation& program, const BlockRanges& rewritten) : program_(program), rewritten_(rewritten) {}

  PathPicture draw(double chord_mm) {
    out_.chord_mm = chord_mm;
    for (const nc::Move& m : program_.moves) {
      if (m.kind == nc::MoveKind::dwell || m.reference || m.start_mm == m.end_mm) {
        if (m.kind != nc::MoveKind::arc) continue;  // a full turn ends where it starts
      }
      if (out_.points.empty() || m.start_mm != out_.points.back()) add(m.start_mm, PathKind::start, m.block, true);
      const PathKind kind = kind_of(m);
      int n = 1;
      if (m.kind == nc::MoveKind::arc) {
        const nc::Arc& arc = program_.arcs[m.arc];
        const double radius = std::max((m.start_mm - arc.center_mm).norm(), chord_mm);
        n = std::max(6, static_cast<int>(std::ceil(std::abs(arc.sweep_rad) / (2 * std::acos(1 - chord_mm / radius)))));
      }
      for (int i = 1; i <= n; ++i)
        add(i == n ? m.end_mm : nc::point_at(program_, m, static_cast<double>(i) / n), kind, m.block, i == n);
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

  void add(const Vec3& p, PathKind kind, std::uint32_t block, bool end) {
    out_.points.push_back(p);
    out_.kind.push_back(kind);
    out_.block.push_back(block);
    out_.ends.push_back(end ? 1 : 0);
  }

  const nc::Interpretation& program_;
  const BlockRanges& rewritten_;
  PathPicture out_;
};

double to_segment_mm(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double t = ab.squaredNorm() > 0 ? std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * ab).norm();
}

PathPicture thinned(const PathPicture& full, double chord_mm) {
  PathPicture out;
  out.chord_mm = full.chord_mm + chord_mm;
  out.thinned = true;
  const auto take = [&](std::size_t k) {
    out.points.push_back(full.points[k]);
    out.kind.push_back(full.kind[k]);
    out.block.push_back(full.block[k]);
    out.ends.push_back(full.ends[k]);
  };
  const std::size_t n = full.points.size();
  take(0);
  for (std::size_t at = 0; at + 1 < n;) {
    std::size_t to = at + 1;
    const auto fits = [&](std::size_t end) {
      if (full.kind[end] != full.kind[at + 1]) return false;
      for (std::size_t k = at + 1; k < end; ++k)
        if (to_segment_mm(full.points[k], full.points[at], full.points[end]) > chord_mm) return false;
      return true;
    };
    while (to + 1 < n && to - at < kLongestStep && fits(to + 1)) ++to;
    take(to);
    at = to;
  }
  return out;
}

}  // namespace

PathPicture path_picture(const nc::Interpretation& program, const BlockRanges& rewritten, std::size_t max_points) {
  double chord = kChordShare * extent_mm(program);
  const PathPicture full = Drawer(program, rewritten).draw(chord);
  if (full.points.size() <= max_points) return full;
  PathPicture out = thinned(full, chord);
  while (out.points.size() > max_points && chord < 1e6) {
    chord *= 2;
    out = thinned(full, chord);
  }
  return out;
}

}  // namespace camber::report
