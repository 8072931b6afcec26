#include "feedmodel/fitted_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numeric>
#include <optional>

#include "base/units.h"
#include "feedmodel/cycle_time.h"
#include "feedmodel/limits.h"
#include "feedmodel/modes.h"

namespace camber::feedmodel {
namespace {

constexpr double kBeyond = 1.1;  // so much past the range is not called beyond it
constexpr std::size_t kBlocksNamed = 5;
constexpr std::size_t kRunBlocks = 8;  // so many blocks in a row make a rate
constexpr double kMoves = 1e-6;        // mm; less is rounding of numbers

/// Demands of one feed move on the control.
struct Demand {
  double length_mm = 0, feed_mm_per_s = 0;
  double corner_rad = 0;    ///< angle at its start, against the feed move before it
  double radius_mm = 0;     ///< radius of curvature; 0: a line
  double blocks_per_s = 0;  ///< over the last kRunBlocks, 0 where fewer follow each other
  std::array<bool, 3> axis{};
};

bool is_feed(const nc::Move& move) {
  return (move.kind == nc::MoveKind::linear || move.kind == nc::MoveKind::arc) && !move.reference && !move.canned;
}

double curvature_radius(const nc::Interpretation& program, const nc::Move& move) {
  const nc::Arc& arc = program.arcs[move.arc];
  Vec3 spoke = move.start_mm - arc.center_mm;
  spoke -= arc.normal * arc.normal.dot(spoke);
  const double rise = arc.normal.dot(move.end_mm - move.start_mm);
  return helix_curvature_radius(spoke.norm(), rise / std::max(1e-12, std::abs(arc.sweep_rad)));
}

Demand demand_of(const nc::Interpretation& program, std::size_t i) {
  const nc::Move& move = program.moves[i];
  Demand d;
  d.length_mm = length_mm(program, move);
  d.feed_mm_per_s = move.feed_mm_per_s;
  if (i > 0 && is_feed(program.moves[i - 1])) {
    const Vec3 from = direction_at(program, program.moves[i - 1], 1.0), to = direction_at(program, move, 0.0);
    if (!from.isZero() && !to.isZero()) d.corner_rad = std::acos(std::clamp(from.dot(to), -1.0, 1.0));
  }
  const bool arc = move.kind == nc::MoveKind::arc && move.arc != nc::Move::kNoArc;
  if (arc) d.radius_mm = curvature_radius(program, move);
  for (int k = 0; k < 3; ++k) {
    const bool within_arc = arc && std::abs(program.arcs[move.arc].normal[k]) < 0.5;
    d.axis[k] = within_arc || std::abs(move.end_mm[k] - move.start_mm[k]) > kMoves;
  }
  return d;
}

template <class Use>
void for_each_demand(const nc::Interpretation& program, const Use& use) {
  std::deque<double> run;  // programmed times of the last blocks
  for (std::size_t i = 0; i < program.moves.size(); ++i) {
    if (!is_feed(program.moves[i])) continue;
    Demand d = demand_of(program, i);
    if (d.length_mm <= kMoves) continue;
    if (i == 0 || !is_feed(program.moves[i - 1])) run.clear();
    run.push_back(d.length_mm / d.feed_mm_per_s);
    if (run.size() > kRunBlocks) run.pop_front();
    if (run.size() == kRunBlocks)
      d.blocks_per_s = static_cast<double>(kRunBlocks) / std::accumulate(run.begin(), run.end(), 0.0);
    use(static_cast<std::uint32_t>(i), d);
  }
}

/// The machine, stopping at the end of every block: the slowest that its accelerations and block time allow for.
machine::Machine stopping(machine::Machine m) {
  const auto stop = [](machine::Control& control) {
    control.corner = {.law = machine::CornerLaw::exact_stop};
    control.merge_tolerance_mm = 0;
  };
  stop(m.control);
  for (auto& [name, mode] : m.modes) stop(mode);
  return m;
}

/// Between what times a guess lies: at the programmed feed, and with a stop after every block.
class GuessSize {
 public:
  GuessSize(const nc::Interpretation& program, const machine::Machine& machine)
      : program_(program), machine_(machine) {}

  /// Returns the range of these moves together.
  std::string of(const std::vector<std::uint32_t>& moves) {
    if (predicted_s_.empty()) {
      predicted_s_ = motion_times(program_, machine_).move_s;
      stopping_s_ = motion_times(program_, stopping(machine_)).move_s;
    }
    double predicted = 0, least = 0, most = 0;
    for (const std::uint32_t i : moves) {
      const nc::Move& move = program_.moves[i];
      predicted += predicted_s_[i];
      most += std::max(stopping_s_[i], predicted_s_[i]);
      least += length_mm(program_, move) / move.feed_mm_per_s * 100.0 / machine_.cycle.feed_override_percent;
    }
    return fmt::format("{:.3g} s, from {:.3g} s at the programmed feed to {:.3g} s with a stop after every block",
                       predicted, std::min(least, predicted), most);
  }

 private:
  const nc::Interpretation& program_;
  const machine::Machine& machine_;
  std::vector<double> predicted_s_, stopping_s_;
};

/// One way of leaving the range.
struct Beyond {
  double length_mm = 0;
  std::vector<std::uint32_t> lines, moves;

  void add(std::uint32_t index, const nc::Move& move, const Demand& d) {
    moves.push_back(index);
    length_mm += d.length_mm;
    if (lines.empty() || lines.back() != move.block + 1) lines.push_back(move.block + 1);
  }

