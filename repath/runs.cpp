// Which blocks may be rewritten together.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "nc/arcs.h"
#include "repath/compress.h"
#include "repath/program_point.h"

namespace camber::repath {
namespace {

constexpr double kStandsStillMm = 1e-9;

class RunFinder {
 public:
  RunFinder(const nc::Program& program, const nc::Interpretation& moves, RunKind kind)
      : program_(program), moves_(moves), kind_(kind), jumps_(program.macro.flow()) {}

  std::vector<Run> find() {
    const auto& all = moves_.moves;
    for (std::uint32_t m = 0; m < all.size(); ++m) {
      const unsigned still = fits(m);
      if (still == 0) {
        close(m);
        continue;
      }
      if (open_ && (!continues(m) || (still_ & still) == 0)) close(m);
      still_ = open_ ? still_ & still : still;
      if (!open_) first_ = m, open_ = true;
    }
    close(static_cast<std::uint32_t>(all.size()));
    return std::move(runs_);
  }

 private:
  /// A bit for every axis that the move does not move; 0: not a block for a run.
  unsigned fits(std::uint32_t m) const {
    const nc::Move& move = moves_.moves[m];
    const bool arc = move.kind == nc::MoveKind::arc && kind_ == RunKind::with_arcs;
    if ((move.kind != nc::MoveKind::linear && !arc) || !move.editable || move.canned || move.reference) return 0;
    if ((m > 0 && moves_.moves[m - 1].block == move.block) ||
        (m + 1 < moves_.moves.size() && moves_.moves[m + 1].block == move.block))
      return 0;
    const nc::ModalState& state = moves_.state_of(move);
    const nc::Frame& frame = moves_.frame_of(move);
    if (state.feed_mode != nc::FeedMode::per_minute || state.cutter_radius || !frame.shift_only || frame.polar ||
        state.path_control == nc::PathControl::exact_stop)
      return 0;
    if (!plain_block(move.block)) return 0;
    constexpr unsigned kAll = 7;
    if (in_space()) return kAll;
    unsigned still = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(move.end_mm[axis] - move.start_mm[axis]) < kStandsStillMm) still |= 1u << axis;
    return still;
  }

  bool plain_block(std::uint32_t b) const {
    const nc::Block& block = program_.blocks[b];
    if (block.skip != 0 || block.flow) return false;
    std::size_t at = block.offset;
    const std::string& text = program_.source.text();
    const auto blank = [&](std::size_t to) {
      for (; at < to; ++at)
        if (text[at] != ' ' && text[at] != '\t') return false;
      return true;
    };
    for (const nc::Word& w : program_.words_of(b)) {
      if (std::isnan(w.value) || !blank(w.offset)) return false;
      at = w.offset + w.length;
      const bool coordinate = w.letter >= 'X' && w.letter <= 'Z';
      if (coordinate || w.letter == 'F' || (w.letter == 'G' && w.value == 1)) continue;
      if (kind_ == RunKind::with_arcs && of_arc(w)) continue;
      if (w.letter == 'N' && !jumps_) continue;
      return false;
    }
    return blank(block.offset + block.length);
  }

  static bool of_arc(const nc::Word& w) {
    return (w.letter >= 'I' && w.letter <= 'K') || w.letter == 'R' ||
           (w.letter == 'G' && (w.value == 2 || w.value == 3));
  }

  bool in_space() const { return kind_ != RunKind::in_plane; }

  bool has_feed(std::uint32_t b) const {
    const auto words = program_.words_of(b);
    return std::any_of(words.begin(), words.end(), [](const nc::Word& w) { return w.letter == 'F'; });
  }

  bool continues(std::uint32_t m) const {
    const nc::Move &now = moves_.moves[m], &before = moves_.moves[m - 1];
    // Where the control stops (before an M code, say) the run ends and keeps its stop.
    return now.block == before.block + 1 && !before.exact_stop && now.state == before.state &&
           now.feed_mm_per_s == before.feed_mm_per_s && !has_feed(now.block);
  }

  void close(std::uint32_t behind) {
    if (open_ && behind - first_ >= 2) {
      const int plane_g = moves_.state_of(moves_.moves[first_]).plane_g;
      const int current = plane_g == 17 ? 2 : plane_g == 18 ? 1 : 0;
      Run run{.first_move = first_, .last_move = behind - 1, .normal = current, .in_space = in_space()};
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

  const nc::Program& program_;
  const nc::Interpretation& moves_;
  RunKind kind_;
  bool jumps_;
  std::vector<Run> runs_;
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
bool goes_on(const nc::Interpretation& moves, const Run& run, const Run& next) {
  const nc::Move &last = moves.moves[run.last_move], &first = moves.moves[next.first_move];
  if (next.first_move != run.last_move + 1 || last.exact_stop || run.normal != next.normal ||
      run.current_plane != next.current_plane || run.in_space != next.in_space)
    return false;
  const nc::ModalState &before = moves.state_of(last), &behind = moves.state_of(first);
  return before.frame == behind.frame && before.plane_g == behind.plane_g && before.inch == behind.inch &&
         before.tool == behind.tool;
}

}  // namespace

std::vector<Run> find_runs(const nc::Program& program, const nc::Interpretation& moves, RunKind kind) {
  return RunFinder(program, moves, kind).find();
}

std::vector<Run> runs_to_compress(const nc::Program& program, const nc::Interpretation& moves, bool apart) {
  constexpr std::uint32_t kMinMoves = 4;
  std::vector<Run> out, in_space = find_runs(program, moves, RunKind::in_space), planar;
  if (apart) planar = find_runs(program, moves, RunKind::in_plane);
  auto next = planar.begin();
  for (Run run : in_space) {
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
std::optional<Beside> beside(const nc::Interpretation& moves, const Run& run, bool before) {
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

RunChain chain_of(const nc::Interpretation& moves, std::span<const Run> runs) {
  const Run& first = runs.front();
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
    const Run& run = runs[out.parts.size()];
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

void for_each_chain(const nc::Interpretation& moves, std::span<const Run> runs,
                    const std::function<void(const RunChain&)>& take) {
  for (std::size_t k = 0, first = 0; k < runs.size(); ++k) {
    if (k + 1 < runs.size() && goes_on(moves, runs[k], runs[k + 1])) continue;
    take(chain_of(moves, runs.subspan(first, k + 1 - first)));
    first = k + 1;
  }
}

}  // namespace camber::repath
