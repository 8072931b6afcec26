// Blocks that are computed from where the tool stands or from where it came: an edit before them moves nothing behind.
#include <vector>

#include "nc/emit.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

struct Case {
  const char* about;
  const char* file;
  const char* dialect;
  const char* text;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {"a full circle before CP", "p.h", "heidenhain",
       "BEGIN PGM A MM\nTOOL CALL 1 Z S2000\nM3\nL X+0 Y+0 Z+5 R0 FMAX\nL X+10 Y+3 F500\nL X+20 Y+0\nCC X+0 Y+0\n"
       "C X+20 Y+0 DR+\nCP IPA+40 DR+\nL IX+3 IY-4\nEND PGM A MM\n"},
      {"CP behind a dwell and a plunge", "p.h", "heidenhain",
       "BEGIN PGM A MM\nTOOL CALL 1 Z S2000\nM3\nL X+0 Y+0 Z+5 R0 FMAX\nL X+10 Y+3 F500\nL X+20 Y+1\n"
       "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 0.1\nCC X+0 Y+0\nCP PA+40 DR+\nL IX+3 IY-4\nEND PGM A MM\n"},
      {"LP by its angle alone", "p.h", "heidenhain",
       "BEGIN PGM A MM\nTOOL CALL 1 Z S2000\nM3\nL X+0 Y+0 Z+5 R0 FMAX\nL X+10 Y+3 F500\nL X+20 Y+1\n"
       "CC X+0 Y+0\nLP PA+40\nL IX+3 IY-4\nEND PGM A MM\n"},
      {"CT behind two lines", "p.h", "heidenhain",
       "BEGIN PGM A MM\nTOOL CALL 1 Z S2000\nM3\nL X+0 Y+0 Z+5 R0 FMAX\nL X+10 Y+3 F500\nL X+20 Y+1\n"
       "CT X+30 Y+9\nL IX+3 IY-4\nEND PGM A MM\n"},
      {"a full circle before AP", "p.mpf", "siemens",
       "G17 G90 G71 G94\nT1 D1 M6\nS2000 M3\nG0 X0 Y0 Z5\nG1 X10 Y3 F500\nX20 Y0\nG3 X20 Y0 I-20 J0\n"
       "G111 X0 Y0\nG1 AP=40\nG91 X3 Y-4\nM30\n"},
      {"G110 where the tool stands", "p.mpf", "siemens",
       "G17 G90 G71 G94\nT1 D1 M6\nS2000 M3\nG0 X0 Y0 Z5\nG1 X10 Y3 F500\nX20 Y1\nZ2\nG110 X1 Y1\n"
       "G1 AP=40 RP=12\nG91 X3 Y-4\nM30\n"},
      {"a line by its angle", "p.mpf", "siemens",
       "G17 G90 G71 G94\nT1 D1 M6\nS2000 M3\nG0 X0 Y0 Z5\nG1 X10 Y3 F500\nX20 Y1\nZ2\nX30 ANG=20\nG91 X3 Y-4\nM30\n"},
      {"CT", "p.mpf", "siemens",
       "G17 G90 G71 G94\nT1 D1 M6\nS2000 M3\nG0 X0 Y0 Z5\nG1 X10 Y3 F500\nX20 Y1\nCT X30 Y9\nG1 G91 X3 Y-4\nM30\n"},
      {"AR with a centre", "p.mpf", "siemens",
       "G17 G90 G71 G94\nT1 D1 M6\nS2000 M3\nG0 X0 Y0 Z5\nG1 X10 Y3 F500\nX20 Y1\nG3 I-20 J0 AR=50\nG1 G91 X3 Y-4\n"
       "M30\n"},
      {"RND", "p.mpf", "siemens",
       "G17 G90 G71 G94\nT1 D1 M6\nS2000 M3\nG0 X0 Y0 Z5\nG1 X10 Y3 F500\nX20 Y1 RND=2\nX28 Y9\nG91 X3 Y-4\nM30\n"},
      {"a line by its angle", "p.nc", "fanuc",
       "%\nO1\nG21 G90 G94 G17\nT1 M6\nS2000 M3\nG0 X0 Y0 Z5.\nG1 X10. Y3. F500\nX20. Y1.\nZ2.\nX30. ,A20.\n"
       "G91 X3. Y-4.\nM30\n%\n"},
      {"a corner", "p.nc", "fanuc",
       "%\nO1\nG21 G90 G94 G17\nT1 M6\nS2000 M3\nG0 X0 Y0 Z5.\nG1 X10. Y3. F500\nX20. Y1. ,R2.\nX28. Y9.\n"
       "G91 X3. Y-4.\nM30\n%\n"},
      {"G16 by its angle alone", "p.nc", "fanuc",
       "%\nO1\nG21 G90 G94 G17\nT1 M6\nS2000 M3\nG0 X0 Y0 Z5.\nG1 X10. Y3. F500\nX20. Y1.\nG16\nY40.\nG15\n"
       "G91 X3. Y-4.\nM30\n%\n"},
      {"G16 by its radius alone", "p.nc", "fanuc",
       "%\nO1\nG21 G90 G94 G17\nT1 M6\nS2000 M3\nG0 X0 Y0 Z5.\nG1 X10. Y3. F500\nX20. Y1.\nG16\nX40.\nG15\n"
       "G91 X3. Y-4.\nM30\n%\n"},
  };
  return all;
}

class ReliedEnds : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ReliedEnds, StayWhereTheyWere) {
  const Case& c = cases()[GetParam()];
  SCOPED_TRACE(c.about);
  const InterpreterOptions options = as(c.dialect);
  const Read before = read_text(c.text, options, c.file);
  ASSERT_FALSE(before.diagnostics.has_errors()) << before.messages.front();
  const auto& moves = before.moves.moves;
  std::size_t made = 0;
  for (std::uint32_t m = 0; m < moves.size(); ++m) {
    if (moves[m].kind != MoveKind::linear) continue;
    const MoveEdit edit{.move = m, .end_mm = Vec3(moves[m].end_mm + Vec3(0.031, -0.042, 0))};
    const Emission emission = emit_edits(before.program, before.moves, {&edit, 1}, {.decimals_mm = 4});
    const Read after = read_text(emission.text, options, c.file);
    ASSERT_FALSE(after.diagnostics.has_errors()) << after.messages.front() << "\n" << emission.text;
    ASSERT_EQ(after.moves.moves.size(), moves.size()) << emission.text;
    made += emission.not_made.empty();
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const Move& now = after.moves.moves[i];
      if (i == m) {
        expect_near_mm(now.end_mm, emission.not_made.empty() ? *edit.end_mm : moves[m].end_mm, 1e-4);
      } else {
        expect_near_mm(now.end_mm, moves[i].end_mm, 1e-4);
      }
      if (i > m + 1 && moves[i].kind == MoveKind::arc) {
        const Vec3 middle = point_at(after.moves, now, 0.5);
        expect_near_mm(middle, point_at(before.moves, moves[i], 0.5), 1e-3);
      }
    }
    if (HasFailure()) {
      ADD_FAILURE() << "edit of line " << moves[m].block + 1 << "\n" << emission.text;
      return;
    }
  }
  EXPECT_GE(made, 1u);
}

INSTANTIATE_TEST_SUITE_P(Languages, ReliedEnds, ::testing::Range<std::size_t>(0, cases().size()));

}  // namespace
}  // namespace camber::nc
