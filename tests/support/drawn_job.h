#pragma once
// The drawn cut (tests/support/displaced_envelope.h) of a job with one tool on a box.
#include <cmath>

#include "machine/job_file.h"
#include "tests/support/displaced_envelope.h"

namespace camber::testing {

/// All but the profile (corner, top), the stamps and the steps.
inline DrawnCut drawn_cut_of(const machine::Job& job) {
  const machine::Tool& tool = job.tools.at(1);
  const auto& m = job.material;
  DrawnCut c;
  c.radius = tool.diameter_mm / 2;
  c.flutes = tool.flutes;
  c.helix_rad = tool.helix_rad;
  c.lo = job.stock.box->min_mm, c.hi = job.stock.box->max_mm;
  c.k = {m.ktc_MPa, m.krc_MPa, m.kac_MPa, m.kte_N_per_mm, m.kre_N_per_mm, m.kae_N_per_mm};
  c.overhang = tool.overhang_mm;
  c.bending_stiffness_N_mm2 =
      tool.youngs_modulus_MPa * kPi / 64 * std::pow(tool.effective_diameter_ratio * tool.diameter_mm, 4);
  c.allowance = job.stock.allowance_mm;
  return c;
}

}  // namespace camber::testing