  void report(const std::string& path, double cutting_length_mm, const std::string& what, const char* check,
              GuessSize& guess, Diagnostics& diagnostics) const {
    if (lines.empty()) return;
    std::string named;
    for (std::size_t i = 0; i < std::min(kBlocksNamed, lines.size()); ++i)
      named += fmt::format("{}{}", i > 0 ? ", " : "", lines[i]);
    if (lines.size() > kBlocksNamed) named += " ...";
    diagnostics.add(
        {.severity = Severity::warning,
         .location = {path, lines.front(), 1},
         .message = fmt::format(
             "{:.1f} % of the cutting length ({} block{}: {} {}) has {}; the time there is an extrapolation: {}",
             100 * length_mm / cutting_length_mm, lines.size(), lines.size() == 1 ? "" : "s",
             lines.size() == 1 ? "line" : "lines", named, what, guess.of(moves)),
         .check = check,
         .source_line = {}});
  }
};

void include(std::array<double, 2>& range, double value, bool first) {
  range = first ? std::array<double, 2>{value, value}
                : std::array<double, 2>{std::min(range[0], value), std::max(range[1], value)};
}

}  // namespace

machine::FittedRange range_of(const std::vector<const nc::Interpretation*>& programs) {
  machine::FittedRange range;
  bool first = true, first_line = true, first_arc = true, first_rate = true;
  for (const nc::Interpretation* program : programs) {
    for_each_demand(*program, [&](std::uint32_t, const Demand& d) {
      include(range.feed_mm_per_s, d.feed_mm_per_s, first);
      include(range.corner_rad, d.corner_rad, first);
      first = false;
      if (d.radius_mm > 0) {
        include(range.arc_radius_mm, d.radius_mm, first_arc);
        include(range.arc_mm, d.length_mm, first_arc);
        first_arc = false;
      } else {
        include(range.line_mm, d.length_mm, first_line);
        first_line = false;
      }
      if (d.blocks_per_s > 0) {
        include(range.blocks_per_s, d.blocks_per_s, first_rate);
        first_rate = false;
      }
      for (int k = 0; k < 3; ++k) range.axis[k] = range.axis[k] || d.axis[k];
    });
  }
  range.known = !first;
  return range;
}

void check_range(const nc::Interpretation& program, const std::string& program_path, const machine::Machine& machine,
                 Diagnostics& diagnostics) {
  check_modes(program, program_path, machine, diagnostics);
  const machine::FittedRange& r = machine.fitted_range;
  if (!r.known) return;
  Beyond feed, corner, line, arc, short_arc, rate;
  std::array<Beyond, 3> axis;
  double cutting_mm = 0;
  for_each_demand(program, [&](std::uint32_t i, const Demand& d) {
    const nc::Move& move = program.moves[i];
    cutting_mm += d.length_mm;
    if (d.feed_mm_per_s > kBeyond * r.feed_mm_per_s[1]) feed.add(i, move, d);
    if (d.corner_rad > kBeyond * r.corner_rad[1]) corner.add(i, move, d);
    if (d.blocks_per_s > kBeyond * r.blocks_per_s[1]) rate.add(i, move, d);
    if (d.radius_mm == 0 && d.length_mm * kBeyond < r.line_mm[0]) line.add(i, move, d);
    if (d.radius_mm > 0 && (r.arc_radius_mm[1] == 0 || d.radius_mm * kBeyond < r.arc_radius_mm[0])) arc.add(i, move, d);
    if (d.radius_mm > 0 && d.length_mm * kBeyond < r.arc_mm[0]) short_arc.add(i, move, d);
    for (int k = 0; k < 3; ++k)
      if (d.axis[k] && !r.axis[k]) axis[k].add(i, move, d);
  });
  GuessSize guess(program, machine);
  const auto tell = [&](const Beyond& beyond, const std::string& what, const char* check) {
    beyond.report(program_path, cutting_mm, what, check, guess, diagnostics);
  };
  tell(feed,
       fmt::format("a feed above {:.0f} mm/min, the highest that the machine was fitted on",
                   mm_per_min_from_mm_per_s(r.feed_mm_per_s[1])),
       "range-feed");
  tell(corner,
       fmt::format("a corner sharper than {:.1f} degrees, the sharpest that the machine was fitted on",
                   deg_from_rad(r.corner_rad[1])),
       "range-corner");
  tell(line, fmt::format("lines shorter than {:.3g} mm, the shortest that the machine was fitted on", r.line_mm[0]),
       "range-line");
  tell(arc,
       r.arc_radius_mm[1] == 0 ? "arcs, of which the machine was fitted on none"
                               : fmt::format("arcs tighter than {:.3g} mm, the tightest that the machine was fitted on",
                                             r.arc_radius_mm[0]),
       "range-arc");
  tell(short_arc, fmt::format("arcs shorter than {:.3g} mm, the shortest that the machine was fitted on", r.arc_mm[0]),
       "range-arc-length");
  tell(rate,
       r.blocks_per_s[1] == 0 ? "runs of blocks, of which the machine was fitted on none"
                              : fmt::format("more than {:.0f} blocks a second, the most that the machine was fitted on",
                                            r.blocks_per_s[1]),
       "range-blocks");
  for (int k = 0; k < 3; ++k)
    tell(axis[k], fmt::format("motion of {}, which the machine was not fitted on", "XYZ"[k]), "range-axis");
}

}  // namespace camber::feedmodel
