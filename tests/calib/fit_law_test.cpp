// fit-force of every force law: data made with a law gives its coefficients back.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calib/force_fit.h"
#include "tests/support/law_material.h"
#include "tests/support/temp_folder.h"

namespace camber::calib {
namespace {

using machine::ForceLawDescription;
using machine::Material;

/// Means of slots, mm per tooth, without noise.
std::string slot_means(const Material& material) {
  machine::Tool tool;
  tool.type = machine::ToolType::flat;
  tool.diameter_mm = 20, tool.flutes = 3, tool.overhang_mm = 60;
  std::string log = "feed_mm_per_min,fx,fy,fz\n";
  for (const double f : {0.02, 0.04, 0.08, 0.15}) {
    const Vec3 mean = deflection::SteadyCutModel(tool, {f, 2, 20, deflection::Milling::up}).mean_N(material);
    log += fmt::format("{},{:.9f},{:.9f},{:.9f}\n", f * 9000, mean.x(), mean.y(), mean.z());
  }
  return log;
}

FitForceResult fit(const std::string& log, const std::string& lines) {
  const tests::TempFolder folder;
  const std::string log_path = folder.write("log.csv", log);
  const std::string job = folder.write(
      "job.toml",
      "[tool.1]\ntype = \"flat\"\ndiameter_mm = 20.0\nflutes = 3\noverhang_mm = 60.0\n[force_log]\n"
      "contents = \"means\"\nspindle_rpm = 3000\nap_mm = 2\nae_mm = 20\nfx = \"fx\"\nfy = \"fy\"\nfz = \"fz\"\n" +
          lines);
  Diagnostics diagnostics;
  const auto how = machine::read_force_log(job, diagnostics);
  return fit_force({read_measured_log(log_path, how, diagnostics)});
}

std::string law_line(const ForceLawDescription& law) { return fmt::format("law = \"{}\"\n", law.word); }

/// Of shape coefficients by themselves, of forces as a fraction.
void expect_near(double fitted, double truth, const machine::Coefficient& c) {
  const double scale = c.role == machine::CoefficientRole::shape && c.unit == "1" ? 1 : std::abs(truth);
  EXPECT_NEAR(fitted, truth, 1e-3 * scale) << c.key;
}

TEST(FitOfEachLaw, GivesTheCoefficientsBack) {
  for (const auto& law : machine::force_laws()) {
    SCOPED_TRACE(law.word);
    const Material truth = tests::material_of(law);
    const FitForceResult r = fit(slot_means(truth), law_line(law));
    EXPECT_TRUE(r.converged && r.plausible) << r.message;
    EXPECT_LT(r.residual_rms_N, 1e-3);
    ASSERT_EQ(r.parameters.size(), law.fitted.size());
    EXPECT_EQ(r.material.law, truth.law);
    for (std::size_t i = 0; i < law.fitted.size(); ++i) {
      const machine::Coefficient& c = law.fitted[i];
      EXPECT_EQ(r.parameters[i].name, c.key);
      EXPECT_EQ(r.parameters[i].unit, c.unit);
      expect_near(r.parameters[i].value, truth.*c.field, c);
    }
    for (const auto& c : law.coefficients) expect_near(r.material.*c.field, truth.*c.field, c);
  }
}

TEST(FitOfEachLaw, HoldsAnyCoefficient) {
  for (const auto& law : machine::force_laws())
    for (const auto& held : law.fitted) {
      SCOPED_TRACE(held.key);
      const Material truth = tests::material_of(law);
      std::string material = fmt::format("[material]\nlaw = \"{}\"\n", law.word);
      for (const auto& c : law.coefficients) material += fmt::format("{} = {:.17g}\n", c.key, truth.*c.field);
      const FitForceResult r =
          fit(slot_means(truth), law_line(law) + fmt::format("hold = [\"{}\"]\n", held.key) + material);
      for (const auto& p : r.parameters) EXPECT_EQ(p.note == "held", p.name == held.key) << p.name;
      EXPECT_EQ(r.material.*held.field, truth.*held.field);
      for (const auto& c : law.fitted) expect_near(r.material.*c.field, truth.*c.field, c);
    }
}

TEST(FitOfEachLaw, ANegativeCuttingForceIsImplausible) {
  for (const auto& law : machine::force_laws()) {
    Material m = tests::material_of(law);
    std::string log = slot_means(m);
    // The forces of a mirrored cutter: every component turned round.
    log = log.substr(0, log.find('\n') + 1);
    for (const double f : {0.02, 0.04, 0.08, 0.15}) {
      machine::Tool tool;
      tool.type = machine::ToolType::flat;
      tool.diameter_mm = 20, tool.flutes = 3, tool.overhang_mm = 60;
      const Vec3 mean = -deflection::SteadyCutModel(tool, {f, 2, 20, deflection::Milling::up}).mean_N(m);
      log += fmt::format("{},{:.9f},{:.9f},{:.9f}\n", f * 9000, mean.x(), mean.y(), mean.z());
    }
    EXPECT_FALSE(fit(log, law_line(law)).plausible) << law.word;
  }
}

}  // namespace
}  // namespace camber::calib
