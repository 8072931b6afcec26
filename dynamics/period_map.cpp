#include "dynamics/semi_discretisation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

namespace camber::dynamics {
namespace {

/// Intervals of a period: of the highest mode and of the shortest arc enough.
int interval_count(std::span<const Mode> modes, const Cut& cut, double period_s, double period_rad, double per_period) {
  constexpr double kLeast = 40, kPerArc = 12;
  double highest = 0, arc = 2 * kPi;
  for (const Mode& m : modes) highest = std::max(highest, m.frequency_hz);
  for (const CutSlice& s : cut.slices) arc = std::min(arc, std::max(s.exit_rad - s.entry_rad, 0.01));
  return static_cast<int>(std::ceil(std::max(
      {kLeast * period_rad / cut.pitch_rad.front(), per_period * highest * period_s, kPerArc * period_rad / arc})));
}

/// Returns the angles by which the ends of a slice come later than the tip, rad.
std::pair<double, double> lags_of(const Cut& cut, const CutSlice& s, double depth) {
  return {cut.lag_rad_per_mm * s.from * depth, cut.lag_rad_per_mm * s.to * depth};
}
bool lags_alike(double low, double high) {
  constexpr double kNoLag_rad = 1e-6;
  return std::abs(high - low) < kNoLag_rad;
}

}  // namespace

PeriodMap::PeriodMap(std::span<const Mode> modes, const Cut& cut, double speed_rpm, double points_per_period,
                     int min_intervals)
    : modes_(modes.begin(), modes.end()), cut_(cut), speed_rpm_(speed_rpm), equal_(has_equal_pitches(cut)) {
  for (const CutSlice& s : cut.slices) integrals_.emplace_back(s);
  const double period_rad = equal_ ? cut.pitch_rad.front() : 2 * kPi;
  period_s_ = period_rad / (2 * kPi) * 60 / speed_rpm;
  intervals_ = std::max(min_intervals, interval_count(modes, cut, period_s_, period_rad, points_per_period));
  dt_s_ = period_s_ / intervals_;
  if (equal_) {
    delays_.push_back({static_cast<double>(intervals_), {}});
    history_ = intervals_;
  } else {
    double longest = 0;
    for (const double p : cut.pitch_rad) {
      delays_.push_back({p / (2 * kPi) * intervals_, {}});
      longest = std::max(longest, delays_.back().knots);
    }
    history_ = static_cast<int>(std::ceil(longest)) + 2;  // two more for the cubic between knots
  }
  place_.resize(static_cast<std::size_t>(history_) + static_cast<std::size_t>(intervals_) + 1);
}

/// The answer of a mode to a force that goes straight from one knot to the next. Along the mode
/// q'' + 2 zeta w q' + w^2 q = w^2/k p;  for p = 1: q = 1/k, for p = t: q = t/k - 2 zeta/(w k), and the free motion.
PeriodMap::ModeStep PeriodMap::step_of(const Mode& mode) const {
  const double w = 2 * kPi * mode.frequency_hz, z = mode.damping_ratio, k = mode.stiffness_N_per_mm, h = dt_s_;
  Eigen::Matrix2d e;
  if (z < 1) {
    const double wd = w * std::sqrt(1 - z * z), decay = std::exp(-z * w * h), c = std::cos(wd * h),
                 s = std::sin(wd * h);
    e << c + z * w / wd * s, s / wd, -w * w / wd * s, c - z * w / wd * s;
    e *= decay;
  } else {
    const double a = w * std::sqrt(std::max(z * z - 1, 1e-12)), decay = std::exp(-z * w * h), c = std::cosh(a * h),
                 s = std::sinh(a * h);
    e << c + z * w / a * s, s / a, -w * w / a * s, c - z * w / a * s;
    e *= decay;
  }
  const Eigen::Vector2d constant = (Eigen::Matrix2d::Identity() - e) * Eigen::Vector2d(1 / k, 0);
  const Eigen::Vector2d lag(-2 * z / (w * k), 1 / k);  // of q = t/k - 2 zeta/(w k) at t = 0
  const Eigen::Vector2d ramp = (Eigen::Vector2d(h / k, 0) + lag - e * lag) / h;
  return {mode.direction, e, constant - ramp, ramp};
}

/// Evaluates the integrals of all slices for a tooth whose tip is at `angle`; without lag both ends share one value.
void PeriodMap::integrate_to(double angle, double depth, std::vector<SliceIntegrals>& out) const {
  out.resize(integrals_.size());
  for (std::size_t i = 0; i < integrals_.size(); ++i) {
    const auto [low, high] = lags_of(cut_, cut_.slices[i], depth);
    const DirectionalIntegral& w = integrals_[i];
    if (lags_alike(low, high))
      out[i].low = w.first(angle - (low + high) / 2);
    else
      out[i] = {w.second(angle - low), w.second(angle - high)};
  }
}

/// Mean of the chip's matrix of one tooth whose tip turns from one angle to another, N/mm; all slices.
Eigen::Matrix2d PeriodMap::tooth_mean(const std::vector<SliceIntegrals>& from, const std::vector<SliceIntegrals>& to,
                                      double turn, double depth) const {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < integrals_.size(); ++i) {
    const CutSlice& s = cut_.slices[i];
    const auto [low, high] = lags_of(cut_, s, depth);
    const double height = (s.to - s.from) * depth / turn;
    if (lags_alike(low, high))
      sum += height * (to[i].low - from[i].low);
    else
      sum += height / (high - low) * (to[i].low - from[i].low - to[i].high + from[i].high);
  }
  return sum;
}

