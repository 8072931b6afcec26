// Programs of real CAM systems and controls.
#include "nc/interpreter.h"
#include "nc/summary.h"
#include "tests/nc/nc_text.h"
#include "tests/support/test_data.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

/// What is said of a program of tests/data; file names without their folder.
Messages said_of(const std::string& data, const InterpreterOptions& options = {}) {
  const std::string name = data.substr(data.rfind('/') + 1);
  return read_text(SourceText::read(tests::data_path(data)).text(), options, name).messages;
}

TEST(CamPrograms, BoxOp5ReadsWithoutAWord) {
  const Read r = read_text(SourceText::read(tests::data_path("nist/box_op5.nc")).text(), {});
  EXPECT_EQ(r.messages, Messages{});
  const Summary s = summarize(r.program, r.moves);
  EXPECT_EQ(s.blocks, 18767u);
  EXPECT_EQ(s.tools.size(), 12u);
  EXPECT_TRUE(s.has_inch);
  EXPECT_FALSE(s.has_mm);
  const auto ball = std::find_if(s.tools.begin(), s.tools.end(), [](const ToolUse& t) { return t.tool == 9; });
  ASSERT_NE(ball, s.tools.end());
  EXPECT_EQ(ball->line, 11085u);
}

TEST(CamPrograms, LinuxCncProgramsReadWithoutAWord) {
  int programs = 0;
  for (const auto& f : tests::data_files("linuxcnc/programs")) {
    if (!f.ends_with(".ngc")) continue;
    EXPECT_EQ(read_text(SourceText::read(f).text()).messages, Messages{}) << f;
    ++programs;
  }
  EXPECT_GT(programs, 0);
}

TEST(CamPrograms, NistAndFusionProgramsReadWithoutAWord) {
  EXPECT_EQ(said_of("nc/nist_plate_5.nc"), Messages{});
  EXPECT_EQ(said_of("nc/nist_cover.nc"), Messages{});
  EXPECT_EQ(said_of("nc/fusion_parallel_ball_inch.nc"), Messages{});
}

TEST(CamPrograms, ProgramsWithoutAUnitNeedOne) {
  EXPECT_EQ(said_of("nc/maestro_contour_R.nc"),
            Messages{"maestro_contour_R.nc:7:1: warning: the program has moves before G20 or G21 says which unit it "
                     "is in; millimetres are assumed [unit-missing]"});
  for (const char* name : {"nc/maestro_contour_R.nc", "nc/maestro_g91.nc", "nc/maestro_helix_full_turns.nc"})
    EXPECT_EQ(said_of(name, {.inch = false}), Messages{}) << name;
}

TEST(CamPrograms, AbsoluteCentresAreNoticed) {
  EXPECT_EQ(
      said_of("nc/bottle_helix_arcs.nc", {.inch = false}),
      Messages{
          "bottle_helix_arcs.nc:12:1: warning: the 2051 arcs of the program fit with absolute centres only; G90.1 is "
          "assumed [arc-centre]"});
}

TEST(CamPrograms, HaasDrillingReadsWithAWarning) {
  EXPECT_EQ(said_of("nc/gpr_haas_sample.ncf", {.inch = true}),
            Messages{"gpr_haas_sample.ncf:9:23: warning: P has no number; it is taken as P0 [no-number]"});
}

TEST(CamPrograms, AProgramForSinumerikIsReadInItsLanguage) {
  EXPECT_EQ(
      said_of("nc/elmoe_keychain_840d.mpf"),
      (Messages{"elmoe_keychain_840d.mpf:8:8: warning: M50 is a function of the machine's maker; what it moves is "
                "not known, and it is passed over (and 4 more like it) [machine-function]",
                "elmoe_keychain_840d.mpf:19:34: warning: rotary axis B is not supported; it is assumed to stay at "
                "0 (and 15 more like it) [rotary-axis]"}));
}

TEST(CamPrograms, WhatIsNotReadSaysSo) {
  EXPECT_EQ(
      said_of("nc/gpr_mazak_sample.eia"),
      (Messages{"gpr_mazak_sample.eia:2:1: error: G53.5 is not a G code that Camber knows [unknown-g]",
                "gpr_mazak_sample.eia:3:1: error: G122.1 (radius or diameter of X on a mill-turn machine) belongs to a "
                "turning program; milling programs are read [turning]"}));
  EXPECT_EQ(
      said_of("nc/gpr_camaster_vectric.tap", {.inch = true}),
      (Messages{"gpr_camaster_vectric.tap:29:6: error: X has no number; a number was expected (and 3 more like it) "
                "[no-number]",
                "gpr_camaster_vectric.tap:30:6: error: Z has no number; a number was expected (and 3 more like it) "
                "[no-number]",
                "gpr_camaster_vectric.tap:20:2: warning: the program selects tools (T) but never changes one; M6 was "
                "expected, all moves count as tool 0 [tool-not-changed]"}));
  for (const auto& m : said_of("nc/nist_d2mi_904_op1.nc", {}))
    // G10 L2 takes its numbers from variables; its G41 has D numbers that only the operator knows.
    EXPECT_TRUE(m.find("[variable]") != std::string::npos || m.find("[not-read]") != std::string::npos ||
                m.find("[work-offset]") != std::string::npos || m.find("[radius-unknown]") != std::string::npos)
        << m;
}

}  // namespace
}  // namespace camber::nc
