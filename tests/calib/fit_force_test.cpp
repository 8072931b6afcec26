// fit-force against published means, closed forms and an independent simulator.
#include "calib/force_fit.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "test_paths.h"
#include "tests/support/milling_simulator.h"
#include "tests/support/temp_folder.h"

namespace camber::calib {
namespace {

using tests::replaced;
using tests::TempFolder;

constexpr const char* kTool = R"([tool.1]
type = "flat"
diameter_mm = 20.0
flutes = 3
helix_deg = 30.0
overhang_mm = 60.0
)";

struct Outcome {
  FitForceResult result;
  std::string messages;
};

/// Fits log.csv as job.toml says; messages name files without their folder.
Outcome fit(const std::string& log, const std::string& job) {
  const TempFolder folder;
  const std::string log_path = folder.write("log.csv", log), job_path = folder.write("job.toml", job);
  Outcome out;
  Diagnostics diagnostics;
  try {
    const auto how = machine::read_force_log(job_path, diagnostics);
    out.result = fit_force({read_measured_log(log_path, how, diagnostics)});
    for (const auto& d : diagnostics.all()) out.messages += to_string(d) + "\n";
  } catch (const InputError& problem) {
    out.messages = problem.what();
  }
  out.messages = replaced(out.messages, folder.path() + "/", "");
  return out;
}

double value_of(const FitForceResult& r, std::string_view name) {
  for (const auto& p : r.parameters)
    if (p.name == name) return p.value;
  ADD_FAILURE() << name;
  return 0;
}

std::string means_job(std::string_view more = "") {
  return std::string(kTool) + "[force_log]\ncontents = \"means\"\nspindle_rpm = 3000\nap_mm = 2\nae_mm = 20\n" +
         "fx = \"fx\"\nfy = \"fy\"\nfz = \"fz\"\n" + std::string(more);
}

/// Means of slots by the closed form (Altintas), on the tool: feed, left of it, up.
std::string slot_means(std::initializer_list<double> feeds_per_tooth) {
  const double n = 3, a = 2, pi = std::acos(-1.0);
  std::string out = "feed_mm_per_min,fx,fy,fz\n";
  for (const double f : feeds_per_tooth)
    out += fmt::format("{},{:.9f},{:.9f},{:.9f}\n", f * 9000, -n * a * f / 4 * 700 - n * a / pi * 12,
                       n * a * f / 4 * 2000 + n * a / pi * 15, -n * a * f / pi * 300 - n * a / 2 * 5);
  return out;
}

TEST(FitForce, PublishedSlotMeansGiveThePublishedCoefficients) {
  const std::string folder = CAMBER_SOURCE_DIR "/samples/03-force-fit/";
  Diagnostics diagnostics;
  const auto how = machine::read_force_log(folder + "job.toml", diagnostics);
  const auto r = fit_force({read_measured_log(folder + "means.csv", how, diagnostics)});
  EXPECT_TRUE(r.converged);
  const std::pair<const char*, double> published[] = {{"ktc_MPa", 958.9},      {"krc_MPa", 250.9},
                                                      {"kac_MPa", 146.4},      {"kte_N_per_mm", 15.76},
                                                      {"kre_N_per_mm", 19.43}, {"kae_N_per_mm", 18.21}};
  for (const auto& [name, value] : published) EXPECT_NEAR(value_of(r, name), value, 0.005 * value) << name;
  for (const auto& cut : r.cuts) EXPECT_LT((cut.measured_N - cut.model_N).cwiseAbs().maxCoeff(), 8) << cut.name;
  EXPECT_TRUE(r.held_out_rms_N);
}

TEST(FitForce, ClosedFormMeansGiveTheirCoefficientsBack) {
  const auto [r, messages] = fit(slot_means({0.02, 0.05, 0.1}), means_job());
  EXPECT_EQ(messages, "");
  EXPECT_NEAR(value_of(r, "ktc_MPa"), 2000, 0.01);
  EXPECT_NEAR(value_of(r, "krc_MPa"), 700, 0.01);
  EXPECT_NEAR(value_of(r, "kac_MPa"), 300, 0.01);
  EXPECT_NEAR(value_of(r, "kte_N_per_mm"), 15, 1e-3);
  EXPECT_NEAR(value_of(r, "kre_N_per_mm"), 12, 1e-3);
  EXPECT_NEAR(value_of(r, "kae_N_per_mm"), 5, 1e-3);
}

TEST(FitForce, StandardErrorsAreThoseOfAStraightLine) {
  // In a slot Fy = (N a / 4) Ktc f + (N a / pi) Kte: a line through five points; but the errors share one variance.
  const std::string folder = CAMBER_SOURCE_DIR "/samples/03-force-fit/";
  Diagnostics diagnostics;
  const auto how = machine::read_force_log(folder + "job.toml", diagnostics);
  const auto r = fit_force({read_measured_log(folder + "means.csv", how, diagnostics)});
  double squares = 0, sxx = 0;
  for (const auto& cut : r.cuts) squares += (cut.measured_N - cut.model_N).squaredNorm();
  for (int i = -2; i <= 2; ++i) sxx += std::pow(0.025 * i, 2);
  const double slope_error = std::sqrt(squares / (15 - 6) / sxx);
  EXPECT_NEAR(*r.parameters[0].std_error, slope_error / 1.5, 1e-3 * slope_error);
}

TEST(FitForce, RefusesOneFeedForItTellsNoEdgeTerms) {
  EXPECT_EQ(fit(slot_means({0.05, 0.05}), means_job()).messages,
            "log.csv: error: the cuts do not determine ktc_MPa and kte_N_per_mm and krc_MPa and kre_N_per_mm and "
            "kac_MPa and kae_N_per_mm: all cuts have one feed per tooth, 0.05 mm; cuts at different feeds were "
            "expected (hold = [\"ktc_MPa\", \"kte_N_per_mm\", \"krc_MPa\", \"kre_N_per_mm\", \"kac_MPa\", "
            "\"kae_N_per_mm\"] in [force_log] keeps the values of [material]) [not-identifiable]");
}

TEST(FitForce, RefusesAxialCoefficientsWithoutAxialForceUnlessHeld) {
  const std::string log = slot_means({0.02, 0.05, 0.1}), without = replaced(means_job(), "fz = \"fz\"\n", "");
  EXPECT_EQ(
      fit(log, without).messages,
      "log.csv: error: the cuts do not determine kac_MPa and kae_N_per_mm: the log has no fz, the force along the axis "
      "(hold = [\"kac_MPa\", \"kae_N_per_mm\"] in [force_log] keeps the values of [material]) [not-identifiable]");
  const std::string held =
      without +
      "hold = [\"kac_MPa\", \"kae_N_per_mm\"]\n[material]\nktc_MPa = 1\nkrc_MPa = 1\nkac_MPa = 111\n"
      "kae_N_per_mm = 2\n";
  const auto [r, messages] = fit(log, held);
  EXPECT_EQ(messages, "");
  EXPECT_EQ(r.material.kac_MPa, 111);
  EXPECT_EQ(r.material.kae_N_per_mm, 2);
  EXPECT_NEAR(r.material.ktc_MPa, 2000, 0.01);
}

TEST(FitForce, RefusesAFeedForceAloneInASlot) {
  const std::string without = replaced(replaced(means_job(), "fz = \"fz\"\n", ""), "fy = \"fy\"\n", "");
  const std::string job = without + "hold = [\"kac_MPa\", \"kae_N_per_mm\"]\n[material]\nktc_MPa = 1\nkrc_MPa = 1\n";
  EXPECT_EQ(
      fit(slot_means({0.02, 0.05, 0.1}), job).messages,
      "log.csv: error: the cuts do not determine ktc_MPa and kte_N_per_mm: none of the measured forces depends on them "
      "(hold = [\"ktc_MPa\", \"kte_N_per_mm\"] in [force_log] keeps the values of [material]) [not-identifiable]");
}

TEST(FitForce, KienzleMeansGiveTheirPairsBack) {
  machine::Material kienzle;
  kienzle.law = machine::ForceLaw::kienzle;
  kienzle.kc1_1_MPa = 1600, kienzle.mc = 0.25, kienzle.kr1_1_MPa = 500, kienzle.mr = 0.4;
  kienzle.ka1_1_MPa = 200, kienzle.ma = 0.2;
  machine::Tool tool;
  tool.type = machine::ToolType::flat;
  tool.diameter_mm = 20, tool.flutes = 3, tool.overhang_mm = 60;
  std::string log = "feed_mm_per_min,fx,fy,fz\n";
  for (const double f : {0.02, 0.04, 0.08, 0.15}) {
    const Vec3 mean = deflection::SteadyCutModel(tool, {f, 2, 20, deflection::Milling::up}).mean_N(kienzle);
    log += fmt::format("{},{:.9f},{:.9f},{:.9f}\n", f * 9000, mean.x(), mean.y(), mean.z());
  }
  const auto [r, messages] = fit(log, means_job("law = \"kienzle\"\n"));
  EXPECT_EQ(messages, "");
  EXPECT_NEAR(r.material.kc1_1_MPa, 1600, 0.5);
  EXPECT_NEAR(r.material.mc, 0.25, 1e-4);
  EXPECT_NEAR(r.material.kr1_1_MPa, 500, 0.5);
  EXPECT_NEAR(r.material.mr, 0.4, 1e-3);
  EXPECT_NEAR(r.material.ma, 0.2, 1e-3);
}

testing::SimulatedCut simulated(double feed_per_tooth) {
  testing::SimulatedCut c;
  c.radius_mm = 10, c.helix_rad = 30 * kPi / 180, c.axial_depth_mm = 3, c.radial_depth_mm = 8, c.flutes = 3;
  c.up = false, c.feed_per_tooth_mm = feed_per_tooth, c.rpm = 2985, c.start_rad = 1.2;
  c.ktc = 2000, c.krc = 700, c.kac = 300, c.kte = 15, c.kre = 12, c.kae = 5;
  c.run_out_mm = 0.012, c.run_out_rad = 0.5;
  return c;
}

/// 0.5 s in air, then cuts of 0.5 s, then air: on the work, in axes of the dynamometer's own, with drift.
std::string logged(const std::vector<testing::SimulatedCut>& cuts, double rate_Hz, double noise_N) {
  std::string out = "Time;Fa;Fb;Fc\ns;N;N;N\n";
  int sample = 0;
  const auto add = [&](const std::vector<testing::ForceSample>& samples) {
    for (const auto& s : samples) {
      const double t = sample++ / rate_Hz;
      // a = -feed, b = up / 2 (a channel set to half its range), c = left; on the work.
      fmt::format_to(std::back_inserter(out), "{:.6f};{:.4f};{:.4f};{:.4f}\n", t, s.x_N + 20 + 6 * t,
                     -s.z_N / 2 - 8 + 3 * t, -s.y_N + 4 - 5 * t);
    }
  };
  testing::SimulatedCut air = cuts.front();
  air.radial_depth_mm = -1;
  add(testing::simulate(air, 0.5, rate_Hz, noise_N, 7));
  std::uint32_t seed = 100;
  for (auto c : cuts) {
    c.start_rad += seed;  // each cut begins anywhere
    add(testing::simulate(c, 0.5, rate_Hz, noise_N, seed++));
  }
  add(testing::simulate(air, 0.5, rate_Hz, noise_N, 8));
  return out;
}

std::string samples_job(const std::vector<testing::SimulatedCut>& cuts, std::string_view more) {
  std::string job =
      std::string(kTool) +
      "[force_log]\nfit = \"waveform\"\nmilling = \"down\"\nforce_on = \"work\"\nspindle_rpm = 3000\n"
      "t_s = \"Time\"\nfx = { column = 2, scale = -1 }\nfy = \"Fc\"\nfz = { column = \"Fb\", scale = 2 }\n";
  std::string rows;
  double t = 0.5;
  for (const auto& c : cuts) {
    rows += fmt::format("[{}, {}, {}, 3, 8],", t + 0.02, t + 0.48, c.feed_per_tooth_mm * c.flutes * c.rpm);
    t += 0.5;
  }
  return job + fmt::format("cuts = [{}]\nidle_s = [[0, 0.48], [{}, {}]]\n", rows, t + 0.02, t + 0.48) +
         std::string(more);
}

TEST(FitForce, WaveformsWithNoiseDriftAndRunOutGiveTheTruthBack) {
  const std::vector<testing::SimulatedCut> cuts{simulated(0.03), simulated(0.06), simulated(0.09)};
  const auto [r, messages] = fit(logged(cuts, 8000, 8), samples_job(cuts, ""));
  EXPECT_EQ(messages, "");
  EXPECT_TRUE(r.converged);
  EXPECT_NEAR(value_of(r, "ktc_MPa"), 2000, 0.005 * 2000);
  EXPECT_NEAR(value_of(r, "krc_MPa"), 700, 0.01 * 700);
  EXPECT_NEAR(value_of(r, "kac_MPa"), 300, 0.015 * 300);
  EXPECT_NEAR(value_of(r, "kte_N_per_mm"), 15, 0.3);
  EXPECT_NEAR(value_of(r, "kre_N_per_mm"), 12, 0.1);
  EXPECT_NEAR(value_of(r, "kae_N_per_mm"), 5, 0.25);
  EXPECT_NEAR(value_of(r, "run_out_um"), 12, 0.1);
  EXPECT_NEAR(value_of(r, "run_out_angle_deg"), 0.5 * 180 / kPi, 0.5);
  // Fitted turns and held-out ones leave the noise of their averages: 8 N over 40 samples or so a step.
  EXPECT_LT(r.residual_rms_N, 4);
  EXPECT_LT(*r.held_out_rms_N, 6);
  for (const auto& p : r.parameters) std::printf("%-18s %10.4f +- %.2g\n", p.name.c_str(), p.value, *p.std_error);
}

TEST(FitForce, AWaveformTellsEdgeTermsFromOneFeed) {
  const std::vector<testing::SimulatedCut> cuts{simulated(0.06)};
  const auto [r, messages] = fit(logged(cuts, 8000, 2), samples_job(cuts, ""));
  EXPECT_EQ(messages, "");
  EXPECT_NEAR(value_of(r, "ktc_MPa"), 2000, 0.03 * 2000);
  EXPECT_NEAR(value_of(r, "kte_N_per_mm"), 15, 1.5);
  EXPECT_NEAR(value_of(r, "run_out_um"), 12, 0.5);
}

TEST(FitForce, MeansOfSamplesTakeDriftOffAndWholeTurnsAlone) {
  std::vector<testing::SimulatedCut> cuts{simulated(0.03), simulated(0.06), simulated(0.09)};
  for (auto& c : cuts) c.run_out_mm = 0;  // teeth that miss the cut would lower the means
  const std::string job =
      replaced(replaced(samples_job(cuts, ""), "fit = \"waveform\"", "fit = \"means\""), "3000", "2985");
  const auto [r, messages] = fit(logged(cuts, 8000, 2), job);
  EXPECT_EQ(messages, "");
  EXPECT_NEAR(value_of(r, "ktc_MPa"), 2000, 0.015 * 2000);
  EXPECT_NEAR(value_of(r, "kte_N_per_mm"), 15, 0.5);
  EXPECT_TRUE(r.run_out.empty());
}

TEST(FitForce, WarnsOfSamplesWithoutIdleTime) {
  const std::vector<testing::SimulatedCut> cuts{simulated(0.03), simulated(0.09)};
  std::string job = samples_job(cuts, "");
  job.erase(job.find("idle_s"));
  EXPECT_EQ(fit(logged(cuts, 4000, 0), job).messages,
            "log.csv: warning: no idle_s in [force_log]: the forces are taken as they are, including any drift; ranges "
            "in which the tool turns in air were expected [force-drift]\n");
}

TEST(FitForce, NamesWhatIsWrongInALog) {
  const std::string rows = "300,1,2,3\n600,1,x,3\n900,1,2\n";
  EXPECT_EQ(fit("feed_mm_per_min,fx,fy,fz\n" + rows, means_job()).messages,
            "log.csv:3:7: error: fy is \"x\"; a number was expected [trace-number]\n"
            "    600,1,x,3\n"
            "          ^\n"
            "log.csv:4:7: error: 3 fields; column 4 was expected for fz [trace-fields]\n"
            "    900,1,2\n"
            "          ^");
  EXPECT_EQ(fit("", means_job()).messages,
            "log.csv: error: the log is empty; a line that names the columns and rows of numbers were expected "
            "[trace-empty]");
  EXPECT_EQ(
      fit("feed,fx,fy,fz\n300,1,2,3\n", means_job()).messages,
      "log.csv:1:1: error: there is no column \"feed_mm_per_min\" for feed_mm_per_min of [force_log]; the columns "
      "are feed, fx, fy, fz [trace-column]\n"
      "    feed,fx,fy,fz\n"
      "    ^");
}

TEST(FitForce, NamesWhatIsWrongInItsTable) {
  EXPECT_EQ(fit("", means_job("fit = \"waveform\"\n")).messages,
            "job.toml:15:7: error: fit = \"waveform\" needs contents = \"samples\"; a table of means has no waveform "
            "[force-log]\n"
            "    fit = \"waveform\"\n"
            "          ^");
  EXPECT_EQ(fit("", means_job("hold = [\"kac\"]\n")).messages,
            "job.toml:15:8: error: hold names \"kac\"; one of ktc_MPa, kte_N_per_mm, krc_MPa, kre_N_per_mm, kac_MPa, "
            "kae_N_per_mm was expected [value-unknown]\n"
            "    hold = [\"kac\"]\n"
            "           ^");
  EXPECT_EQ(fit("", kTool).messages,
            "job.toml: error: [force_log] is missing; a table that says how the log is to be read was expected "
            "[key-missing]");
  EXPECT_EQ(fit("", replaced(means_job(), "fx = \"fx\"", "fx = 2")).messages,
            "job.toml:12:6: error: fx: the name of a column, or { column = \"name\", scale = -1 }, was expected "
            "[value-type]\n"
            "    fx = 2\n"
            "         ^");
}

TEST(FitForce, RefusesLogsThatHoldNothing) {
  EXPECT_EQ(fit("feed_mm_per_min,fx,fy,fz\n300,0,0,0\n600,0,0,0\n", means_job()).messages,
            "log.csv: error: every force is zero; forces of cuts were expected [force-log]");
  const std::string samples = std::string(kTool) + "[force_log]\nfx = \"a\"\nspindle_rpm = 6000\nt_s = \"t\"\n";
  EXPECT_EQ(fit("", samples + "cuts = []\n").messages,
            "job.toml:11:8: error: cuts is empty; at least one row [from s, to s, feed mm/min, axial depth mm, radial "
            "depth mm] was expected [value-count]\n"
            "    cuts = []\n"
            "           ^");
  EXPECT_EQ(fit("t,a\n0,1\n0.1,2\n0.2,1\n", samples + "idle_s = [[0, 0.1]]\ncuts = [[0, 1, 300, 3, 20]]\n").messages,
            "log.csv: error: the cut from 0 to 1 s reaches beyond the log, which has 0 to 0.2 s [force-log]");
}

TEST(FitForce, DoubtsNegativeCoefficients) {
  const auto [r, messages] =
      fit(slot_means({0.02, 0.05, 0.1}), replaced(means_job(), "fy = \"fy\"", "fy = { column = \"fy\", scale = -1 }"));
  EXPECT_EQ(messages, "");
  EXPECT_FALSE(r.plausible);
  EXPECT_EQ(
      r.message,
      "a tangential or radial coefficient is negative, which no cutter has; check the axes and signs of [force_log]");
}

}  // namespace
}  // namespace camber::calib