void PeriodMap::set_depth(double depth) {
  steps_.clear();
  begin_.setZero(), end_.setZero();
  for (const Mode& m : with_process_damping(modes_, cut_, depth, speed_rpm_)) {
    steps_.push_back(step_of(m));
    const ModeStep& s = steps_.back();
    begin_ += s.begin(0) * s.direction * s.direction.transpose();
    end_ += s.end(0) * s.direction * s.direction.transpose();
  }
  const double turn = 2 * kPi * speed_rpm_ / 60 * dt_s_;
  for (Delay& d : delays_) d.chip.assign(static_cast<std::size_t>(intervals_), Eigen::Matrix2d::Zero());
  // Tooth j is preceded by the pitch from tooth j - 1; with M3 a tooth behind stands at a smaller angle.
  double behind = 0;
  std::vector<SliceIntegrals> from, to;
  for (std::size_t j = 0; j < cut_.pitch_rad.size(); ++j) {
    Delay& d = delays_[equal_ ? 0 : j];
    integrate_to(0 * turn - behind, depth, from);
    for (int i = 0; i < intervals_; ++i) {
      integrate_to((i + 1) * turn - behind, depth, to);
      d.chip[static_cast<std::size_t>(i)] +=
          tooth_mean(from, to, ((i + 1) * turn - behind) - (i * turn - behind), depth);
      std::swap(from, to);
    }
    behind += cut_.pitch_rad[(j + 1) % cut_.pitch_rad.size()];
  }
  interval_.resize(static_cast<std::size_t>(intervals_));
  for (std::size_t i = 0; i < interval_.size(); ++i) {
    interval_[i].now.setZero();
    for (const Delay& d : delays_) interval_[i].now += d.chip[i];
    interval_[i].settle = (Eigen::Matrix2d::Identity() + end_ * interval_[i].now).inverse();
  }
  keep_history_that_counts();
}

