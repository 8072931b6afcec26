#include "copymill/runner.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace camber::copymill {
namespace {

/// The greatest speed v at the end of a tick from which a limit can be kept: v^2 <= u^2 + 2 a (D - (v0 + v) dt / 2).
/// Returns the speed for a limit that lies within the tick, where the speed must be u: u^2 >= v0^2 + 2 D (v - v0) / dt.
double greatest_speed(double v0, const SpeedLimit& limit, double a, double dt) {
  const double u2 = limit.speed_mm_per_s * limit.speed_mm_per_s, way = limit.distance_mm;
  const double right = u2 + 2 * a * way - a * v0 * dt;
  const double v = right <= 0 ? 0 : 0.5 * (std::sqrt(a * a * dt * dt + 4 * right) - a * dt);
  if (0.5 * (v0 + v) * dt <= way) return v;
  return way > 0 ? std::min(v, v0 + (u2 - v0 * v0) / (2 * way) * dt) : v;
}

}  // namespace

TickMotion next_tick(double v0, double wanted, std::span<const SpeedLimit> ahead, double a, double dt) {
  assert(v0 >= 0 && wanted >= 0 && a > 0 && dt > 0);
  double v = std::min(wanted, v0 + a * dt), stop = -1;
  for (const SpeedLimit& limit : ahead) {
    v = std::min(v, greatest_speed(v0, limit, a, dt));
    if (limit.speed_mm_per_s == 0 && (stop < 0 || limit.distance_mm < stop)) stop = limit.distance_mm;
  }
  v = std::max({v, v0 - a * dt, 0.0});
  TickMotion out{v, 0.5 * (v0 + v) * dt};
  // At rest before the tick is over, and where a stop is asked for there.
  if (v == 0) {
    const double least = stopping_distance_mm(v0, a);
    out.distance_mm = stop >= 0 && stop <= out.distance_mm ? std::max(stop, least) : least;
  }
  return out;
}

double stopping_distance_mm(double speed_mm_per_s, double acceleration_mm_per_s2) {
  return speed_mm_per_s * speed_mm_per_s / (2 * acceleration_mm_per_s2);
}

double acceleration_along(const machine::Machine& machine, const Vec3& direction) {
  double out = machine.control.path_acceleration_mm_per_s2;
  const double length = direction.norm();
  for (int axis = 0; axis < 3; ++axis)
    if (const double share = std::abs(direction[axis]) / length; share > 0)
      out = std::min(out, machine.axis[static_cast<std::size_t>(axis)].acceleration_mm_per_s2 / share);
  return out;
}

namespace {

constexpr double kAlongShare = 0.5, kArcShare = 0.7, kCornerShare = 0.45;  // of the acceleration
constexpr double kFastest = 2000, kQuickest = 20000;                       // mm/s, mm/s^2, of machines without limits
constexpr double kUnlimited = 1e9;
constexpr double kStuck_mm = 1e-7;
constexpr std::size_t kLongestWindow = 50;

/// Along a direction, from limits of the axes.
double along(const Vec3& limits, const Vec3& direction) {
  double out = kUnlimited;
  for (int a = 0; a < 3; ++a)
    if (std::abs(direction[a]) > 1e-9) out = std::min(out, limits[a] / std::abs(direction[a]));
  return out;
}

}  // namespace

FeedMotion::FeedMotion(const machine::Machine& machine) : period_s_(machine.control.period_s) {
  for (int a = 0; a < 3; ++a) {
    const machine::Axis& axis = machine.axis[static_cast<std::size_t>(a)];
    velocity_limit_[a] = std::min({axis.max_velocity_mm_per_s, axis.max_feed_mm_per_s, kFastest});
    rapid_limit_[a] = std::min({axis.max_velocity_mm_per_s, axis.rapid_mm_per_s, kFastest});
    acceleration_limit_[a] = std::min({axis.acceleration_mm_per_s2, axis.rapid_acceleration_mm_per_s2, kQuickest});
  }
  // A change of velocity dv over the time T takes the tip dv T / 8 off the corner.
  const double time = std::sqrt(8 * kSmoothing_mm / (kCornerShare * acceleration_limit_.maxCoeff()));
  window_.resize(std::clamp<std::size_t>(static_cast<std::size_t>(time / period_s_), 1, kLongestWindow));
  settled_ = window_.size();
}

