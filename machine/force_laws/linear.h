#pragma once
// The linear edge law: k is constant, F = (k_c h + k_e) b.
// Source: Altintas, Manufacturing Automation, 2nd ed., ch. 2.
#include "machine/force_laws/law.h"

namespace camber::machine {

struct LinearLaw {
  struct Coefficients {
    double ktc_MPa = 0, krc_MPa = 0, kac_MPa = 0;
  };

  static constexpr std::string_view word = "linear";
  static constexpr std::string_view title = "Linear edge force law";
  static constexpr bool affine = true;
  static constexpr bool fits_edge_terms = true;
  static constexpr std::array coefficients{
      CoefficientOf<Coefficients>{"ktc_MPa", "ktc", "MPa", "tangential cutting force per area of chip",
                                  &Coefficients::ktc_MPa, Component::tangential, CoefficientRole::cutting, kNotNegative,
                                  true},
      CoefficientOf<Coefficients>{"krc_MPa", "krc", "MPa", "radial cutting force per area of chip",
                                  &Coefficients::krc_MPa, Component::radial, CoefficientRole::cutting, kNotNegative,
                                  true},
      CoefficientOf<Coefficients>{"kac_MPa", "kac", "MPa", "axial cutting force per area of chip",
                                  &Coefficients::kac_MPa, Component::axial, CoefficientRole::cutting, kAnyNumber},
  };

  static Components specific_MPa(const Coefficients& c, double /*h_mm*/) { return {c.ktc_MPa, c.krc_MPa, c.kac_MPa}; }
  static Components slope_MPa(const Coefficients& c, double /*h_mm*/) { return {c.ktc_MPa, c.krc_MPa, c.kac_MPa}; }

  static void start(const LinearForce& f, double /*h_mm*/, Coefficients& c, EdgeTerms& e) {
    c = {f.cutting_MPa.tangential, f.cutting_MPa.radial, f.cutting_MPa.axial};
    e = {f.edge_N_per_mm.tangential, f.edge_N_per_mm.radial, f.edge_N_per_mm.axial};
  }
};

}  // namespace camber::machine
