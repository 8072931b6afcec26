#pragma once
// Kienzle's law: k = k_1.1 h^-m with h in mm; k_1.1 is the specific cutting force at h = b = 1 mm.
// Source: O. Kienzle, Die Bestimmung von Kraeften und Leistungen an spanenden Werkzeugen und Werkzeugmaschinen,
// VDI-Z 94 (1952) 299-305.
#include <cmath>
#include <span>

#include "machine/force_laws/law.h"

namespace camber::machine {

struct KienzleLaw {
  struct Coefficients {
    double kc1_1_MPa = 0, mc = 0;  ///< tangential
    double kr1_1_MPa = 0, mr = 0;  ///< radial
    double ka1_1_MPa = 0, ma = 0;  ///< axial
  };

  static constexpr std::string_view word = "kienzle";
  static constexpr std::string_view title = "Kienzle’s force law";
  static constexpr bool affine = false;
  static constexpr bool fits_edge_terms = false;  ///< Kienzle's own law has none
  static constexpr NumberRange exponent_range{.min = 0, .max = 0.9};
  static constexpr std::array coefficients{
      CoefficientOf<Coefficients>{"kc1_1_MPa", "kc1.1", "MPa", "tangential specific cutting force at h = 1 mm",
                                  &Coefficients::kc1_1_MPa, Component::tangential, CoefficientRole::cutting, kPositive,
                                  true},
      CoefficientOf<Coefficients>{"mc", "mc", "1", "tangential exponent of the chip thickness", &Coefficients::mc,
                                  Component::tangential, CoefficientRole::shape, exponent_range, true},
      CoefficientOf<Coefficients>{"kr1_1_MPa", "kr1.1", "MPa", "radial specific cutting force at h = 1 mm",
                                  &Coefficients::kr1_1_MPa, Component::radial, CoefficientRole::cutting, kAnyNumber},
      CoefficientOf<Coefficients>{"mr", "mr", "1", "radial exponent of the chip thickness", &Coefficients::mr,
                                  Component::radial, CoefficientRole::shape, exponent_range},
      CoefficientOf<Coefficients>{"ka1_1_MPa", "ka1.1", "MPa", "axial specific cutting force at h = 1 mm",
                                  &Coefficients::ka1_1_MPa, Component::axial, CoefficientRole::cutting, kAnyNumber},
      CoefficientOf<Coefficients>{"ma", "ma", "1", "axial exponent of the chip thickness", &Coefficients::ma,
                                  Component::axial, CoefficientRole::shape, exponent_range},
  };
  static constexpr std::array<std::string_view, 3> further_keys{"krc_ratio", "kac_ratio", "kc_by_feed"};
  static constexpr std::array<std::string_view, 2> shown_by{"kc1_1_MPa", "kc_by_feed"};
  static constexpr std::array<std::string_view, 4> header_keys{"kc1_1_MPa", "mc", "kte_N_per_mm", "kre_N_per_mm"};

  static Components specific_MPa(const Coefficients& c, double h) {
    // Equal exponents are worked out once.
    const double tangential = std::pow(h, -c.mc);
    const double radial = c.mr == c.mc ? tangential : std::pow(h, -c.mr);
    const double axial = c.ma == c.mc ? tangential : c.ka1_1_MPa == 0 ? 0 : std::pow(h, -c.ma);
    return {c.kc1_1_MPa * tangential, c.kr1_1_MPa * radial, c.ka1_1_MPa * axial};
  }
  static Components slope_MPa(const Coefficients& c, double h) {
    const Components k = specific_MPa(c, h);
    return {k.tangential * (1 - c.mc), k.radial * (1 - c.mr), k.axial * (1 - c.ma)};
  }

  /// Exponents from 0.05 to 0.7.
  static void start(const LinearForce& f, double h_mm, Coefficients& c, EdgeTerms& e);
  /// Takes the tangential pair from kc_by_feed as well, the others as ratios to it.
  static void read(TomlTable& table, const MaterialPreset* preset, Coefficients& c);
};

/// A row of a cutting-data catalogue: the specific cutting force at a feed per tooth.
struct CatalogueRow {
  double feed_per_tooth_mm = 0, kc_MPa = 0;
};

/// Kienzle's k_c1.1 and m_c such that a full slot has the table's specific energy at its feeds per tooth:
///   u(f) = int k h^(1-m) dphi / int h dphi = k_c1.1 f^-m w(m),  h = f sin phi, phi = 0 ... pi,
///   w(m) = 1/2 int sin^(1-m) phi dphi = sqrt(pi)/2 Gamma(1 - m/2) / Gamma(3/2 - m/2),
/// by a straight line through the logarithms. Catalogues give k_c to work out the power of a mill from the metal that
/// it removes, which is this u; without the radial depth that theirs was measured at, the slot stands for it.
/// At least two rows of different feeds.
struct KienzlePair {
  double k1_1_MPa = 0, m = 0;
  double worst_fraction = 0;  ///< largest |k_c of the line / k_c of the table - 1|
};
KienzlePair kienzle_from_catalogue(std::span<const CatalogueRow> rows);

}  // namespace camber::machine
