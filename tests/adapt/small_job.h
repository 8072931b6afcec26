#pragma once
// Jobs of one straight-fluted end mill on a block, whose greatest force has a closed form.
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "adapt/adaptation.h"
#include "machine/job_file.h"
#include "tests/support/temp_folder.h"

namespace camber::adapt::tests {

using camber::tests::TempFolder;

constexpr double kKtc = 1800, kKrc = 600, kKte = 12, kKre = 10;
constexpr double kRadius_mm = 5, kRpm = 6000;
constexpr int kFlutes = 2;

struct SmallJob {
  std::string program;
  std::string box_mm = "[[0, 0, -2], [70, 20, 0]]";
  std::string limits = "force_N = 250.0";
  std::string feeds = "[100, 4000]";
  double acceleration_mm_per_s2 = 5000;
  std::string more{};  ///< further lines of the machine's axes
  std::string simulation = "coupling = \"rigid\"";
};

/// The files of a job in `folder`.
inline void write_job(const TempFolder& folder, const SmallJob& s) {
  folder.write("p.nc", s.program);
  std::string machine =
      "[control]\nperiod_ms = 1.0\ncorner = { law = \"speed_difference\", speed_difference_mm_per_min = 60.0 }\n";
  for (const char* axis : {"x", "y", "z"})
    machine += fmt::format("[axis.{}]\nacceleration_mm_per_s2 = {}\nposition_gain_per_s = 80\n{}", axis,
                           s.acceleration_mm_per_s2, s.more);
  folder.write("machine.toml", machine + "[spindle]\nmax_rpm = 12000\n");
  folder.write("job.toml",
               fmt::format(R"(program = "p.nc"
machine = "machine.toml"
[tool.1]
type = "flat"
diameter_mm = {}
flutes = {}
overhang_mm = 30.0
[material]
ktc_MPa = {}
krc_MPa = {}
kte_N_per_mm = {}
kre_N_per_mm = {}
[stock]
box_mm = {}
[simulation]
voxel_mm = 0.2
{}
[adapt]
limits = {{ {} }}
feed_mm_per_min = {}
)",
                           2 * kRadius_mm, kFlutes, kKtc, kKrc, kKte, kKre, s.box_mm, s.simulation, s.limits, s.feeds));
}

struct Adapted {
  machine::Job job;
  AdaptResult result;
};
inline Adapted adapted(const TempFolder& folder, const SmallJob& s, const AdaptOptions& options = {}) {
  write_job(folder, s);
  Diagnostics diagnostics;
  Adapted out{machine::read_job(folder / "job.toml", diagnostics), {}};
  out.result = adapt(out.job, diagnostics, options);
  return out;
}

/// Force of one straight tooth at the chip thickness h on the depth of cut a_p: sqrt((Ktc h + Kte)^2 + (Krc h + Kre)^2)
/// a_p. Solved for h.
inline double chip_of_force(double force_N, double axial_depth_mm) {
  const double f = force_N / axial_depth_mm;
  const double a = kKtc * kKtc + kKrc * kKrc, b = 2 * (kKtc * kKte + kKrc * kKre),
               c = kKte * kKte + kKre * kKre - f * f;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

/// mm/s, at which the thickest chip of a shoulder of radial depth a_e < R (a slot: R) is h = f_z sin(acos(1 - a_e/R)).
inline double feed_of_chip(double chip_mm, double radial_depth_mm) {
  const double cosine = 1 - radial_depth_mm / kRadius_mm;
  return chip_mm / std::sqrt(1 - cosine * cosine) * kFlutes * kRpm / 60;
}

}  // namespace camber::adapt::tests
