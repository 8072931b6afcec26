#pragma once
// Poles of a frequency response: a rational fraction in partial fractions whose poles are moved until they fit.
#include <complex>
#include <span>
#include <vector>

namespace camber::dynamics {

/// `pairs` complex pole pairs of sum of residues / (s - pole) + d + e / s^2, those with the positive imaginary part,
/// rad/s. `value` a receptance, `weight` of each point; frequencies above zero.
/// Source: Gustavsen, Semlyen 1999 (see fit_modes.h).
std::vector<std::complex<double>> fitted_poles(std::span<const double> hz, std::span<const std::complex<double>> value,
                                               std::span<const double> weight, int pairs);

}  // namespace camber::dynamics
