// What is said of a job before it is cut, against closed forms of the same.
#include "checks/setup_checks.h"

#include <cmath>
#include <regex>

#include <gtest/gtest.h>

#include "nc/interpreter.h"
#include "tests/support/cutting.h"

namespace camber::checks {
namespace {

/// What check_job says of a line with a slim end mill at this speed.
std::string said_at(double rpm, double youngs_modulus_MPa) {
  machine::Job job;
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 6, 2, 0);
  tool.number = 1;
  tool.overhang_mm = 60;
  tool.effective_diameter_ratio = 1;
  tool.youngs_modulus_MPa = youngs_modulus_MPa;
  job.tools[1] = tool;
  Diagnostics found;
  const nc::Program program =
      nc::read_program(SourceText("p.nc", "G21 G90 G94\nT1 M6\nS" + std::to_string(static_cast<int>(rpm)) +
                                              " M3\nG0 X0 Y0 Z0\nG1 X10 F100\nM30\n"),
                       found);
  const nc::Interpretation moves = nc::interpret(program, {.inch = false}, found);
  check_job(job, program, moves, found);
  return found.all().empty() ? std::string() : to_string(found.all().front());
}

/// A uniform cantilever: f = 1.8751^2 / (2 pi) sqrt(E I / (rho A L^4)), I / A = D^2 / 16.
double cantilever_hz(double youngs_modulus_Pa, double density) {
  const double d = 0.006, length = 0.060;
  return 1.8751 * 1.8751 / (2 * kPi) * std::sqrt(youngs_modulus_Pa * d * d / 16 / density) / (length * length);
}

TEST(ToothFrequency, IsWarnedOfAboveAThirdOfTheFirstNaturalFrequency) {
  struct Bar {
    double youngs_modulus_MPa, density;
  };
  for (const Bar bar : {Bar{600000, 14500}, Bar{210000, 7850}}) {
    const double first_hz = cantilever_hz(1e6 * bar.youngs_modulus_MPa, bar.density);
    const double limit_rpm = 60 * first_hz / 3 / 2;
    EXPECT_EQ(said_at(0.97 * limit_rpm, bar.youngs_modulus_MPa), "");
    const double rpm = std::floor(1.06 * limit_rpm);
    const std::string message = said_at(rpm, bar.youngs_modulus_MPa);
    std::smatch figures;
    ASSERT_TRUE(std::regex_match(
        message, figures,
        std::regex(R"(p\.nc:5:1: warning: T1 passes (\d+) teeth a second, more than a third of its first natural )"
                   R"(frequency of about (\d+) Hz: a static deflection is no longer valid \[tooth-frequency\]\n)"
                   R"(    G1 X10 F100\n    \^)")))
        << message;
    EXPECT_NEAR(std::stod(figures[1]), rpm / 60 * 2, 0.5);
    EXPECT_NEAR(std::stod(figures[2]) / first_hz, 1, 0.02);  // Rayleigh's quotient is 1.5 % above
  }
}

TEST(Slenderness, AddsUpWhatBends) {
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 6, 2, 0);
  tool.overhang_mm = 60;
  EXPECT_DOUBLE_EQ(slenderness(tool), 10);
  tool.flute_length_mm = 12;
  tool.shank_diameter_mm = 12;
  EXPECT_DOUBLE_EQ(slenderness(tool), 12 / 6.0 + 48 / 12.0);
  tool.neck_diameter_mm = 5;
  tool.neck_length_mm = 20;
  EXPECT_DOUBLE_EQ(slenderness(tool), 12 / 6.0 + 20 / 5.0 + 28 / 12.0);
}

}  // namespace
}  // namespace camber::checks
