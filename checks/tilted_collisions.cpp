#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "base/stage.h"
#include "checks/collision_search.h"
#include "checks/swept_stock.h"
#include "feedmodel/rapid.h"
#include "feedmodel/timed_path.h"

namespace camber::checks {
namespace {

/// A rapid with the poses that it goes through, close to each other.
struct PosedRapid {
  RapidCheck check;
  int tool = 0;
  std::vector<ToolPose> poses{};
};

using Surfaces = std::map<int, ToolSurface>;

Surfaces surfaces_of(const machine::Job& job) {
  Surfaces out;
  for (const auto& [number, tool] : job.tools)
    out.try_emplace(number, tool_outline(tool, kCollisionStep_mm, 1e6), kCollisionStep_mm);
  return out;
}

void append(std::vector<ToolPose>& poses, const ToolPose& pose, const ToolSurface& tool) {
  if (poses.empty()) return poses.push_back(pose);
  const auto more = poses_between(tool, poses.back(), pose, kCollisionStep_mm);
  poses.insert(poses.end(), more.begin(), more.end());
}

/// Places the tools along the rapids by the joints that the control commands (feedmodel::predict_joints).
void pose_by_joints(const machine::Job& job, const motion::SimulatedProgram& program, const Surfaces& tools,
                    std::vector<PosedRapid>& rapids) {
  constexpr double kClose_mm = 0.5 * kCollisionStep_mm;
  auto rapid = rapids.begin();
  const auto take = [&](const feedmodel::TimedSample& sample, const ToolPose& pose) {
    while (rapid != rapids.end() && rapid->check.move < sample.move) ++rapid;
    if (rapid == rapids.end() || rapid->check.move != sample.move) return;
    const ToolSurface& tool = tools.at(rapid->tool);
    if (!rapid->check.start_known) rapid->poses.clear();
    // The last sample takes the place of the one before while they are close together.
    std::vector<ToolPose>& poses = rapid->poses;
    if (poses.size() > 1 && tool.displacement_mm(poses[poses.size() - 2], pose) < kClose_mm) poses.pop_back();
    append(poses, pose, tool);
  };
  feedmodel::predict_joints(program.moves_of_axes(), job.machine, [&](auto samples, auto joints) {
    for (std::size_t i = 0; i < samples.size(); ++i) take(samples[i], joints[i].command_tool);
  });
}

/// Without rotary motion the tool keeps the direction that it cuts with.
void pose_by_path(const machine::Job& job, const motion::SimulatedProgram& program, const Surfaces& tools,
                  std::vector<PosedRapid>& rapids) {
  const auto& stamps = program.path.stamps;
  for (PosedRapid& rapid : rapids) {
    const nc::Move& m = program.moves_in_part().moves[rapid.check.move];
    ToolPose pose = stamps.empty() ? ToolPose{} : stamps[std::min(rapid.check.before_stamp, stamps.size() - 1)].pose;
    for (const Vec3& tip : rapid.check.start_known
                               ? feedmodel::positioning_places(job.machine, m.start_mm, m.end_mm, kCollisionStep_mm)
                               : std::vector<Vec3>{m.end_mm}) {
      pose.tip_mm = tip;
      append(rapid.poses, pose, tools.at(rapid.tool));
    }
  }
}

/// Drawn back along its axis.
bool draws_back(const PosedRapid& rapid) {
  constexpr double kRounding_mm = 1e-6;
  const ToolPose& first = rapid.poses.front();
  double height = 0;
  return rapid.check.start_known && std::ranges::all_of(rapid.poses, [&](const ToolPose& pose) {
           const Vec3 way = pose.tip_mm - first.tip_mm;
           const double up = way.dot(first.axis), before = std::exchange(height, up);
           return (pose.axis - first.axis).norm() < 1e-9 && (way - up * first.axis).norm() < kRounding_mm &&
                  up >= before - kRounding_mm;
         });
}

/// Rapids that come near the stock.
std::vector<PosedRapid> posed_rapids(const machine::Job& job, const motion::SimulatedProgram& program,
                                     const Surfaces& tools, const removal::Stock& blank) {
  std::vector<PosedRapid> rapids;
  for (const RapidCheck& r : rapids_of(program)) {
    const int tool = program.moves_in_part().state_of(program.moves_in_part().moves[r.move]).tool;
    if (tools.contains(tool)) rapids.push_back({r, tool});
  }
  if (program.turns())
    pose_by_joints(job, program, tools, rapids);
  else
    pose_by_path(job, program, tools, rapids);
  std::erase_if(rapids, [&](const PosedRapid& rapid) {
    const ToolSurface& tool = tools.at(rapid.tool);
    const bool near = std::ranges::any_of(
        rapid.poses, [&](const ToolPose& pose) { return tool.may_touch(pose, true, blank.min_mm(), blank.max_mm()); });
    return !near || (tool.widens_upwards() && draws_back(rapid));
  });
  return rapids;
}

class Search {
 public:
  Search(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank)
      : program_(program),
        surfaces_(surfaces_of(job)),
        rapids_(posed_rapids(job, program, surfaces_, blank)),
        last_needed_(last_needed(blank)),
        stage_("checking for collisions", 2 * last_needed_) {
    if (last_needed_ == 0 && rapids_.empty()) return;
    stock_.emplace(job, program, blank, stage_);
    for (const auto& [number, surface] : surfaces_)
      feelers_.try_emplace(number, surface, stock_->stock(), stock_->material());
  }