/// Past places that no tooth meets again are not part of the state; nor is a direction in which no mode moves.
void PeriodMap::keep_history_that_counts() {
  std::array<bool, 2> moves{};
  for (const ModeStep& s : steps_)
    for (int c = 0; c < 2; ++c) moves[static_cast<std::size_t>(c)] |= std::abs(s.direction(c)) > 1e-9;
  double largest = 0;
  for (const Interval& i : interval_) largest = std::max(largest, i.now.norm());
  const auto cuts = [&](std::size_t i) { return interval_[i].now.norm() > 1e-9 * largest; };
  kept_.clear();
  for (int knot = 0; knot < history_; ++knot) {
    bool met = !equal_;
    if (equal_) {
      const auto i = static_cast<std::size_t>(knot);
      met = cuts(i) || (i > 0 && cuts(i - 1));
    }
    for (int c = 0; c < 2; ++c)
      if (met && moves[static_cast<std::size_t>(c)]) kept_.push_back({knot, c});
  }
}

/// Place `delay` intervals before a knot: straight where it is a knot, else the cubic through four knots.
Vec2 PeriodMap::delayed(std::size_t knot, double delay) const {
  const double at = static_cast<double>(knot) - delay;
  const auto i = static_cast<std::ptrdiff_t>(std::floor(at + 1e-9));
  const double t = std::max(0.0, at - static_cast<double>(i));
  const auto p = [&](std::ptrdiff_t k) { return place_[static_cast<std::size_t>(std::max<std::ptrdiff_t>(k, 0))]; };
  if (t < 1e-9) return p(i);
  return -t * (t - 1) * (t - 2) / 6 * p(i - 1) + (t + 1) * (t - 1) * (t - 2) / 2 * p(i) -
         (t + 1) * t * (t - 2) / 2 * p(i + 1) + (t + 1) * t * (t - 1) / 6 * p(i + 2);
}

void PeriodMap::apply(const Eigen::VectorXd& from, Eigen::VectorXd& to) {
  const auto n = static_cast<Eigen::Index>(steps_.size());
  to = from;
  std::ranges::fill(place_, Vec2::Zero());
  for (std::size_t i = 0; i < kept_.size(); ++i)
    place_[static_cast<std::size_t>(kept_[i][0])](kept_[i][1]) = from(2 * n + static_cast<Eigen::Index>(i));
  const auto start = static_cast<std::size_t>(history_);
  for (Eigen::Index m = 0; m < n; ++m) place_[start] += from(2 * m) * steps_[static_cast<std::size_t>(m)].direction;
  for (std::size_t i = 0; i < interval_.size(); ++i) {
    Vec2 was = Vec2::Zero(), will = Vec2::Zero();  // the delayed part of the force at both knots
    for (const Delay& d : delays_) {
      if (d.chip[i].isZero(0)) continue;
      was += d.chip[i] * delayed(start + i, d.knots);
      will += d.chip[i] * delayed(start + i + 1, d.knots);
    }
    const Vec2 begin = was - interval_[i].now * place_[start + i];
    Vec2 free = begin_ * begin + end_ * will;
    for (Eigen::Index m = 0; m < n; ++m) {
      const ModeStep& s = steps_[static_cast<std::size_t>(m)];
      free += s.direction * (s.free.row(0) * to.segment<2>(2 * m)).value();
    }
    place_[start + i + 1] = interval_[i].settle * free;
    const Vec2 end = will - interval_[i].now * place_[start + i + 1];
    for (Eigen::Index m = 0; m < n; ++m) {
      const ModeStep& s = steps_[static_cast<std::size_t>(m)];
      to.segment<2>(2 * m) =
          (s.free * to.segment<2>(2 * m) + s.begin * s.direction.dot(begin) + s.end * s.direction.dot(end)).eval();
    }
  }
  const auto later = static_cast<std::size_t>(intervals_);
  for (std::size_t i = 0; i < kept_.size(); ++i)
    to(2 * n + static_cast<Eigen::Index>(i)) = place_[static_cast<std::size_t>(kept_[i][0]) + later](kept_[i][1]);
}

}  // namespace camber::dynamics
