#pragma once
// What a material asks of the cutter: the coefficients of the force law.
#include <array>
#include <cmath>
#include <span>
#include <string_view>

namespace camber::machine {

enum class ForceLaw { linear, kienzle };

/// Force per width of edge, tangential, radial and axial:
///   linear:   F/b = k_c h + k_e                                    [N/mm] = [MPa][mm] + [N/mm]
///   kienzle:  F/b = k_1.1 h^(1 - m) + k_e, h in mm; k_1.1 is the specific cutting force at h = b = 1 mm
/// The edge terms k_e belong to both; Kienzle's own law has none (zero).
struct Material {
  double ktc_MPa = 0, krc_MPa = 0, kac_MPa = 0;
  double kte_N_per_mm = 0, kre_N_per_mm = 0, kae_N_per_mm = 0;
  ForceLaw law = ForceLaw::linear;
  double kc1_1_MPa = 0, mc = 0;  ///< tangential
  double kr1_1_MPa = 0, mr = 0;  ///< radial
  double ka1_1_MPa = 0, ma = 0;  ///< axial
  std::string_view preset = {};  ///< name of the preset that it began with; empty: none
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
