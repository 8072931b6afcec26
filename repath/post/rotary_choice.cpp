#include "repath/post/post_plan.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>

namespace camber::repath {
namespace {

constexpr double kSquare = 1e-12;  ///< cosine of axes that count as square
constexpr double kPole = 1e-9;     ///< sine of the angle at which the tool counts as along the first axis

}  // namespace

double PoleTwist::past_pole_rad(const Vec3& programmed_rad) const {
  return second_sense * (programmed_rad[second] - pole_rad);
}

double PoleTwist::of(const Vec3& programmed_rad) const {
  const double delta = past_pole_rad(programmed_rad), rounds = std::round(delta / (4 * kPi));
  const double angle = std::atan2(cosine * std::sin(delta / 2), std::cos(delta / 2));
  const double half = angle + std::copysign(2 * kPi, cosine) * rounds;
  return first_sense * 2 * half;
}

double PoleTwist::deviation_rad(const Vec3& from_rad, const Vec3& to_rad) const {
  const double a = past_pole_rad(from_rad), b = past_pole_rad(to_rad), c2 = cosine * cosine;
  // of'' = c (1 - c^2) sin(delta) / (2 (cos^2(delta/2) + c^2 sin^2(delta/2))^2)
  const double curve = std::abs(cosine) * (1 - c2) / (2 * c2 * c2);
  const double farthest = std::max(std::abs(a), std::abs(b));
  const double tilt = 2 * std::sqrt(1 - c2) * std::sin(std::min(farthest, kPi) / 2);
  return curve * (b - a) * (b - a) / 8 * std::min(tilt, 1.0);
}

Vec3 RotaryChoice::of(const Vec3& programmed_rad) const {
  Vec3 out = sign.cwiseProduct(programmed_rad) + mirror_rad + offset_rad;
  if (twist) out[twist->first] += twist->of(programmed_rad);
  return out;
}

std::optional<RotaryChoice> mirrored_choice(const machine::Machine& machine, const kinematics::Chain& chain) {
  const std::string& letters = chain.rotary_axes();
  if (letters.size() != 2) return std::nullopt;
  const auto axis = [&](std::size_t i) -> const machine::RotaryAxis& {
    return machine.rotary[static_cast<std::size_t>(letters[i] - 'a')];
  };
  const auto sense = [&](std::size_t i) { return axis(i).positive == machine::PositiveTurn::tool ? 1.0 : -1.0; };
  const Vec3 second = axis(1).direction.normalized(), tool = machine.kinematics.tool_axis.normalized();
  Vec3 first = axis(0).direction.normalized();
  double first_sense = sense(0);
  if (first.dot(second) * tool.dot(second) < 0) first = -first, first_sense = -first_sense;
  const double cosine = first.dot(second);
  if (std::abs(cosine - tool.dot(second)) > kPole || std::abs(cosine) > 1 - kPole) return std::nullopt;
  const Eigen::Index i = letters[0] - 'a', k = letters[1] - 'a';
  const Vec3 from = tool - cosine * second, to = first - cosine * second;
  const double pole_rad = sense(1) * std::atan2(from.cross(to).dot(second), from.dot(to));
  RotaryChoice out;
  out.mirrored = true;
  out.offset_rad[i] = kPi;
  out.sign[k] = -1;
  out.mirror_rad[k] = 2 * pole_rad;
  if (std::abs(cosine) > kSquare) out.twist = PoleTwist{i, k, first_sense, sense(1), pole_rad, cosine};
  return out;
}

}  // namespace camber::repath
