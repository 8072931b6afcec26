#include "nc/spindle_speeds.h"

#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

/// Of cuts with a tool at a speed; what is asked of all others is nothing.
struct WantedSpeed {
  int tool = 0;
  double from_rpm = 0, to_rpm = 0;
};

SpeedEmission with_speeds(const Read& r, const std::vector<WantedSpeed>& wanted) {
  EXPECT_EQ(r.messages, std::vector<std::string>{});
  std::vector<double> rpm(r.moves.moves.size(), 0.0);
  for (std::size_t m = 0; m < rpm.size(); ++m) {
    const ModalState& s = r.moves.state_of(r.moves.moves[m]);
    for (const WantedSpeed& w : wanted)
      if (w.tool == s.tool && w.from_rpm == s.spindle_speed_rpm) rpm[m] = w.to_rpm;
  }
  return emit_spindle_speeds(r.program, r.moves, rpm);
}

TEST(SpindleSpeeds, ReplaceTheNumberOfTheSWord) {
  const std::string text = "T1 M6\nN20 S9000. M3 (keep)\nG0 X0 Y0 Z0\nG1 X10. F100\nS4000\nG1 X20.\nM30\n";
  const SpeedEmission e = with_speeds(read_text(text), {{1, 9000, 8270}});
  EXPECT_EQ(e.why_not, "");
  EXPECT_EQ(e.emission.text, "T1 M6\nN20 S8270. M3 (keep)\nG0 X0 Y0 Z0\nG1 X10. F100\nS4000\nG1 X20.\nM30\n");
}

TEST(SpindleSpeeds, GetALineWhereNoSWordStands) {
  const std::string text = "S9000 M3\nT1 M6\nG0 X0 Y0 Z0\nG1 X10. F100\nT2 M6\nG0 X0\nG1 X5.\nX6.\nM30\n";
  const Read r = read_text(text);
  const SpeedEmission second = with_speeds(r, {{2, 9000, 7000}});
  EXPECT_EQ(second.emission.text,
            "S9000 M3\nT1 M6\nG0 X0 Y0 Z0\nG1 X10. F100\nT2 M6\nG0 X0\nS7000\nG1 X5.\nX6.\nM30\n");
  EXPECT_EQ(second.emission.block_of_line, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 6, 7, 8}));
  const SpeedEmission first = with_speeds(r, {{1, 9000, 7000}});
  EXPECT_EQ(first.emission.text, "S7000 M3\nT1 M6\nG0 X0 Y0 Z0\nG1 X10. F100\nT2 M6\nG0 X0\nS9000\nG1 X5.\nX6.\nM30\n");
}

TEST(SpindleSpeeds, StayWhereNoCutAsksForAnother) {
  const std::string text = "T1 M6\nS9000 M3\nG0 X0 Y0 Z0\nG1 X10. F100\nM30\n";
  EXPECT_EQ(with_speeds(read_text(text), {}).emission.text, text);
  // An S word that no cut relies on.
  const std::string idle = "T1 M6\nS9000 M3\nG0 X0 Y0 Z0\nS8000\nG1 X10. F100\nM30\n";
  EXPECT_EQ(with_speeds(read_text(idle), {{1, 8000, 7000}}).emission.text,
            "T1 M6\nS9000 M3\nG0 X0 Y0 Z0\nS7000\nG1 X10. F100\nM30\n");
}

TEST(SpindleSpeeds, AreNotChangedInAnExpression) {
  const SpeedEmission e = with_speeds(
      read_text("#1=9000\nT1 M6\nS#1 M3\nG0 X0 Y0 Z0\nG1 X10. F100\nM30\n", as("fanuc")), {{1, 9000, 7000}});
  EXPECT_EQ(e.why_not, "its S word is no plain number of the program");
  EXPECT_EQ(e.line, 3u);
}

TEST(SpindleSpeeds, OfKlartextStandInToolCall) {
  const Read r = read_text(
      "0 BEGIN PGM P MM\n1 TOOL CALL \"S10\" Z S9000 F500\n2 L X+0 Y+0 Z+0 R0 FMAX M3\n3 L X+10\n4 TOOL CALL S4000\n"
      "5 L X+20 F500\n6 END PGM P MM\n",
      {}, "p.h");
  const int tool = r.moves.states.back().tool;
  const SpeedEmission e = with_speeds(r, {{tool, 9000, 8270}});
  EXPECT_EQ(e.why_not, "");
  EXPECT_EQ(e.emission.text,
            "0 BEGIN PGM P MM\n1 TOOL CALL \"S10\" Z S8270 F500\n2 L X+0 Y+0 Z+0 R0 FMAX M3\n3 L X+10\n4 TOOL CALL "
            "S4000\n5 L X+20 F500\n6 END PGM P MM\n");
}

TEST(SpindleSpeeds, OfSinumerikNameTheirSpindle) {
  const Read r = read_text("T1 M6\nS1=9000 M3\nG0 X0 Y0 Z0\nG1 X10 F100\nS=4000\nG1 X20\nS500\nG1 X30\nM30\n",
                           {.inch = false}, "p.mpf");
  const SpeedEmission e = with_speeds(r, {{1, 9000, 8270}, {1, 4000, 3000}, {1, 500, 510}});
  EXPECT_EQ(e.why_not, "");
  EXPECT_EQ(e.emission.text, "T1 M6\nS1=8270 M3\nG0 X0 Y0 Z0\nG1 X10 F100\nS=3000\nG1 X20\nS510\nG1 X30\nM30\n");
}

}  // namespace
}  // namespace camber::nc
