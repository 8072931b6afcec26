#include "report/forces_csv.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "base/output_file.h"

namespace camber::report {
namespace {

using Tooth = deflection::TurnForces::Tooth;

Tooth at_degree(const std::vector<Tooth>& steps, int degree) {
  const double place = degree * static_cast<double>(steps.size()) / 360;
  const auto i = static_cast<std::size_t>(place);
  const double f = place - static_cast<double>(i);
  const Tooth &a = steps[i % steps.size()], &b = steps[(i + 1) % steps.size()];
  return {(1 - f) * a.force_N + f * b.force_N, (1 - f) * a.torque_Nmm + f * b.torque_Nmm,
          (1 - f) * a.chip_max_mm + f * b.chip_max_mm};
}

}  // namespace

void write_forces_at_csv(const std::string& path, const deflection::TurnForces& turn) {
  std::string out = "angle_deg";
  const auto to = std::back_inserter(out);
  for (std::size_t t = 1; t <= turn.teeth.size(); ++t)
    fmt::format_to(to, ",fx_{0}_N,fy_{0}_N,fz_{0}_N,h_max_{0}_mm", t);
  out += ",fx_N,fy_N,fz_N,torque_Nm\n";
  for (int degree = 0; degree < 360; ++degree) {
    Tooth sum;
    fmt::format_to(to, "{}", degree);
    for (const auto& steps : turn.teeth) {
      const Tooth tooth = at_degree(steps, degree);
      const Vec3& f = tooth.force_N;
      fmt::format_to(to, ",{:.4f},{:.4f},{:.4f},{:.6f}", f.x(), f.y(), f.z(), tooth.chip_max_mm);
      sum.force_N += f;
      sum.torque_Nmm += tooth.torque_Nmm;
    }
    fmt::format_to(to, ",{:.4f},{:.4f},{:.4f},{:.6f}\n", sum.force_N.x(), sum.force_N.y(), sum.force_N.z(),
                   sum.torque_Nmm / 1000);
  }
  write_file(path, out);
}

}  // namespace camber::report
