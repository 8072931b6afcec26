#include "adapt/load.h"

#include <cmath>
#include <limits>
#include <optional>

namespace camber::adapt {
namespace {

constexpr std::array<LoadText, kLoads + 1> kTexts{{
    {"force_N", "lateral force", "N", 1, 1},
    {"torque_Nm", "torque", "N m", 0.001, 3},
    {"deflection_um", "deflection of the tip", "um", 1000, 1},
    {"form_error_um", "form error", "um", 1000, 1},
    {"chip_mm", "chip thickness", "mm", 1, 4},
    {"power_W", "power", "W", 1, 1},
    {"chip_min_mm", "chip thickness, at least", "mm", 1, 4},
}};

double power_of(double ratio, double exponent) { return exponent == 1 ? ratio : std::pow(ratio, exponent); }

double exponent_of(Load load, float exponent) {
  return index_of(load) == index_of(Load::chip) ? 1.0 : static_cast<double>(exponent);
}

}  // namespace

const LoadText& text_of(Load load) { return kTexts[static_cast<std::size_t>(load)]; }

std::vector<LoadLimit> limits_of(const machine::AdaptLimits& limits) {
  std::vector<LoadLimit> out;
  const auto add = [&](Load load, const std::optional<double>& value) {
    if (value) out.push_back({load, *value});
  };
  add(Load::force, limits.force_N);
  add(Load::torque, limits.torque_Nmm);
  add(Load::deflection, limits.deflection_mm);
  add(Load::form_error, limits.form_error_mm);
  add(Load::chip, limits.chip_mm);
  add(Load::power, limits.power_W);
  add(Load::chip_min, limits.chip_min_mm);
  return out;
}

double LoadCurve::at(double ratio, double exponent) const {
  return std::abs(static_cast<double>(edge) + static_cast<double>(shear) * power_of(ratio, exponent));
}

double LoadCurve::max_ratio(double limit, double exponent) const {
  if (std::abs(static_cast<double>(edge)) > limit) return 0;
  if (shear == 0) return std::numeric_limits<double>::infinity();
  const double bound = shear > 0 ? limit : -limit;
  const double x = (bound - static_cast<double>(edge)) / static_cast<double>(shear);
  return exponent == 1 ? x : std::pow(x, 1 / exponent);
}

double LoadPoint::at(Load load, double feed) const {
  return curve[index_of(load)].at(feed / feed_mm_per_s, exponent_of(load, exponent));
}

double LoadPoint::max_feed_mm_per_s(const LoadLimit& limit) const {
  return feed_mm_per_s * curve[index_of(limit.load)].max_ratio(limit.value, exponent_of(limit.load, exponent));
}

}  // namespace camber::adapt
