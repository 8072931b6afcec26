#include "calib/traced_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "feedmodel/path_tracker.h"

namespace camber::calib {
namespace {

using feedmodel::PathPlace;
using feedmodel::TimedSample;

constexpr double kStill_mm = 1e-3;    ///< axes that move less from sample to sample rest
constexpr double kSkipped_mm = 1.0;   ///< more of the cut between two samples than this and thrice their distance
constexpr double kWindow_mm = 0.5;    ///< how far ahead a place is looked for, beyond what the axes went
constexpr double kLeftOver_mm = 1.0;  ///< what may be missing of the last cut

bool is_cutting(const nc::Move& move) { return move.kind == nc::MoveKind::linear || move.kind == nc::MoveKind::arc; }

class Matcher {
 public:
  Matcher(const ServoTrace& trace, const nc::Program& text, const nc::Interpretation& program,
          const std::vector<bool>& cut, Diagnostics& diagnostics)
      : trace_(trace),
        name_(std::filesystem::path(text.source.name()).filename().string()),
        lines_(text.source.line_count()),
        program_(program),
        cut_(cut),
        diagnostics_(diagnostics) {}

  TracedMotion run() {
    check_columns();
    out_.by_line = !trace_.line.empty();
    out_.period_s = trace_.period_s;
    out_.by_line ? match_by_line() : match_by_place();
    check_cut();
    add_times();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(std::size_t sample, std::string message, std::string check) {
    const std::size_t row = sample < trace_.row.size() ? trace_.row[sample] : 0;
    diagnostics_.add({.severity = Severity::error,
                      .location = {trace_.path, row, row > 0 ? std::size_t{1} : 0},
                      .message = std::move(message),
                      .check = std::move(check),
                      .source_line = {}});
    diagnostics_.throw_if_errors();
    throw InputError({});
  }

  void check_columns() {
    std::vector<std::string> missing;
    for (std::size_t a = 0; a < 3; ++a)
      if (!trace_.has_actual[a]) missing.push_back(fmt::format("{}_act_mm", "xyz"[a]));
    if (missing.empty()) return;
    fail(trace_.size(),
         fmt::format("the trace has no {}; x_act_mm, y_act_mm and z_act_mm, where the axes were, are expected",
                     fmt::join(missing, " and no ")),
         "trace-column");
  }

  bool has_command() const { return trace_.has_command == std::array<bool, 3>{true, true, true}; }
  const Vec3& command(std::size_t i) const { return has_command() ? trace_.command_mm[i] : trace_.actual_mm[i]; }
  std::size_t line_of(std::uint32_t move) const { return program_.moves[move].block + 1; }

  Vec3 velocity(std::size_t i) const {
    const std::size_t before = i > 0 ? i - 1 : i, after = std::min(i + 1, trace_.size() - 1);
    return (trace_.actual_mm[after] - trace_.actual_mm[before]) / (trace_.t_s[after] - trace_.t_s[before]);
  }

  void add(std::size_t i, std::uint32_t move, bool rests) {
    const nc::Move& m = program_.moves[move];
    TimedSample s{trace_.t_s[i], command(i), trace_.actual_mm[i], velocity(i), 0, move};
    if (!rests) s.feed_command_mm_per_s = is_cutting(m) ? m.feed_mm_per_s : s.velocity_mm_per_s.norm();
    out_.samples.push_back(s);
  }

  void match_by_line() {
    // The moves of each line, ascending.
    std::vector<std::vector<std::uint32_t>> moves_of(lines_ + 1);
    for (std::uint32_t m = 0; m < program_.moves.size(); ++m)
      if (line_of(m) <= lines_) moves_of[line_of(m)].push_back(m);
    std::vector<std::uint32_t> move(trace_.size());
    std::uint32_t at = 0;
    for (std::size_t i = 0; i < trace_.size(); ++i) {
      if (trace_.line[i] != 0 && (i == 0 || trace_.line[i] != trace_.line[i - 1])) at = next_move(i, at, moves_of);
      move[i] = at;
    }
    // A control may run merged lines under the number of the first of them.
    for (std::size_t from = 0, end = 0; from < trace_.size(); from = end) {
      while (end < trace_.size() && move[end] == move[from]) ++end;
      const auto after_all = static_cast<std::uint32_t>(program_.moves.size());
      const std::uint32_t to = last_before(move[from], end < trace_.size() ? move[end] : after_all);
      for (std::size_t i = from; i < end; ++i) add(i, to, trace_.line[i] == 0);
    }
  }

  /// The last of the cutting moves that follow `own` before `next` without a break.
  std::uint32_t last_before(std::uint32_t own, std::uint32_t next) const {
    if (!is_cutting(program_.moves[own])) return own;
    while (own + 1 < next && is_cutting(program_.moves[own + 1])) ++own;
    return own;
  }

  /// The last of the moves that a newly commanded line makes in one go.
  std::uint32_t next_move(std::size_t i, std::uint32_t at, const std::vector<std::vector<std::uint32_t>>& moves_of) {
    const std::uint32_t line = trace_.line[i];
    if (line > lines_)
      fail(i,
           fmt::format("line {} is commanded, but {} has {} lines; a trace of this program was expected", line, name_,
                       lines_),
           "trace-program");
    const auto& moves = moves_of[line];
    if (moves.empty()) return at;  // no motion: a spindle or coolant word
    auto next = std::ranges::lower_bound(moves, at);
    if (next == moves.end())
      fail(i,
           fmt::format("line {} is commanded after line {}, but {} does not run in this order; a trace of this "
                       "program was expected",
                       line, line_of(at), name_),
           "trace-program");
    std::uint32_t last = *next;
    while (++next != moves.end() && *next == last + 1) last = *next;
    return last;
  }

  void match_by_place() {
    feedmodel::PathTracker tracker(program_);
    PathPlace place;
    for (std::size_t i = 0; i < trace_.size(); ++i) {
      const Vec3& at = command(i);
      const double went_mm = i > 0 ? (at - command(i - 1)).norm() : 0;
      TimedSample s;
      s.t_s = trace_.t_s[i];
      s.command_mm = s.position_mm = at;
      s.move = furthest(place, at, kWindow_mm + went_mm);
      place = tracker(s);
      add(i, place.move, went_mm == 0 && i > 0);
    }
  }

  /// The last move that begins within a length of path from a place. Of a move to or from an unknown place only the
  /// end is known: it is over when the tool is there, and begins where the move before ends.
  std::uint32_t furthest(const PathPlace& from, const Vec3& at, double length_mm) const {
    constexpr double kThere_mm = 0.01;
    const auto& moves = program_.moves;
    const auto left_mm = [&](std::uint32_t m, double u) {
      return moves[m].reference ? 0.0 : (1 - u) * nc::length_mm(program_, moves[m]);
    };
    std::uint32_t move = from.move;
    if (moves[move].reference && (at - moves[move].end_mm).norm() > kWindow_mm) return move;
    double room_mm = length_mm - left_mm(move, from.u);
    while (room_mm > 0 && move + 1 < moves.size()) {
      if (moves[move + 1].reference && (move != from.move || left_mm(move, from.u) > kThere_mm)) break;
      room_mm -= left_mm(++move, 0);
    }
    return move;
  }

  /// Length of the moves to be cut between two places.
  double cut_between_mm(const PathPlace& from, const PathPlace& to) const {
    double length = 0;
    for (std::uint32_t m = from.move; m <= to.move; ++m) {
      if (!cut_[m]) continue;
      const double begin = m == from.move ? from.u : 0, end = m == to.move ? to.u : 1;
      length += std::max(0.0, end - begin) * nc::length_mm(program_, program_.moves[m]);
    }
    return length;
  }

  void check_cut() {
    std::vector<std::size_t> after_gap;
    for (std::size_t s = 1; s < trace_.stretches.size(); ++s) after_gap.push_back(trace_.stretches[s].first);
    feedmodel::PathTracker tracker(program_);
    std::vector<double> off_mm;
    PathPlace before;
    auto gap = after_gap.begin();
    for (std::size_t i = 0; i < trace_.size(); ++i) {
      const PathPlace place = tracker(out_.samples[i]);
      const double went_mm = i > 0 ? (trace_.actual_mm[i] - trace_.actual_mm[i - 1]).norm() : 0;
      const double cut_mm = cut_between_mm(before, place);
      if (gap != after_gap.end() && *gap == i) {
        ++gap;
        if (cut_mm > kStill_mm) fail_on_gap(i, before, place);
      }
      if (cut_mm > kSkipped_mm + 3 * went_mm) fail_on_skip(i, before, place, cut_mm);
      if (cut_[place.move]) check_distance(i, place, off_mm);
      before = place;
    }
    check_end(before);
    set_distances(off_mm);
  }

  void fail_on_gap(std::size_t i, const PathPlace& before, const PathPlace& place) {
    const PathPlace& in_cut = cut_[place.move] ? place : before;
    fail(i,
         fmt::format("{:.6g} s are missing before {:.6g} s, in the cut of line {} of {}; a trace without gaps in the "
                     "cut was expected",
                     trace_.t_s[i] - trace_.t_s[i - 1] - trace_.period_s, trace_.t_s[i], line_of(in_cut.move), name_),
         "trace-gap");
  }

  void fail_on_skip(std::size_t i, const PathPlace& before, const PathPlace& place, double cut_mm) {
    fail(i,
         fmt::format("the axes go from line {} to line {} of {} without {:.3g} mm of the cut between them; a trace of "
                     "the whole cut was expected",
                     line_of(before.move), line_of(place.move), name_, cut_mm),
         "trace-program");
  }

  void check_distance(std::size_t i, const PathPlace& place, std::vector<double>& off_mm) {
    off_mm.push_back(place.distance_mm);
    if (place.distance_mm <= kMaxOffPath_mm) return;
    const Vec3& p = trace_.actual_mm[i];
    fail(i,
         fmt::format("the axes are {:.3g} mm off line {} of {} (at X{:.3f} Y{:.3f} Z{:.3f}); a trace of this program, "
                     "in the same work offset, was expected",
                     place.distance_mm, line_of(place.move), name_, p.x(), p.y(), p.z()),
         "trace-program");
  }

  void check_end(const PathPlace& end) {
    std::uint32_t last = static_cast<std::uint32_t>(cut_.size());
    while (last > 0 && !cut_[last - 1]) --last;
    if (last == 0) return;
    const PathPlace cut_end{last - 1, 1, 0};
    if (end.move > cut_end.move || cut_between_mm(end, cut_end) <= kLeftOver_mm) return;
    std::uint32_t first = 0;
    while (!cut_[first]) ++first;
    // Matched by place alone, another program or another work offset looks like a trace that ends too early.
    if (!out_.by_line && end.move < first)
      fail(trace_.size() - 1,
           fmt::format("the axes never come to line {} of {}, the first that is cut; a trace of this program, in the "
                       "same work offset, was expected",
                       line_of(first), name_),
           "trace-program");
    if (end.move == cut_end.move)
      fail(trace_.size() - 1,
           fmt::format("the trace ends in the middle of line {} of {}, the last that is cut; a trace of all of it was "
                       "expected",
                       line_of(end.move), name_),
           "trace-end");
    fail(trace_.size() - 1,
         fmt::format("the trace ends in line {} of {}; it was expected to go on to line {}, the last that is cut",
                     line_of(end.move), name_, line_of(cut_end.move)),
         "trace-end");
  }

  void set_distances(std::vector<double>& off_mm) {
    if (off_mm.empty()) return;
    out_.off_path_max_mm = *std::ranges::max_element(off_mm);
    const auto p95 = off_mm.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(off_mm.size() - 1));
    std::nth_element(off_mm.begin(), p95, off_mm.end());
    out_.off_path_p95_mm = *p95;
    if (*p95 <= kMaxTypicalOffPath_mm) return;
    fail(trace_.size(),
         fmt::format("in the cut, a twentieth of the samples is {:.3g} mm or more off the path of {}; a trace of this "
                     "program, in the same work offset, was expected",
                     *p95, name_),
         "trace-program");
  }

  void add_times() {
    std::size_t first = trace_.size(), last = 0;
    for (std::size_t i = 1; i < trace_.size(); ++i) {
      if ((trace_.actual_mm[i] - trace_.actual_mm[i - 1]).norm() > kStill_mm / 10) {
        first = std::min(first, i - 1);
        last = i;
      }
      const TimedSample& s = out_.samples[i];
      if (s.feed_command_mm_per_s > 0 && is_cutting(program_.moves[s.move]))
        out_.cutting_time_s += trace_.t_s[i] - trace_.t_s[i - 1];
    }
    if (last > first) out_.time_s = trace_.t_s[last] - trace_.t_s[first];
  }

  const ServoTrace& trace_;
  std::string name_;
  std::size_t lines_;
  const nc::Interpretation& program_;
  const std::vector<bool>& cut_;
  Diagnostics& diagnostics_;
  TracedMotion out_;
};

}  // namespace

TracedMotion traced_motion(const ServoTrace& trace, const nc::Program& text, const nc::Interpretation& program,
                           const std::vector<bool>& cut, Diagnostics& diagnostics) {
  return Matcher(trace, text, program, cut, diagnostics).run();
}

}  // namespace camber::calib
