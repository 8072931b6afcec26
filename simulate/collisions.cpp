#include "simulate/collisions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "base/stage.h"
#include "feedmodel/rapid.h"
#include "nc/known_places.h"
#include "removal/engagement.h"
#include "removal/tool_path.h"
#include "simulate/operations.h"
#include "simulate/tool_outline.h"

namespace camber::simulate {
namespace {

constexpr double kStep_mm = 0.5;  ///< along paths and on outlines

using Part = OutlineRing::Part;

/// One tool's outline against the stock.
class Feeler {
 public:
  Feeler(const machine::Tool& tool, const removal::Stock& stock)
      : stock_(stock), rings_(tool_outline(tool, kStep_mm, 1e6)) {
    for (const auto& r : rings_) {
      const double reach = r.radius_mm;
      if (r.part != Part::cutter) lowest_shank_mm_ = std::min(lowest_shank_mm_, r.height_mm);
      widest_mm_ = std::max(widest_mm_, reach);
    }
  }

  /// Whether the tool, or only its shank and holder, comes as low as the stock's top and beside it.
  bool near(const Vec3& tip, bool with_cutter) const {
    const Vec3 &lo = stock_.min_mm(), &hi = stock_.max_mm();
    return tip.z() + (with_cutter ? 0 : lowest_shank_mm_) < hi.z() && tip.x() + widest_mm_ > lo.x() &&
           tip.x() - widest_mm_ < hi.x() && tip.y() + widest_mm_ > lo.y() && tip.y() - widest_mm_ < hi.y();
  }

  /// Whether the tool, drawn up along its axis, stays in the space that it and its shank take or have taken.
  bool widens_upwards() const {
    constexpr double kRounding_mm = 1e-9;
    return std::ranges::adjacent_find(rings_, [](const auto& below, const auto& above) {
             return above.radius_mm < below.radius_mm - kRounding_mm;
           }) == rings_.end();
  }

  /// A point of the outline that is in material by more than a voxel.
  std::optional<std::pair<Part, Vec3>> touch(const removal::Stock::Probe& probe, const Vec3& tip,
                                             bool with_cutter) const {
    const double allowed = stock_.voxel_mm(), blur = 0.87 * stock_.voxel_mm();
    const double deep = std::min(allowed + 0.5 * stock_.voxel_mm(), 0.9 * stock_.band_mm());
    for (const auto& ring : rings_) {
      if ((!with_cutter && ring.part == Part::cutter) || tip.z() + ring.height_mm > stock_.max_mm().z()) continue;
      const int n = std::max(1, static_cast<int>(std::ceil(2 * kPi * ring.radius_mm / kStep_mm)));
      for (int i = 0; i < n; ++i) {
        const double phi = 2 * kPi * i / n;
        const Vec3 p = tip + Vec3(ring.radius_mm * std::cos(phi), ring.radius_mm * std::sin(phi), ring.height_mm);
        if (probe.nearest(p) > -deep + blur || stock_.distance_mm(p) > -allowed) continue;
        return std::pair(ring.part, p);
      }
    }
    return std::nullopt;
  }

 private:
  const removal::Stock& stock_;
  std::vector<OutlineRing> rings_;
  double lowest_shank_mm_ = 1e9, widest_mm_ = 0;
};

/// Rapids that are looked at, and which of their ends are known.
struct RapidCheck {
  std::uint32_t move = 0;
  double t_s = 0;
  std::size_t before_stamp = 0;  ///< it happens before this stamp
  bool start_known = true;
};

/// Tells the rapids of cycles that stay in their hole, where the tool has been just before; there G76 also leaves the
/// hole's axis, which its tool, as a turning outline, could not.
class HoleWatch {
 public:
  bool in_hole(const nc::Move& m) {
    if (m.cycle == 0) return false;
    if (m.cycle == 87) return true;  // beside the axis all the way
    if (m.kind == nc::MoveKind::linear && m.end_mm.z() < m.start_mm.z() && (m.block != block_ || !reaches(m))) {
      block_ = m.block;
      entry_z_mm_ = m.start_mm.z();
      place_ = m.start_mm.head<2>();
    }
    constexpr double kRounding_mm = 1e-6;
    if (m.block != block_ || (m.cycle != 76 && m.start_mm.head<2>() != place_)) return false;
    return std::min(m.start_mm.z(), m.end_mm.z()) < entry_z_mm_ - kRounding_mm;
  }

