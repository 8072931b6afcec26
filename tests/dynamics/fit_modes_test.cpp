// Modes of tap tests whose modes are known (tests/data/README.md).
#include "dynamics/modal_fit.h"

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/diagnostics.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

namespace camber::dynamics {
namespace {

constexpr double kFrequency = 0.002, kDamping = 0.05, kStiffness = 0.03;

void expect_known_modes(const std::string& name, const ModeFit& fit) {
  const auto known = nlohmann::json::parse(std::ifstream(tests::data_path("dynamics/taps/taps.json")))[name];
  ASSERT_EQ(fit.modes.size(), known.size()) << name;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const double hz = known[i]["frequency_Hz"], zeta = known[i]["damping_ratio"],
                 k = 1000 * known[i]["stiffness_N_per_um"].get<double>();
    const FittedMode& m = fit.modes[i];
    EXPECT_NEAR(m.frequency_hz.value, hz, kFrequency * hz) << name;
    EXPECT_NEAR(m.damping_ratio.value, zeta, kDamping * zeta) << name;
    EXPECT_NEAR(m.stiffness_N_per_mm.value, k, kStiffness * k) << name;
    // Errors are what they are said to be.
    EXPECT_LT(std::abs(m.frequency_hz.value - hz), 4 * m.frequency_hz.error) << name;
    EXPECT_LT(std::abs(m.damping_ratio.value - zeta), 4 * m.damping_ratio.error) << name;
    EXPECT_LT(std::abs(m.stiffness_N_per_mm.value - k), 4 * m.stiffness_N_per_mm.error) << name;
  }
  EXPECT_NEAR(fit.misfit, 1, 0.1) << name;
}

class TapTest : public ::testing::TestWithParam<std::string> {};

TEST_P(TapTest, GivesTheModesBack) {
  for (const std::string kind : {".csv", "_receptance.uff", "_accelerance.uff"}) {
    const auto response = read_frequency_response(tests::unpacked_data("dynamics/taps/" + GetParam() + kind));
    expect_known_modes(GetParam(), fit_modes(response));
  }
}

INSTANTIATE_TEST_SUITE_P(Fit, TapTest, ::testing::Values("tap_one_mode", "tap_two_modes", "tap_close_modes"));

/// What is between modes of a band and beyond it is not theirs.
TEST(FitModes, OfABandLeavesTheOthersOut) {
  const auto response = read_frequency_response(tests::unpacked_data("dynamics/taps/tap_close_modes.csv"));
  const ModeFit fit = fit_modes(response, {.modes = {}, .from_hz = 2400, .to_hz = 3400});
  ASSERT_EQ(fit.modes.size(), 1u);
  EXPECT_NEAR(fit.modes[0].frequency_hz.value, 2910, 0.002 * 2910);
  EXPECT_NEAR(fit.modes[0].damping_ratio.value, 0.022, 0.05 * 0.022);
  EXPECT_NEAR(fit.modes[0].stiffness_N_per_mm.value, 9000, 0.03 * 9000);
}

TEST(FitModes, OfNoiseFindsNone) {
  FrequencyResponse noise;
  std::uint32_t state = 1;
  const auto random = [&] {
    state = state * 1664525u + 1013904223u;
    return state / 4294967296.0 - 0.5;
  };
  for (int i = 1; i <= 500; ++i) noise.hz.push_back(i), noise.value.emplace_back(random(), random());
  EXPECT_TRUE(fit_modes(noise).modes.empty());
}

class ResponseFile : public ::testing::Test {
 protected:
  std::string file(const std::string& text) const { return folder_.write("tap", text); }
  std::string refusal(const std::string& text) const {
    const std::string path = file(text);
    try {
      read_frequency_response(path);
    } catch (const InputError& e) {
      std::string what = e.what();
      return what.substr(path.size());
    }
    return "";
  }
  tests::TempFolder folder_;
};

std::string rows_of(int n, const std::string& cells) {
  std::string text;
  for (int i = 1; i <= n; ++i) text += std::to_string(i) + cells + "\n";
  return text;
}

TEST_F(ResponseFile, MagnitudeAndPhaseAreReadAsWell) {
  const auto r =
      read_frequency_response(file("# a tap\nfrequency_Hz,magnitude_um_per_N,phase_deg\n" + rows_of(20, ",2,-90")));
  EXPECT_EQ(r.kind, ResponseKind::receptance);
  ASSERT_EQ(r.value.size(), 20u);
  EXPECT_NEAR(r.value[3].real(), 0, 1e-12);
  EXPECT_NEAR(r.value[3].imag(), -0.002, 1e-12);
  const auto g = read_frequency_response(file("frequency_Hz;re_g_per_N;im_g_per_N\n" + rows_of(20, ";1;0")));
  EXPECT_EQ(g.kind, ResponseKind::accelerance);
  EXPECT_NEAR(g.value[0].real(), 9806.65, 1e-9);
}

TEST_F(ResponseFile, ThatIsWrongIsRefused) {
  EXPECT_EQ(refusal("f,x\n1,2\n"),
            ":1:1: error: the header has no frequency response; frequency_Hz with re_m_per_N and im_m_per_N, or with "
            "magnitude_m_per_N and phase_deg, was expected [response-header]\n    f,x\n    ^");
  EXPECT_EQ(refusal("frequency_Hz,re_inch_per_N,im_inch_per_N\n1,2,3\n"),
            ":1:1: error: \"inch_per_N\" is no unit of a response; one of m_per_N, mm_per_N, um_per_N, m_per_s_per_N, "
            "mm_per_s_per_N, m_per_s2_per_N, mm_per_s2_per_N, g_per_N was expected [response-header]\n"
            "    frequency_Hz,re_inch_per_N,im_inch_per_N\n    ^");
  EXPECT_EQ(refusal("frequency_Hz,re_m_per_N,im_m_per_N\n1,2,x\n"),
            ":2:1: error: \"x\" is no number [response-value]\n    1,2,x\n    ^");
  EXPECT_EQ(refusal("frequency_Hz,re_m_per_N,im_m_per_N\n2,2,3\n1,2,3\n"),
            ":3:1: error: 1 Hz is not above the row before it, 2 Hz [response-value]\n    1,2,3\n    ^");
  EXPECT_EQ(refusal("frequency_Hz,re_m_per_N,im_m_per_N\n2,2,3\n"),
            ": error: has 1 frequencies; at least 16 were expected [response-count]");
}

/// A universal file with one response of four values.
std::string universal(const std::string& type, const std::string& numerator, const std::string& numbers) {
  return "    -1\n    58\na\nb\nc\nd\ne\n    " + type +
         "         1    0         0 TIP                1   1 TIP                1   1\n"
         "         5         4         1  1.00000E+02  5.00000E-01  0.00000E+00\n"
         "        18    0    0    0 Frequency            Hz\n        " +
         numerator + "    0    0    0 x                    m\n        13    0    0    0 Force                N\n" +
         "         0    0    0    0 NONE                 NONE\n" + numbers + "\n    -1\n";
}

TEST_F(ResponseFile, UniversalFilesThatAreWrongAreRefused) {
  EXPECT_EQ(refusal(universal("1", " 8", "1 2 3 4 5 6 7 8")),
            ": error: has 0 frequency responses at the point of the tap; one was expected [response-count]");
  EXPECT_EQ(
      refusal(universal("4", " 2", "1 2 3 4 5 6 7 8")),
      ":11:1: error: the response is of type 2; 8 (displacement), 11 (velocity) or 12 (acceleration) was expected "
      "[response-header]\n             2    0    0    0 x                    m\n    ^");
  EXPECT_EQ(refusal(universal("4", " 8", "1 2 3 4 5")),
            ":15:1: error: the data set ends after 5 numbers; 8 were expected [response-value]\n        -1\n    ^");
  EXPECT_EQ(refusal(universal("4", " 8", "1 2 3 4 5 6 seven 8")),
            ":14:1: error: \"seven\" is no number [response-value]\n    1 2 3 4 5 6 seven 8\n    ^");
}

}  // namespace
}  // namespace camber::dynamics
