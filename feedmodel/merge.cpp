#include "feedmodel/merge.h"

#include <algorithm>

namespace camber::feedmodel {
namespace {

bool may_follow(const nc::Move& run, const nc::Move& next) {
  return next.kind == nc::MoveKind::linear && !next.canned && next.state == run.state &&
         next.feed_mm_per_s == run.feed_mm_per_s;
}

double distance_to_line(const Vec3& point, const Vec3& from, const Vec3& to) {
  const Vec3 line = to - from;
  const double square = line.squaredNorm();
  const double u = square > 0 ? std::clamp((point - from).dot(line) / square, 0.0, 1.0) : 0.0;
  return (point - from - u * line).norm();
}

}  // namespace

double merge_tolerance_mm(const nc::ModalState& state, const machine::Control& control) {
  if (state.path_control != nc::PathControl::blend) return 0;
  if (state.merge_tolerance_mm >= 0) return state.merge_tolerance_mm;
  if (control.kind.g64_p_merges && state.blend_tolerance_mm >= 0) return state.blend_tolerance_mm;
  return control.merge_tolerance_mm;
}

std::size_t merged_run_end(std::span<const nc::Move> moves, std::size_t first, double tolerance_mm) {
  const nc::Move& run = moves[first];
  std::size_t end = first + 1;
  if (tolerance_mm <= 0 || run.kind != nc::MoveKind::linear || run.canned) return end;
  while (end < moves.size() && end - first < kMaxMergedLines && !moves[end - 1].exact_stop &&
         may_follow(run, moves[end])) {
    const bool fits = std::all_of(moves.begin() + first, moves.begin() + end, [&](const nc::Move& m) {
      return distance_to_line(m.end_mm, run.start_mm, moves[end].end_mm) <= tolerance_mm;
    });
    if (!fits) break;
    ++end;
  }
  return end;
}

}  // namespace camber::feedmodel