 private:
  /// Another peck of the hole.
  bool reaches(const nc::Move& m) const { return m.start_mm.head<2>() == place_; }
  std::uint32_t block_ = std::numeric_limits<std::uint32_t>::max();
  double entry_z_mm_ = 0;
  Vec2 place_ = Vec2::Zero();
};

std::vector<RapidCheck> rapids_of(const SimulatedProgram& program) {
  std::vector<RapidCheck> out;
  HoleWatch watch;
  nc::KnownPlaces places(program.text, program.moves);
  const auto& stamps = program.path.stamps;
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < program.moves.moves.size(); ++i) {
    const nc::Move& m = program.moves.moves[i];
    while (next < stamps.size() && stamps[next].move < i) ++next;
    const nc::KnownPlaces::Ends known = places.next(m);
    if (m.reference || watch.in_hole(m) || m.kind != nc::MoveKind::rapid || !known.end) continue;
    const double t = next < stamps.size() ? stamps[next].t_s : stamps.empty() ? 0 : stamps.back().t_s;
    const auto timed = std::ranges::lower_bound(program.path.rapids, i, {}, &removal::RapidStart::move);
    const bool found = timed != program.path.rapids.end() && timed->move == i;
    out.push_back({i, found ? timed->t_s : t, next, known.start});
  }
  return out;
}

/// The sweep, stretch by stretch, with what is looked at between.
class Search {
 public:
  Search(const machine::Job& job, const SimulatedProgram& program, const removal::Stock& blank)
      : job_(job), program_(program), stock_(blank) {
    for (const auto& [number, tool] : job.tools) feelers_.try_emplace(number, tool, stock_);
    for (const RapidCheck& r : rapids_of(program))
      if (comes_near(r)) rapids_.push_back(r);
    for (const auto& run : program.path.runs)
      for (std::size_t k = run.from; k < run.from + run.count; ++k)
        if (feelers_.at(run.tool).near(program.path.stamps[k].pose.tip_mm, false)) last_needed_ = k + 1;
    if (!rapids_.empty()) last_needed_ = std::max(last_needed_, rapids_.back().before_stamp);
  }

  std::vector<Collision> run() {
    auto rapid = rapids_.begin();
    Stage stage("checking for collisions", 2 * last_needed_);
    for (const auto& run : program_.path.runs) {
      const std::size_t end = run.from + run.count;
      for (std::size_t at = run.from; at < end && (at < last_needed_ || rapid != rapids_.end());) {
        for (; rapid != rapids_.end() && rapid->before_stamp <= at; ++rapid) feel_rapid(*rapid);
        std::size_t to = level_stretch_end(job_.tools.at(run.tool), program_.path, run, at);
        if (rapid != rapids_.end()) to = std::min(to, std::max(at + 1, rapid->before_stamp));
        feel_stretch(run.tool, at, to, stage);
        removal::sweep(stock_, removal::shape_of(job_.tools.at(run.tool)),
                       std::span(program_.path.stamps).subspan(at, to - at),
                       {.first_id = static_cast<std::int32_t>(at), .stage = &stage});
        at = to;
      }
    }
    for (; rapid != rapids_.end(); ++rapid) feel_rapid(*rapid);
    return std::move(found_);
  }

 private:
  bool comes_near(const RapidCheck& r) const {
    const nc::Move& m = program_.moves.moves[r.move];
    const auto feeler = feelers_.find(program_.moves.state_of(m).tool);
    if (feeler == feelers_.end()) return false;
    const Vec3 way = m.end_mm - m.start_mm;
    if (r.start_known && way.x() == 0 && way.y() == 0 && way.z() >= 0 && feeler->second.widens_upwards()) return false;
    bool near = false;
    for_places(r, [&](const Vec3& tip) { near = near || feeler->second.near(tip, true); });
    return near;
  }

  template <class Function>
  void for_places(const RapidCheck& r, Function f) const {
    const nc::Move& m = program_.moves.moves[r.move];
    if (!r.start_known) return f(m.end_mm);
    for (const Vec3& tip : feedmodel::positioning_places(job_.machine, m.start_mm, m.end_mm, kStep_mm)) f(tip);
  }

  void feel_rapid(const RapidCheck& r) {
    const nc::Move& m = program_.moves.moves[r.move];
    const int tool = program_.moves.state_of(m).tool;
    const Feeler& feeler = feelers_.at(tool);
    const removal::Stock::Probe probe(stock_);
    bool hit = false;
    for_places(r, [&](const Vec3& tip) {
      if (hit || !feeler.near(tip, true)) return;
      if (const auto touch = feeler.touch(probe, tip, true)) {
        hit = true;
        add({static_cast<Collision::Part>(touch->first), true, r.t_s, r.move, tool, touch->second});
      }
    });
  }

  void feel_stretch(int tool, std::size_t from, std::size_t to, Stage& stage) {
    const Feeler& feeler = feelers_.at(tool);
    const removal::Stock::Probe probe(stock_);
    Vec3 last = Vec3::Constant(1e9);
    for (std::size_t k = from; k < to; ++k) {
      const removal::Stamp& s = program_.path.stamps[k];
      stage.advance();
      if ((s.pose.tip_mm - last).norm() < kStep_mm || !feeler.near(s.pose.tip_mm, false)) continue;
      last = s.pose.tip_mm;
      if (const auto touch = feeler.touch(probe, s.pose.tip_mm, false))
        add({static_cast<Collision::Part>(touch->first), false, s.t_s, s.move, tool, touch->second});
    }
  }

