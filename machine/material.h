#pragma once
// Material: force law and its coefficients.
#include <string_view>

#include "machine/force_laws/list.h"

namespace camber::machine {

template <class List>
struct CoefficientsOfAll;
template <class... Laws>
struct CoefficientsOfAll<LawList<Laws...>> : Laws::Coefficients..., EdgeTerms {};

/// Has the coefficients of every law as fields (ktc_MPa, kc1_1_MPa ...) and the edge terms; those of `law` count.
struct Material : CoefficientsOfAll<ForceLaws> {
  ForceLaw law = ForceLaw::linear;
  std::string_view preset = {};  ///< name of the preset that it began with; empty: none

  constexpr Material() = default;
  /// Material with the linear law.
  constexpr Material(double ktc, double krc, double kac, double kte = 0, double kre = 0, double kae = 0) {
    ktc_MPa = ktc, krc_MPa = krc, kac_MPa = kac;
    kte_N_per_mm = kte, kre_N_per_mm = kre, kae_N_per_mm = kae;
  }
};

}  // namespace camber::machine
