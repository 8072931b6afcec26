// Which blocks may be rewritten together.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "nc/arcs.h"
#include "repath/compress/compression.h"
#include "repath/plain_blocks.h"
#include "repath/program_point.h"

namespace camber::repath {
namespace {

constexpr double kStandsStillMm = 1e-9;

class RunFinder {
 public:
  RunFinder(const nc::Program& program, const nc::Interpretation& moves, RunKind kind)
      : moves_(moves), kind_(kind), blocks_(program, kind == RunKind::with_arcs) {}

  std::vector<BlockRun> find() {
    const auto& all = moves_.moves;
    for (std::uint32_t m = 0; m < all.size(); ++m) {
      unsigned still = 0;
      const Apart apart = is_cut(m) ? fits(m, still) : Apart::nothing;
      if (!is_cut(m) || apart != Apart::nothing || still == 0) {
        if (is_cut(m)) count(apart);
        close(m);
        continue;
      }
      if (open_) {
        const Apart from_last = continues(m);
        if (from_last != Apart::nothing) count(from_last);
        if (from_last != Apart::nothing || (still_ & still) == 0) close(m);
      }
      still_ = open_ ? still_ & still : still;
      if (!open_) first_ = m, open_ = true;
    }
    close(static_cast<std::uint32_t>(all.size()));
    return std::move(runs_);
  }

  const ApartCounts& apart() const { return apart_; }

 private:
  /// Returns the reason that keeps the move out of every run; `still`: a bit for every axis that it does not move.
  Apart fits(std::uint32_t m, unsigned& still) const {
    const nc::Move& move = moves_.moves[m];
    if (move.canned || move.reference) return Apart::not_editable;
    if ((m > 0 && moves_.moves[m - 1].block == move.block) ||
        (m + 1 < moves_.moves.size() && moves_.moves[m + 1].block == move.block))
      return Apart::several;
    const nc::ModalState& state = moves_.state_of(move);
    const nc::Frame& frame = moves_.frame_of(move);
    if (state.cutter_radius) return Apart::radius;
    if (!move.editable) return Apart::not_editable;
    if (state.feed_mode != nc::FeedMode::per_minute) return Apart::feed_mode;
    if (!frame.shift_only || frame.polar) return Apart::frame;
    if (state.path_control == nc::PathControl::exact_stop) return Apart::stop;
    constexpr unsigned kAll = 7;
    still = in_space() ? kAll : 0;
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(move.end_mm[axis] - move.start_mm[axis]) < kStandsStillMm) still |= 1u << axis;
    return blocks_.apart(move.block, true);
  }

  bool is_cut(std::uint32_t m) const {
    const nc::MoveKind kind = moves_.moves[m].kind;
    return kind == nc::MoveKind::linear || (kind == nc::MoveKind::arc && kind_ == RunKind::with_arcs);
  }

  bool in_space() const { return kind_ != RunKind::in_plane; }

  /// Returns the reason that keeps the move apart from the one before it.
  Apart continues(std::uint32_t m) const {
    const nc::Move &now = moves_.moves[m], &before = moves_.moves[m - 1];
    // Where the control stops (before an M code, say) the run ends and keeps its stop.
    if (before.exact_stop) return Apart::stop;
    if (now.block != before.block + 1) return Apart::between;
    if (now.feed_mm_per_s != before.feed_mm_per_s) return Apart::feed;
    if (now.state != before.state) return Apart::state;
    return blocks_.apart(now.block, false);
  }

  void close(std::uint32_t behind) {
    if (open_ && behind - first_ >= 2) {
      const int plane_g = moves_.state_of(moves_.moves[first_]).plane_g;
      const int current = plane_g == 17 ? 2 : plane_g == 18 ? 1 : 0;
      BlockRun run{.first_move = first_, .last_move = behind - 1, .normal = current, .in_space = in_space()};
      run.current_plane = (still_ >> current) & 1u;
      for (int axis = 2; !run.current_plane && axis >= 0; --axis)
        if ((still_ >> axis) & 1u) {
          run.normal = axis;
          break;
        }
      runs_.push_back(run);
    }
    open_ = false;
  }