  void add(const Collision& c) {
    const auto block = program_.moves.moves[c.move].block;
    if (!found_.empty() && program_.moves.moves[found_.back().move].block == block && found_.back().part == c.part)
      return;
    found_.push_back(c);
  }

  const machine::Job& job_;
  const SimulatedProgram& program_;
  removal::Stock stock_;
  std::map<int, Feeler> feelers_;
  std::vector<RapidCheck> rapids_;
  std::size_t last_needed_ = 0;
  std::vector<Collision> found_;
};

/// Something that cuts was not simulated, so stock may stand that the real machine has removed.
bool motion_left_out(const SimulatedProgram& program) {
  for (std::size_t i = 0; i < program.moves.moves.size(); ++i) {
    const nc::Move& m = program.moves.moves[i];
    const bool cuts = m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc;
    const removal::HoleMove hole = program.holes[i];
    const bool carved = removal::makes_hole(hole) || hole == removal::HoleMove::way_out;
    if (cuts && !m.reference && !program.selected[i] && !carved) return true;
  }
  return false;
}

const char* name(Collision::Part part) {
  if (part == Collision::Part::cutter) return "cutter";
  return part == Collision::Part::shank ? "shank" : "holder";
}

const char* check_name(const Collision& c) {
  if (c.rapid) return "collision-rapid";
  return c.part == Collision::Part::shank ? "collision-shank" : "collision-holder";
}

/// "rapid through material: the cutter of T1 in stock at X1.00 Y2.00 Z3.00, 4.00 s into the program".
std::string deed(const Collision& c) {
  return fmt::format("{}the {} of T{} in stock at X{:.2f} Y{:.2f} Z{:.2f}, {:.2f} s into the program",
                     c.rapid ? "rapid through material: " : "", name(c.part), c.tool, c.place_mm.x(), c.place_mm.y(),
                     c.place_mm.z(), c.t_s);
}

void report(const SimulatedProgram& program, const Collision& c, Severity severity, const std::string& message,
            Diagnostics& diagnostics) {
  const std::size_t offset = program.text.blocks[program.moves.moves[c.move].block].offset;
  diagnostics.add(program.text.source.diagnostic(severity, offset, message, check_name(c)));
}

void report_inside(const SimulatedProgram& program, const std::vector<Collision>& found, Severity severity,
                   Diagnostics& diagnostics) {
  constexpr std::size_t kMax = 10;
  for (std::size_t i = 0; i < std::min(found.size(), kMax); ++i) {
    const Collision& c = found[i];
    const std::string more = i + 1 == kMax && found.size() > kMax ? fmt::format(" ({} more)", found.size() - kMax) : "";
    report(program, c, severity,
           fmt::format("{}{}; {} was expected", deed(c), more,
                       c.rapid ? "a rapid clear of the stock" : "a longer overhang or less depth"),
           diagnostics);
  }
}

/// One line: what these moves meet may be gone before they run, since other moves are left out too.
void report_outside(const SimulatedProgram& program, const std::vector<Collision>& found, Severity severity,
                    Diagnostics& diagnostics) {
  if (found.empty()) return;
  const Collision& c = found.front();
  report(
      program, c, severity,
      fmt::format("{} collision{} in moves outside the job's operations, the first one in line {}: {}; moves that the "
                  "job leaves out may have cleared the way",
                  found.size(), found.size() == 1 ? "" : "s", program.moves.moves[c.move].block + 1, deed(c)),
      diagnostics);
}

}  // namespace

std::vector<Collision> find_collisions(const machine::Job& job, const SimulatedProgram& program,
                                       const removal::Stock& blank) {
  return Search(job, program, blank).run();
}

void check_collisions(const machine::Job& job, const SimulatedProgram& program, const removal::Stock& blank,
                      Diagnostics& diagnostics) {
  const auto kind = job.simulation.collisions.value_or(motion_left_out(program) ? machine::Collisions::warning
                                                                                : machine::Collisions::error);
  if (kind == machine::Collisions::off) return;
  const auto severity = kind == machine::Collisions::error ? Severity::error : Severity::warning;
  const machine::Operations operations = as_lines(job.operations, program.text, program.moves);
  std::vector<Collision> inside, outside;
  for (const Collision& c : find_collisions(job, program, blank))
    (removal::in_operations(program.moves, program.moves.moves[c.move], operations) ? inside : outside).push_back(c);
  report_inside(program, inside, severity, diagnostics);
  report_outside(program, outside, severity, diagnostics);
}

}  // namespace camber::simulate
