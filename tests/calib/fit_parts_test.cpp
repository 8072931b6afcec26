#include "calib/parts_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace camber::calib {
namespace {

using machine::Feature;
using machine::FeatureKind;
using machine::Job;

/// A shop whose true gains, forces, stiffness and tool diameters are hidden from the fit. Sizes by closed forms:
/// bores follow the lag (radius error v^2 / (r K^2)), walls of slots the bending (cantilever and root), both the tool.
struct Shop {
  double gain_x = 60, gain_y = 45;               ///< 1/s
  double cutting_MPa = 900, edge_N_per_mm = 14;  ///< true
  double root_N_per_mm = 9000;
  double offset_mm[2] = {0.004, -0.006};  ///< by clamping: short, long
};

struct Cut {
  double feed_mm_per_s = 0, overhang_mm = 0;
};

/// The closed forms know nothing else of a part's program: its feed is in the job's name.
double feed_of(const Job& job) { return std::stod(job.path.substr(job.path.find('F') + 1)); }

/// The rows of a part: two bores, a slot along X and one along Y, a distance along X.
std::vector<double> sizes_of(const Job& job) {
  const machine::Tool& tool = job.tools.at(1);
  const double v = feed_of(job);
  const double gx = job.machine.axis[0].position_gain_per_s, gy = job.machine.axis[1].position_gain_per_s;
  const double h = v / 300, force = 0.5 * (job.material.ktc_MPa * h * 2 + job.material.kte_N_per_mm * 2);
  const double l = tool.overhang_mm, ei = tool.youngs_modulus_MPa * kPi / 64 * std::pow(0.8 * tool.diameter_mm, 4);
  const double bent = force * (l * l * l / (3 * ei) + 1 / tool.root_stiffness_N_per_mm);
  const auto lag = [&](double r, double g) { return v * v / (r * g * g); };
  std::vector<double> out;
  for (const double r : {0.5, 2.0}) out.push_back(2 * r + 3 - (lag(r, gx) + lag(r, gy)) - 2 * 0.2 * bent);
  out.push_back(6 - 2 * bent - 0.5 * lag(4, gy));
  out.push_back(6 - 2 * bent - 0.5 * lag(4, gx));
  out.push_back(25 + lag(1, gx));
  return out;
}

std::vector<std::optional<PredictedSize>> predict(const Job& job) {
  Job rigid = job;
  rigid.tools.at(1).root_stiffness_N_per_mm = rigid.tools.at(1).youngs_modulus_MPa = 1e15;
  const std::vector<double> sizes = sizes_of(job), unbent = sizes_of(rigid);
  std::vector<std::optional<PredictedSize>> out;
  for (std::size_t i = 0; i < sizes.size(); ++i) out.push_back(PredictedSize{sizes[i], sizes[i] - unbent[i]});
  return out;
}

/// What the user enters: wrong gains, forces and stiffness.
Job entered(const Cut& cut, int number) {
  Job job;
  job.path = "part_" + std::to_string(number) + "_F" + std::to_string(static_cast<int>(cut.feed_mm_per_s)) + ".toml";
  for (machine::Axis& axis : job.machine.axis) axis.position_gain_per_s = 50;
  job.material = machine::Material(600, 200, 0, 14, 5);
  machine::Tool tool;
  tool.number = 1;
  tool.type = machine::ToolType::flat;
  tool.diameter_mm = 6;
  tool.overhang_mm = cut.overhang_mm;
  tool.root_stiffness_N_per_mm = 20000;
  job.tools[1] = tool;
  const char* names[] = {"bore 1", "bore 2", "slot x", "slot y", "distance"};
  const FeatureKind kinds[] = {FeatureKind::bore, FeatureKind::bore, FeatureKind::slot_width, FeatureKind::slot_width,
                               FeatureKind::distance};
  for (int k = 0; k < 5; ++k) {
    Feature f;
    f.name = names[k];
    f.kind = kinds[k];
    f.tool = 1;
    job.features.push_back(f);
  }
  return job;
}

/// Twelve parts: short and long tools, six feeds each; measured with a noise of `noise_mm`.
std::vector<Job> parts(const Shop& shop, unsigned seed, double noise_mm = 0.001) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, noise_mm);
  std::vector<Job> out;
  for (int i = 0; i < 12; ++i) {
    const bool is_long = i % 2 == 1;
    Job job = entered({.feed_mm_per_s = 5.0 + 3 * (i / 2), .overhang_mm = is_long ? 40.0 : 15.0}, i + 1);
    Job real = job;
    real.machine.axis[0].position_gain_per_s = shop.gain_x;
    real.machine.axis[1].position_gain_per_s = shop.gain_y;
    real.material.ktc_MPa = shop.cutting_MPa;
    real.material.kte_N_per_mm = shop.edge_N_per_mm;
    real.tools.at(1).root_stiffness_N_per_mm = shop.root_N_per_mm;
    const std::vector<double> sizes = sizes_of(real);
    for (std::size_t k = 0; k < job.features.size(); ++k) {
      Feature& f = job.features[k];
      f.measured.push_back({.feature = f.name,
                            .part = std::to_string(i + 1),
                            .date = {},
                            .value_mm = sizes[k] + f.size_per_diameter() * shop.offset_mm[is_long] + noise(random)});
    }
    out.push_back(std::move(job));
  }
  return out;
}

