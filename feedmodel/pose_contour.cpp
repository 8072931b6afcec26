#include "feedmodel/pose_contour.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace camber::feedmodel {
namespace {

constexpr double kArm = PoseContour::kAxisArmMm;

double square_distance(const ToolPose& a, const ToolPose& b) {
  return (a.tip_mm - b.tip_mm).squaredNorm() + kArm * kArm * (a.axis - b.axis).squaredNorm();
}

/// The nearest pose between two neighbours.
ToolPose nearest_between(const ToolPose& a, const ToolPose& b, const ToolPose& pose) {
  const double square = square_distance(a, b);
  if (square == 0) return a;
  const double along =
      (pose.tip_mm - a.tip_mm).dot(b.tip_mm - a.tip_mm) + kArm * kArm * (pose.axis - a.axis).dot(b.axis - a.axis);
  const double u = std::clamp(along / square, 0.0, 1.0);
  return {a.tip_mm + u * (b.tip_mm - a.tip_mm), a.axis + u * (b.axis - a.axis)};
}

}  // namespace

PoseContour::Error PoseContour::operator()(const ToolPose& command, const ToolPose& actual) {
  commands_.push_back(command);
  const auto nearer = [&](const ToolPose& a, const ToolPose& b) {
    return square_distance(a, actual) < square_distance(b, actual);
  };
  const auto nearest = std::min_element(commands_.begin(), commands_.end(), nearer);
  // The one before it stays: the nearest place may lie between the two.
  if (nearest != commands_.begin()) commands_.erase(commands_.begin(), nearest - 1);
  ToolPose best = commands_.front();
  for (std::size_t i = 0; i + 1 < std::min<std::size_t>(commands_.size(), 3); ++i) {
    const ToolPose place = nearest_between(commands_[i], commands_[i + 1], actual);
    if (nearer(place, best)) best = place;
  }
  const Vec3 axis = best.axis.normalized();
  return {(actual.tip_mm - best.tip_mm).norm(), std::atan2(axis.cross(actual.axis).norm(), axis.dot(actual.axis))};
}

void PoseContourSum::add(const PoseContour::Error& error) {
  sum_.tip_max_mm = std::max(sum_.tip_max_mm, error.tip_mm);
  sum_.axis_max_rad = std::max(sum_.axis_max_rad, error.axis_rad);
  sum_.tip_rms_mm += error.tip_mm * error.tip_mm;
  sum_.axis_rms_rad += error.axis_rad * error.axis_rad;
  ++count_;
}

PoseContourFigures PoseContourSum::figures() const {
  PoseContourFigures out = sum_;
  if (count_ == 0) return out;
  out.tip_rms_mm = std::sqrt(sum_.tip_rms_mm / static_cast<double>(count_));
  out.axis_rms_rad = std::sqrt(sum_.axis_rms_rad / static_cast<double>(count_));
  return out;
}

}  // namespace camber::feedmodel
