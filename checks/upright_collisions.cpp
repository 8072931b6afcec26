#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/stage.h"
#include "checks/collision_search.h"
#include "checks/tool_outline.h"
#include "feedmodel/rapid.h"
#include "removal/engagement.h"

namespace camber::checks {
namespace {

using Part = OutlineRing::Part;

/// One tool's outline against the stock.
class Feeler {
 public:
  Feeler(const machine::Tool& tool, const removal::Stock& stock)
      : stock_(stock), rings_(tool_outline(tool, kCollisionStep_mm, 1e6)) {
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
      const int n = std::max(1, static_cast<int>(std::ceil(2 * kPi * ring.radius_mm / kCollisionStep_mm)));
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

/// The sweep, stretch by stretch, with what is looked at between.
class Search {
 public:
  Search(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank)
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
    const nc::Move& m = program_.moves_in_part().moves[r.move];
    const auto feeler = feelers_.find(program_.moves_in_part().state_of(m).tool);
    if (feeler == feelers_.end()) return false;
    const Vec3 way = m.end_mm - m.start_mm;
    if (r.start_known && way.x() == 0 && way.y() == 0 && way.z() >= 0 && feeler->second.widens_upwards()) return false;
    bool near = false;
    for_places(r, [&](const Vec3& tip) { near = near || feeler->second.near(tip, true); });
    return near;
  }

  template <class Function>
  void for_places(const RapidCheck& r, Function f) const {
    const nc::Move& m = program_.moves_in_part().moves[r.move];
    if (!r.start_known) return f(m.end_mm);
    for (const Vec3& tip : feedmodel::positioning_places(job_.machine, m.start_mm, m.end_mm, kCollisionStep_mm)) f(tip);
  }

  void feel_rapid(const RapidCheck& r) {
    const nc::Move& m = program_.moves_in_part().moves[r.move];
    const int tool = program_.moves_in_part().state_of(m).tool;
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
      if ((s.pose.tip_mm - last).norm() < kCollisionStep_mm || !feeler.near(s.pose.tip_mm, false)) continue;
      last = s.pose.tip_mm;
      if (const auto touch = feeler.touch(probe, s.pose.tip_mm, false))
        add({static_cast<Collision::Part>(touch->first), false, s.t_s, s.move, tool, touch->second});
    }
  }

  void add(const Collision& c) { add_collision(program_, c, found_); }

  const machine::Job& job_;
  const motion::SimulatedProgram& program_;
  removal::Stock stock_;
  std::map<int, Feeler> feelers_;
  std::vector<RapidCheck> rapids_;
  std::size_t last_needed_ = 0;
  std::vector<Collision> found_;
};

}  // namespace

std::vector<Collision> find_upright_collisions(const machine::Job& job, const motion::SimulatedProgram& program,
                                               const removal::Stock& blank) {
  return Search(job, program, blank).run();
}

}  // namespace camber::checks