FitPartsResult fitted(const std::vector<Job>& jobs, std::vector<std::string> hold_out = {}) {
  FitPartsOptions options;
  options.predict = predict;
  options.hold_out = std::move(hold_out);
  return fit_parts(jobs, options);
}

const PartsParameter& named(const FitPartsResult& r, const std::string& name) {
  for (const auto& p : r.parameters)
    if (p.name == name) return p;
  throw std::runtime_error(name);
}

/// The hidden numbers by the names of the parameters.
std::vector<std::pair<std::string, double>> truth_of(const Shop& shop) {
  return {{"axis.x.position_gain_per_s", shop.gain_x},
          {"axis.y.position_gain_per_s", shop.gain_y},
          {"ktc_MPa", shop.cutting_MPa},
          {"kte_N_per_mm", shop.edge_N_per_mm},
          {"tool.1.root_stiffness_N_per_um", shop.root_N_per_mm / 1000},
          {"tool.1.diameter_mm (overhang 15)", 6 + shop.offset_mm[0]},
          {"tool.1.diameter_mm (overhang 40)", 6 + shop.offset_mm[1]}};
}

TEST(FitParts, FindsTheHiddenShop) {
  const Shop shop;
  const FitPartsResult r = fitted(parts(shop, 1, 0.0003));  // of the noise of 1 um: the next test
  ASSERT_TRUE(r.converged) << r.message;
  for (const auto& [name, value] : truth_of(shop)) {
    const PartsParameter& p = named(r, name);
    ASSERT_TRUE(p.std_error) << name << ": " << p.note;
    const bool diameter = name.find("diameter") != std::string::npos;
    EXPECT_NEAR(p.value, value, diameter ? 0.0007 : 0.05 * value) << name;
  }
  EXPECT_LT(r.rms_um, 0.35);
  EXPECT_NEAR(r.jobs.front().tools.at(1).diameter_mm, named(r, "tool.1.diameter_mm (overhang 15)").value, 1e-12);
}