void FeedMotion::place(const Vec3& tip) {
  ideal_ = tip_ = tip;
  std::ranges::fill(window_, tip);
  settled_ = window_.size();
  speed_ = 0;
  path_.clear();
  piece_ = 0;
}

double FeedMotion::corner_speed(const PathPiece& before, const PathPiece& behind) const {
  const Vec3 turn = behind.direction(0) - before.direction(before.length_mm);
  return along(kCornerShare * smoothing_s() * acceleration_limit_, turn);
}

void FeedMotion::plan() {
  const std::size_t n = path_.size();
  from_mm_.assign(n + 1, 0);
  entry_.assign(n + 1, 0);
  within_.assign(n, 0);
  acceleration_ = kQuickest;
  for (std::size_t k = 0; k < n; ++k) {
    const PathPiece& p = path_[k];
    from_mm_[k + 1] = from_mm_[k] + p.length_mm;
    const Vec3& most = rapid_ ? rapid_limit_ : velocity_limit_;
    if (p.arc) {
      const double a = acceleration_limit_.head<2>().minCoeff();
      within_[k] = std::min(most.head<2>().minCoeff(), std::sqrt(kArcShare * a * p.radius_mm()));
      acceleration_ = std::min(acceleration_, a);
    } else {
      within_[k] = along(most, p.direction(0));
      acceleration_ = std::min(acceleration_, along(acceleration_limit_, p.direction(0)));
    }
    if (k > 0) entry_[k] = std::min({within_[k - 1], within_[k], corner_speed(path_[k - 1], p)});
  }
  acceleration_ *= kAlongShare;
}

void FeedMotion::start(std::vector<PathPiece> path, bool rapid) {
  path_ = std::move(path);
  std::erase_if(path_, [](const PathPiece& p) { return p.length_mm <= 0; });
  rapid_ = rapid;
  piece_ = 0;
  along_ = speed_ = 0;
  settled_ = 0;
  plan();
}

void FeedMotion::advance(double mm) {
  along_ += mm;
  while (!done() && along_ >= path_[piece_].length_mm - 1e-9) {
    ideal_ = path_[piece_].to;
    along_ = std::max(0.0, along_ - path_[piece_].length_mm);
    if (++piece_ == path_.size()) speed_ = 0, along_ = 0;
  }
  if (!done()) ideal_ = path_[piece_].at(along_);
}

void FeedMotion::tick(double wanted, const SpeedLimit& further) {
  if (!done()) {
    const double here = from_mm_[piece_] + along_;
    const double horizon = here + stopping_mm() + 2 * (speed_ + acceleration_ * period_s_) * period_s_;
    limits_.clear();
    for (std::size_t k = piece_ + 1; k < entry_.size(); ++k) {
      limits_.push_back({from_mm_[k] - here, entry_[k]});
      if (from_mm_[k] > horizon) break;
    }
    if (further.speed_mm_per_s < kUnlimited) limits_.push_back(further);
    const TickMotion moved = next_tick(speed_, std::min(wanted, within_[piece_]), limits_, acceleration_, period_s_);
    speed_ = moved.speed_mm_per_s;
    // Closer to a limit than a tick's resolution: the next piece.
    const bool stuck = wanted > 0 && speed_ <= 0 && moved.distance_mm < kStuck_mm;
    advance(stuck ? std::min(path_[piece_].length_mm - along_, acceleration_ * period_s_ * period_s_)
                  : std::min(from_mm_.back() - here, moved.distance_mm));
  }
  settled_ = done() || speed_ <= 0 ? settled_ + 1 : 0;
  window_[window_at_] = ideal_;
  window_at_ = (window_at_ + 1) % window_.size();
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : window_) sum += p;
  tip_ = sum / static_cast<double>(window_.size());
}

FeedMotion::Ahead FeedMotion::ahead(double distance) const {
  std::size_t k = piece_;
  double at = along_ + distance;
  while (k < path_.size() && at > path_[k].length_mm) at -= path_[k++].length_mm;
  if (k < path_.size()) return {path_[k].at(at), path_[k].direction(at)};
  if (path_.empty()) return {ideal_, Vec3(0, 0, -1)};
  return {path_.back().to, path_.back().direction(path_.back().length_mm)};
}

}  // namespace camber::copymill
