#include "checks/swept_stock.h"

#include <algorithm>
#include <span>

#include "checks/collision_search.h"
#include "removal/engagement.h"

namespace camber::checks {

SweptStock::SweptStock(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
                       Stage& stage)
    : job_(job), program_(program), stage_(stage), stock_(blank), material_(stock_) {
  probe_.emplace(stock_);
}

void SweptStock::begin(const removal::ToolRun& run) {
  shape_ = removal::shape_of(job_.tools.at(run.tool));
  flutes_mm_ = cutter_end_mm(job_.tools.at(run.tool));
  swept_ = run.from;
}

void SweptStock::sweep_to(std::size_t end) {
  if (end <= swept_) return;
  probe_.reset();
  removal::sweep(stock_, shape_, std::span(program_.path.stamps).subspan(swept_, end - swept_),
                 {.first_id = static_cast<std::int32_t>(swept_), .stage = &stage_});
  probe_.emplace(stock_);
  swept_ = end;
}

bool SweptStock::cleared(const Vec3& point, std::size_t end) const {
  const double voxel = stock_.voxel_mm();
  for (std::size_t k = end; k-- > swept_;) {
    const ToolPose& pose = program_.path.stamps[k].pose;
    const Vec3 p = point_in_tool(pose, point);
    if (p.z() <= flutes_mm_ + voxel && shape_.distance_mm(p) <= voxel) return true;
  }
  return false;
}

std::size_t last_near(const ToolSurface& tool, const removal::StampPath& path, const removal::ToolRun& run,
                      const removal::Stock& stock, std::size_t from) {
  std::size_t last = from;
  for (std::size_t k = std::max(run.from, from); k < run.from + run.count; ++k) {
    const removal::Stamp& stamp = path.stamps[k];
    const bool alone = k == run.from || stamp.first;
    const double way_mm = alone ? 0 : tool.displacement_mm(path.stamps[k - 1].pose, stamp.pose);
    if (tool.may_touch(stamp.pose, false, stock.min_mm(), stock.max_mm(), way_mm)) last = k + 1;
  }
  return last;
}

const std::vector<ToolPose>& PlacesAlong::at(std::size_t k) {
  places_.clear();
  const removal::Stamp& stamp = stamps_[k];
  const bool begins = stamp.first || step_to_next_ < 0;
  const double step = begins ? 0 : step_to_next_;
  const bool ends = k + 1 >= end_ || stamps_[k + 1].first;
  step_to_next_ = ends ? -1 : tool_.displacement_mm(stamp.pose, stamps_[k + 1].pose);
  if (step > kCollisionStep_mm) {
    places_ = poses_between(tool_, stamps_[k - 1].pose, stamp.pose, kCollisionStep_mm);
    since_mm_ = 0;
    return places_;
  }
  since_mm_ += step;
  if (begins || ends || since_mm_ + step_to_next_ > kCollisionStep_mm) {
    places_.push_back(stamp.pose);
    since_mm_ = 0;
  }
  return places_;
}

}  // namespace camber::checks