  void count(Apart apart) { ++apart_[static_cast<std::size_t>(apart)]; }

  const nc::Interpretation& moves_;
  RunKind kind_;
  PlainBlocks blocks_;
  ApartCounts apart_{};
  std::vector<BlockRun> runs_;
  bool open_ = false;
  std::uint32_t first_ = 0;
  unsigned still_ = 0;
};

/// The points of moves from first to last, repeated ones left out: add(point, block); behind each move reached(move).
template <class Add, class Reached>
void for_each_point(const nc::Interpretation& moves, std::uint32_t first, std::uint32_t last, Add add,
                    Reached reached) {
  std::optional<Vec3> before;
  const auto reach = [&](const nc::Move& move, const Vec3& p) {
    const Vec3 point = program_point(moves, move, p);
    if (before && *before == point) return;
    before = point;
    add(point, move.block);
  };
  reach(moves.moves[first], moves.moves[first].start_mm);
  for (std::uint32_t m = first; m <= last; ++m) {
    reach(moves.moves[m], moves.moves[m].end_mm);
    reached(m);
  }
}

/// Whether the path goes on from one run to the next without a stop, and both may be seen as one.
bool goes_on(const nc::Interpretation& moves, const BlockRun& run, const BlockRun& next) {
  const nc::Move &last = moves.moves[run.last_move], &first = moves.moves[next.first_move];
  if (next.first_move != run.last_move + 1 || last.exact_stop || run.normal != next.normal ||
      run.current_plane != next.current_plane || run.in_space != next.in_space)
    return false;
  const nc::ModalState &before = moves.state_of(last), &behind = moves.state_of(first);
  return before.frame == behind.frame && before.plane_g == behind.plane_g && before.inch == behind.inch &&
         before.tool == behind.tool;
}

}  // namespace

std::vector<BlockRun> find_runs(const nc::Program& program, const nc::Interpretation& moves, RunKind kind) {
  return RunFinder(program, moves, kind).find();
}

std::string why_unchanged(const nc::Program& program, const nc::Interpretation& moves, RunKind kind) {
  RunFinder finder(program, moves, kind);
  const std::vector<BlockRun> runs = finder.find();
  const auto cuts = std::ranges::count_if(
      moves.moves, [](const nc::Move& m) { return m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc; });
  const ApartCounts& apart = finder.apart();
  const auto most = std::ranges::max_element(apart.begin() + 1, apart.end());
  std::string why = fmt::format("{} cuts in {} runs", cuts, runs.size());
  if (*most > 0)
    why += fmt::format("; what ends runs most often ({} times) is {}", *most,
                       reason_of(static_cast<Apart>(most - apart.begin())));
  return why;
}

std::vector<BlockRun> runs_to_compress(const nc::Program& program, const nc::Interpretation& moves, bool apart) {
  constexpr std::uint32_t kMinMoves = 4;
  std::vector<BlockRun> out, in_space = find_runs(program, moves, RunKind::in_space), planar;
  if (apart) planar = find_runs(program, moves, RunKind::in_plane);
  auto next = planar.begin();
  for (BlockRun run : in_space) {
    for (; next != planar.end() && next->last_move <= run.last_move; ++next) {
      if (next->current_plane || next->last_move - next->first_move + 1 < kMinMoves) continue;
      if (next->first_move > run.first_move + 1) {
        out.push_back(run);
        out.back().last_move = next->first_move - 1;
      }
      out.push_back(*next);
      run.first_move = next->last_move + 1;
    }
    if (run.last_move > run.first_move) out.push_back(run);
  }
  return out;
}

