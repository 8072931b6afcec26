#include "nc/summary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>

#include "base/units.h"

namespace camber::nc {
namespace {

/// Points of an arc where a coordinate is largest or smallest: there its radius points along that axis.
void add_bulge(const Interpretation& program, const Move& move, Extents& box) {
  const Arc& arc = program.arcs[move.arc];
  const Vec3 radius = move.start_mm - arc.center_mm;
  const Vec3 out = radius - radius.dot(arc.normal) * arc.normal;
  const Vec3 along = arc.normal.cross(out);
  for (int axis = 0; axis < 3; ++axis) {
    if (arc.normal[axis] != 0) continue;  // along the axis of the helix the ends are the extremes
    const double quarter = std::atan2(along[axis], out[axis]);
    const double sign = arc.sweep_rad < 0 ? -1 : 1;
    double turn = std::fmod(sign * quarter + 4 * kPi, kPi);
    for (int i = 0; i < 2 && turn < std::abs(arc.sweep_rad); ++i, turn += kPi)
      box.add(point_at(program, move, turn / std::abs(arc.sweep_rad)));
  }
}

/// Blocks with a change of the tool, ascending.
std::vector<std::size_t> tool_change_blocks(const Interpretation& program) {
  std::vector<std::size_t> blocks;
  for (const Event& event : program.events)
    if (event.kind == EventKind::tool_change) blocks.push_back(event.block);
  std::ranges::sort(blocks);
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

class Summarizer {
 public:
  Summarizer(const Program& text, const Interpretation& program)
      : program_(program), changes_(tool_change_blocks(program)) {
    s_.blocks = text.blocks.size();
    for (const Block& b : text.blocks) s_.blocks_with_words += b.word_count > 0;
  }

  Summary run() {
    count_rotary();
    for (std::size_t m = 0; m < program_.moves.size(); ++m) {
      const Move& move = program_.moves[m];
      count(move);
      if (move.kind == MoveKind::dwell) {
        s_.dwell_s += move.dwell_s;
      } else if (!move.reference && move.open_axes == 0 && !move.start_open) {
        measure(m, tool_of(move));
      }
    }
    return std::move(s_);
  }

 private:
  void count_rotary() {
    Vec3 angles = Vec3::Zero();
    for (const RotaryTarget& target : program_.rotary) {
      s_.rotary += target.is_direction || target.end != angles;
      angles = target.is_direction ? Vec3(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())) : target.end;
    }
  }

  void count(const Move& move) {
    s_.rapids += move.kind == MoveKind::rapid;
    s_.lines += move.kind == MoveKind::linear;
    s_.arcs += move.kind == MoveKind::arc;
    s_.dwells += move.kind == MoveKind::dwell;
    s_.canned += move.canned;
    s_.reference += move.reference;
    const ModalState& state = program_.state_of(move);
    s_.high_speed_contouring +=
        state.high_speed_contouring && (move.kind == MoveKind::linear || move.kind == MoveKind::arc);
    s_.cutter_radius += state.cutter_radius;
    s_.tip_control += state.tip_control != TipControl::off;
    s_.tilted_frame += state.work_frame == WorkFrame::tilted;
    s_.dynamic_offset += state.work_frame == WorkFrame::dynamic;
    (state.inch ? s_.has_inch : s_.has_mm) = true;
  }

  ToolUse& tool_of(const Move& move) {
    const int tool = program_.state_of(move).tool;
    const bool same = tool_ && *tool_ == tool;
    auto it = std::find_if(s_.tools.begin(), s_.tools.end(), [&](const ToolUse& t) { return t.tool == tool; });
    if (it == s_.tools.end()) {
      s_.tools.push_back({.tool = tool, .line = line_of_change(move.block)});
      it = s_.tools.end() - 1;
    }
    if (!same) ++it->calls;
    tool_ = tool;
    return *it;
  }

  std::size_t line_of_change(std::size_t block) const {
    const auto after = std::upper_bound(changes_.begin(), changes_.end(), block);
    return after == changes_.begin() ? block + 1 : *(after - 1) + 1;
  }

  void measure(std::size_t m, ToolUse& tool) {
    const Move& move = program_.moves[m];
    const double length = length_mm(program_, move);
    const Extents box = extents_of(program_, move);
    const bool rapid = move.kind == MoveKind::rapid;
    Extents& all = rapid ? s_.rapid : s_.cutting;
    all.add(box.min_mm);
    all.add(box.max_mm);
    (rapid ? s_.rapid_length_mm : s_.cutting_length_mm) += length;
    (rapid ? tool.rapid_length_mm : tool.cutting_length_mm) += length;
    if (rapid) return;
    ++tool.cutting_moves;
    if (only_turns(program_, m))
      tool.feed_deg_per_min.add(feed_deg_per_min(program_, move));
    else
      tool.feed_mm_per_min.add(mm_per_min_from_mm_per_s(move.feed_mm_per_s));
    tool.spindle_speed_rpm.add(program_.state_of(move).spindle_speed_rpm);
    tool.cutting.add(box.min_mm);
    tool.cutting.add(box.max_mm);
  }

  const Interpretation& program_;
  std::vector<std::size_t> changes_;
  std::optional<int> tool_;
  Summary s_;
};

}  // namespace

void Extents::add(const Vec3& point_mm) {
  min_mm = min_mm.cwiseMin(point_mm);
  max_mm = max_mm.cwiseMax(point_mm);
}

void Range::add(double value) {
  min = std::min(min, value);
  max = std::max(max, value);
}

Extents extents_of(const Interpretation& program, const Move& move) {
  Extents box;
  box.add(move.start_mm);
  box.add(move.end_mm);
  if (move.arc != Move::kNoArc) add_bulge(program, move, box);
  return box;
}

Summary summarize(const Program& text, const Interpretation& program) { return Summarizer(text, program).run(); }

}  // namespace camber::nc
