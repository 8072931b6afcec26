#include "deflection/static_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace camber::deflection {

namespace {

constexpr double kMotionChange = 0.1;     ///< fraction of the feed per tooth
constexpr double kMaterialChange = 0.06;  ///< fraction of the glance
constexpr double kCautious = 0.9, kFaster = 2;
constexpr double kRemembered = 0.5;  ///< fraction of an error that is kept where the next one is smaller by chance

}  // namespace

bool ReadingPace::has_line(std::size_t passing) const { return tooth(passing).readings > 1; }

bool ReadingPace::may_follow(std::size_t passing, const removal::Stamp& stamp) {
  if (stamp.first) {
    gap_ = 1;
    error_um_ = 0;
    for (Tooth& t : of_tooth_) t.readings = 0;
  }
  const Tooth& t = tooth(passing);
  return has_line(passing) && t.last_glance > 0 && passing - t.last < gap_ * of_tooth_.size() &&
         (stamp.feed_per_tooth_mm - t.feed_mm).norm() <= kMotionChange * t.feed_mm.norm();
}

/// Distance of a passing from the middle of the last two readings, in units of their distance.
double ReadingPace::Tooth::way_to(std::size_t passing) const {
  return 0.5 + static_cast<double>(passing - last) / static_cast<double>(last - before);
}

void ReadingPace::follow(std::size_t passing, std::span<float> row) const {
  const Tooth& t = tooth(passing);
  const auto way = static_cast<float>(t.slope_fraction * t.way_to(passing));
  for (std::size_t i = 0; i < row.size(); ++i)
    row[i] = 0.5f * (t.last_row[i] + t.before_row[i]) + way * (t.last_row[i] - t.before_row[i]);
}

bool ReadingPace::as_much_material(std::size_t passing, double glance) const {
  const Tooth& t = tooth(passing);
  const double way = t.slope_fraction * t.way_to(passing);
  const double expected = 0.5 * (t.last_glance + t.before_glance) + way * (t.last_glance - t.before_glance);
  return std::abs(glance - expected) <= kMaterialChange * t.last_glance;
}

/// Finds the fraction of the line's slope that fits a reading best, and averages it with the one before.
void ReadingPace::Tooth::fit_slope(std::size_t passing, std::span<const float> row) {
  const auto way = static_cast<float>(way_to(passing));
  double along = 0, line2 = 0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const auto line = static_cast<double>(way * (last_row[i] - before_row[i]));
    along += line * static_cast<double>(row[i] - 0.5f * (last_row[i] + before_row[i]));
    line2 += line * line;
  }
  slope_fraction = 0.5 * (slope_fraction + (line2 > 0 ? std::clamp(along / line2, 0.0, 1.0) : 0.0));
}

/// The error of a line grows with the square of the passings that it bridges.
std::size_t ReadingPace::next_gap(std::size_t turns, const Reading& reading) const {
  if (!reading.settled) return 1;
  const double may = kCautious * std::sqrt(reading.allowed_um / std::max(error_um_, 1e-9));
  const double gap = std::round(std::min(kFaster, may) * static_cast<double>(turns));
  return std::clamp<std::size_t>(static_cast<std::size_t>(gap), 1, longest_);
}

void ReadingPace::was_read(std::size_t passing, const removal::Stamp& stamp, std::span<const float> row,
                           const Reading& reading) {
  Tooth& t = tooth(passing);
  const std::size_t turns = t.readings == 0 ? 1 : std::max<std::size_t>(1, (passing - t.last) / of_tooth_.size());
  if (turns > 1 && turns >= gap_) errors_.add({1, reading.error_um * reading.error_um, reading.error_um});
  gap_ = 1;
  if (t.readings > 1) {
    error_um_ = std::max(reading.error_um, kRemembered * error_um_);
    t.fit_slope(passing, row);
    gap_ = next_gap(turns, reading);
  }
  std::swap(t.before_row, t.last_row);
  t.last_row.assign(row.begin(), row.end());
  t.before_glance = std::exchange(t.last_glance, reading.glance);
  t.before = std::exchange(t.last, passing);
  t.feed_mm = stamp.feed_per_tooth_mm;
  ++t.readings;
}

}  // namespace camber::deflection