namespace {

struct Beside {
  Vec3 place_mm;  ///< in the text's coordinates
  bool arc = false;
};

/// The far end of the cut before or behind a run, or of a piece of its tangent where it is an arc; nothing where the
/// path does not go on smoothly for all that the text says, or not in the run's plane.
std::optional<Beside> beside(const nc::Interpretation& moves, const BlockRun& run, bool before) {
  const std::size_t at = before ? run.first_move : run.last_move, next = before ? at - 1 : at + 1;
  if ((before && at == 0) || next >= moves.moves.size()) return std::nullopt;
  const nc::Move &own = moves.moves[at], &other = moves.moves[next];
  const bool arc = other.kind == nc::MoveKind::arc;
  if ((other.kind != nc::MoveKind::linear && !arc) || other.canned || other.reference ||
      (before ? other : own).exact_stop)
    return std::nullopt;
  const nc::ModalState &here = moves.state_of(own), &there = moves.state_of(other);
  if (here.frame != there.frame || here.tool != there.tool) return std::nullopt;
  constexpr double kTangentMm = 1;
  Vec3 place = before ? other.start_mm : other.end_mm;
  const Vec3 joint = before ? other.end_mm : other.start_mm;
  if (arc) place = joint + (before ? -kTangentMm : kTangentMm) * nc::direction_at(moves, other, before ? 1 : 0);
  const Vec3 way = program_point(moves, other, place) - program_point(moves, other, joint);
  if (way.norm() == 0 || (!run.in_space && std::abs(way[run.normal]) > kStandsStillMm)) return std::nullopt;
  return Beside{program_point(moves, other, joint) + way, arc};
}

RunChain chain_of(const nc::Interpretation& moves, std::span<const BlockRun> runs) {
  const BlockRun& first = runs.front();
  const nc::PlaneAxes axes = nc::axes_of(first.normal == 2   ? nc::Plane::xy
                                         : first.normal == 1 ? nc::Plane::zx
                                                             : nc::Plane::yz);
  RunChain out;
  RunPath& path = out.path;
  const auto before = beside(moves, first, true), behind = beside(moves, runs.back(), false);
  const auto add = [&](const Vec3& p, std::uint32_t block) {
    path.points.emplace_back(p[axes.first], p[axes.second]);
    if (first.in_space) path.heights.push_back(p[axes.normal]);
    path.block.push_back(block);
  };
  if (before) add(before->place_mm, moves.moves[first.first_move].block);
  const auto begin = static_cast<std::uint32_t>(path.points.size());
  for_each_point(moves, first.first_move, runs.back().last_move, add, [&](std::uint32_t m) {
    const BlockRun& run = runs[out.parts.size()];
    if (m != run.last_move) return;
    const auto here = static_cast<std::uint32_t>(path.points.size() - 1);
    out.parts.push_back({run, out.parts.empty() ? begin : out.parts.back().last_point, here});
  });
  if (behind) add(behind->place_mm, moves.moves[runs.back().last_move].block);
  out.arc_before = before && before->arc;
  out.arc_behind = behind && behind->arc;
  if (begin > 0) out.ends.push_back(begin);
  for (const RunChain::Part& part : out.parts)
    if (part.last_point > begin && (out.ends.empty() || out.ends.back() < part.last_point))
      out.ends.push_back(part.last_point);
  if (!behind && !out.ends.empty() && out.ends.back() + 1 == path.points.size()) out.ends.pop_back();
  return out;
}

}  // namespace

void for_each_chain(const nc::Interpretation& moves, std::span<const BlockRun> runs,
                    const std::function<void(const RunChain&)>& take) {
  for (std::size_t k = 0, first = 0; k < runs.size(); ++k) {
    if (k + 1 < runs.size() && goes_on(moves, runs[k], runs[k + 1])) continue;
    take(chain_of(moves, runs.subspan(first, k + 1 - first)));
    first = k + 1;
  }
}

}  // namespace camber::repath