  std::vector<Collision> run() {
    if (!stock_) return {};
    for (const auto& run : program_.path.runs)
      if (run.from < last_needed_) look_along(run);
    look_at_rapids(program_.path.stamps.size());
    return std::move(found_);
  }

 private:
  /// One past the last stamp that shank or holder, or a rapid after it, needs.
  std::size_t last_needed(const removal::Stock& blank) const {
    std::size_t last = rapids_.empty() ? 0 : rapids_.back().check.before_stamp;
    for (const auto& run : program_.path.runs)
      last = last_near(surfaces_.at(run.tool), program_.path, run, blank, last);
    return last;
  }

  void look_along(const removal::ToolRun& run) {
    PlacesAlong places(surfaces_.at(run.tool), program_.path, run);
    stock_->begin(run);
    const std::size_t end = std::min(run.from + run.count, last_needed_);
    for (std::size_t k = run.from; k < end; ++k) {
      stage_.advance();
      if (next_rapid_ < rapids_.size() && rapids_[next_rapid_].check.before_stamp <= k) {
        stock_->sweep_to(k);
        look_at_rapids(k);
      }
      stock_->limit_waiting(k);
      for (const ToolPose& pose : places.at(k)) look_at(run.tool, k, pose);
    }
    stock_->sweep_to(end);
  }

  void look_at(int tool, std::size_t k, const ToolPose& pose) {
    if (!surfaces_.at(tool).may_touch(pose, false, stock_->stock().min_mm(), stock_->stock().max_mm())) return;
    bool some_cleared = false;
    const auto touch = feelers_.at(tool).touch(stock_->probe(), pose, false, [&](const Vec3& point) {
      const bool cleared = stock_->cleared(point, k);
      some_cleared = some_cleared || cleared;
      return !cleared;
    });
    const removal::Stamp& s = program_.path.stamps[k];
    if (touch)
      add_collision(program_, {static_cast<Collision::Part>(touch->part), false, s.t_s, s.move, tool, touch->place_mm},
                    found_);
    else if (some_cleared)
      stock_->sweep_to(k);
  }

  /// Checks the rapids before stamp k.
  void look_at_rapids(std::size_t k) {
    for (; next_rapid_ < rapids_.size() && rapids_[next_rapid_].check.before_stamp <= k; ++next_rapid_) {
      const PosedRapid& rapid = rapids_[next_rapid_];
      for (const ToolPose& pose : rapid.poses)
        if (const auto touch = feelers_.at(rapid.tool).touch(stock_->probe(), pose, true)) {
          add_collision(program_,
                        {static_cast<Collision::Part>(touch->part), true, rapid.check.t_s, rapid.check.move, rapid.tool,
                         touch->place_mm},
                        found_);
          break;
        }
    }
  }

  const motion::SimulatedProgram& program_;
  Surfaces surfaces_;
  std::vector<PosedRapid> rapids_;
  std::size_t last_needed_, next_rapid_ = 0;
  Stage stage_;
  std::optional<SweptStock> stock_;
  std::map<int, SurfaceFeeler> feelers_;
  std::vector<Collision> found_;
};

}  // namespace

std::vector<Collision> find_tilted_collisions(const machine::Job& job, const motion::SimulatedProgram& program,
                                              const removal::Stock& blank) {
  return Search(job, program, blank).run();
}

}  // namespace camber::checks