/// Standard errors are right: squares of the errors over the standard errors add up to the degrees of freedom.
TEST(FitParts, StandardErrorsAreRightAndTheTruthIsWithinTwoOverManySeeds) {
  const Shop shop;
  double square = 0;
  int count = 0, within_two = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const FitPartsResult r = fitted(parts(shop, seed));
    ASSERT_TRUE(r.converged) << seed;
    for (const auto& [name, value] : truth_of(shop)) {
      const PartsParameter& p = named(r, name);
      ASSERT_TRUE(p.std_error) << name;
      square += std::pow((p.value - value) / *p.std_error, 2);
      within_two += std::abs(p.value - value) <= 2 * *p.std_error;
      ++count;
    }
  }
  // Seven parameters of a seed are correlated, up to one degree of freedom a seed: 1 +- 0.2 at two and a half standard
  // deviations of 300.
  EXPECT_GT(within_two, 0.92 * count);  // 0.954 of a normal distribution
  EXPECT_NEAR(square / count, 1, 0.2);
}

TEST(FitParts, WhatCannotBeToldApartIsSaidSo) {
  // Bores alone tell one gain for X and Y; short tools alone neither root nor force.
  std::vector<Job> jobs = parts({}, 5);
  std::erase_if(jobs, [](const Job& j) { return j.tools.at(1).overhang_mm > 20; });
  for (Job& job : jobs) job.features.resize(2);
  FitPartsOptions options;
  options.predict = [](const Job& job) {
    auto out = predict(job);
    out.resize(2);
    return out;
  };
  const FitPartsResult r = fit_parts(jobs, options);
  EXPECT_EQ(named(r, "axis.x.position_gain_per_s").note, "X and Y together: their ratio is not determined");
  EXPECT_FALSE(named(r, "tool.1.root_stiffness_N_per_um").std_error);
  EXPECT_EQ(named(r, "tool.1.root_stiffness_N_per_um").value, 20);
  EXPECT_FALSE(r.confounded.empty());
  EXPECT_EQ(r.confounded.size(), r.suggestions.size());
}

TEST(FitParts, AnOutlierDoesNotMoveTheFit) {
  std::vector<Job> jobs = parts({}, 7);
  const FitPartsResult clean = fitted(jobs);
  jobs[3].features[2].measured.front().value_mm += 0.2;  // an unstable cut
  const FitPartsResult dirty = fitted(jobs);
  const PartsParameter &a = named(clean, "ktc_MPa"), &b = named(dirty, "ktc_MPa");
  ASSERT_TRUE(a.std_error && b.std_error);
  EXPECT_NEAR(a.value, b.value, 2 * *a.std_error);
}

TEST(FitParts, HeldOutPartsAreJudgedAndNotFitted) {
  std::vector<Job> jobs = parts({}, 9);
  for (Feature& f : jobs[4].features) f.measured.front().value_mm += 0.05;
  const FitPartsResult r = fitted(jobs, {"part_5_F11"});
  EXPECT_LT(r.rms_um, 1.3);
  for (const PartsGroup& g : r.groups) EXPECT_NEAR(*g.held_out_rms_um, 50, 5);
}

TEST(FitParts, DriftOfDatedPartsIsFound) {
  std::vector<Job> jobs = parts({}, 11);
  for (std::size_t i = 0; i < jobs.size(); ++i)
    for (Feature& f : jobs[i].features) {
      f.measured.front().date = "2026-11-03T" + std::string(i < 4 ? "0" : "") + std::to_string(6 + i) + ":00";
      f.measured.front().value_mm += 0.024 * static_cast<double>(i) / 24;  // 24 um a day
    }
  const FitPartsResult r = fitted(jobs);
  const PartsParameter& drift = named(r, "drift");
  ASSERT_TRUE(drift.std_error);
  EXPECT_NEAR(drift.value, 24, 3 * *drift.std_error);
}

TEST(FitParts, NothingMeasuredIsAnError) {
  std::vector<Job> jobs = parts({}, 1);
  for (Job& job : jobs)
    for (Feature& f : job.features) f.measured.clear();
  try {
    fitted(jobs);
    FAIL();
  } catch (const InputError& problem) {
    EXPECT_EQ(
        std::string(problem.what()),
        "part_1_F5.toml: error: no feature has a measured value; [[feature]] with measured_mm or measured was expected "
        "[parts-unmeasured]");
  }
}

}  // namespace
}  // namespace camber::calib
