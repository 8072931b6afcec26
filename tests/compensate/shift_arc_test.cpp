// Arcs under a shift: one arc where one does, else the fewest.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "compensate/shift_path.h"
#include "nc/emit.h"
#include "nc/interpreter.h"

namespace camber::compensate {
namespace {

constexpr double kTolerance_mm = 0.0005;
constexpr double kRounding_mm = 0.0003;  // of ends and centre, four decimals each

struct Arcs {
  nc::Program text;
  nc::Interpretation moves;
  explicit Arcs(const std::string& program) {
    Diagnostics diagnostics;
    text = nc::read_program(SourceText("arc.nc", program), diagnostics);
    moves = nc::interpret(text, {}, diagnostics);
    EXPECT_FALSE(diagnostics.has_errors());
  }
};

const char* const kQuarter = "G21 G17 G90\nG0 X10. Y0.\nG3 X0. Y10. I-10. J0. F300 (CORNER) M9\nM30\n";

/// Shifts that move every point of the quarter outwards by `out`(angle).
void shift_outwards(ShiftPath& path, auto out) {
  for (auto& p : path.points()) {
    const double angle = std::atan2(p.place_mm.y(), p.place_mm.x());
    p.shift_mm = out(angle) * Vec3(std::cos(angle), std::sin(angle), 0);
  }
}

double worst_stray(const nc::Interpretation& moves, auto out) {
  double worst = 0;
  for (const nc::Move& m : moves.moves) {
    if (m.kind != nc::MoveKind::arc) continue;
    for (double u = 0; u <= 1; u += 0.05) {
      const Vec3 p = nc::point_at(moves, m, u);
      worst = std::max(worst, std::abs(p.head<2>().norm() - 10 - out(std::atan2(p.y(), p.x()))));
    }
  }
  return worst;
}

TEST(ShiftedArc, StaysOneArcWhereTheShiftIsEven) {
  const Arcs given(kQuarter);
  ShiftPath path(given.moves, {false, true}, 0.4);
  EXPECT_GT(path.points().size(), 30u);
  shift_outwards(path, [](double) { return 0.01; });
  const auto edits = path.edits(kTolerance_mm);
  ASSERT_EQ(edits.size(), 1u);
  EXPECT_TRUE(edits[0].via.empty());
  EXPECT_NEAR(edits[0].center_mm->norm(), 0, 1e-9);
}

TEST(ShiftedArc, BecomesFewArcsWhereTheShiftVaries) {
  const Arcs given(kQuarter);
  ShiftPath path(given.moves, {false, true}, 0.4);
  const auto out = [](double angle) { return 0.01 * std::sin(4 * angle); };
  shift_outwards(path, out);
  const auto edits = path.edits(kTolerance_mm);
  ASSERT_EQ(edits.size(), 1u);
  EXPECT_GE(edits[0].via.size(), 2u);
  EXPECT_LE(edits[0].via.size(), 12u);
  const nc::Emission emission = nc::emit_edits(given.text, given.moves, edits, {});
  EXPECT_TRUE(emission.not_made.empty());
  const Arcs emitted(emission.text);
  std::size_t arcs = 0;
  for (const auto& m : emitted.moves.moves) arcs += m.kind == nc::MoveKind::arc;
  EXPECT_EQ(arcs, edits[0].via.size() + 1);
  EXPECT_LT(worst_stray(emitted.moves, out), kTolerance_mm + kRounding_mm + 0.0003);  // and between the points
  // The first piece keeps its words and the comment; what acts at the end goes to the last.
  EXPECT_EQ(emission.text.find("(CORNER)") < emission.text.find("M9"), true);
  EXPECT_EQ(emission.text.find("G3"), emission.text.rfind("G3"));
}

TEST(ShiftedArc, KeepsRadiusWordsAndFullTurns) {
  for (const char* text :
       {"G21 G17 G90\nG0 X10. Y0.\nG3 X0. Y10. R10. F300\nM30\n", "G21 G17 G90\nG0 X10. Y0.\nG3 I-10. F300\nM30\n",
        "G21 G17 G91\nG0 X10. Y0.\nG2 X-10. Y-10. I-10. J0. F300\nM30\n"}) {
    const Arcs given(text);
    ShiftPath path(given.moves, {false, true}, 0.4);
    const auto out = [](double angle) { return 0.01 * (1 - std::cos(2 * angle)); };
    shift_outwards(path, out);
    const nc::Emission emission = nc::emit_edits(given.text, given.moves, path.edits(kTolerance_mm), {});
    EXPECT_TRUE(emission.not_made.empty()) << text;
    const Arcs emitted(emission.text);
    EXPECT_GE(emitted.moves.moves.size(), 3u) << emission.text;
    EXPECT_LT(worst_stray(emitted.moves, out), kTolerance_mm + kRounding_mm + 0.0003) << emission.text;
  }
}

TEST(ShiftedArc, AFullTurnStaysOneWhereTheShiftIsEven) {
  const Arcs given("G21 G17 G90\nG0 X12. Y0.\nG1 X10. F300\nG3 I-10.\nM30\n");
  ShiftPath path(given.moves, {false, true, true}, 0.4);
  const auto out = [](double) { return 0.01; };
  shift_outwards(path, out);
  const auto edits = path.edits(kTolerance_mm);
  ASSERT_EQ(edits.size(), 2u);
  EXPECT_TRUE(edits[1].via.empty());
  EXPECT_NEAR(edits[1].center_mm->norm(), 0, 1e-6);
}

/// Where the control stops at every corner arcs are not split; the ends of a full turn are shifted one by one all the
/// same, and the line between them points anywhere.
TEST(ShiftedArc, AFullTurnKeepsItsCentreWhereItsEndsAreShiftedUnevenly) {
  for (const char* text : {"G21 G17 G90\nG0 X12. Y0.\nG1 X10. F300\nG3 I-10.\nM30\n",
                           "G21 G17 G90\nG0 X12. Y0.\nG1 X10. F300\nG3 I-10. Z-1.\nM30\n"}) {
    const Arcs given(text);
    ShiftPath path(given.moves, {false, true, true}, std::numeric_limits<double>::infinity());
    ASSERT_EQ(path.points().size(), 5u);
    const auto out = [](double) { return 0.01; };
    shift_outwards(path, out);
    path.points().back().shift_mm += Vec3(0.0004, 0.0002, 0);
    const auto edits = path.edits(kTolerance_mm);
    ASSERT_EQ(edits.size(), 2u);
    EXPECT_TRUE(edits[1].via.empty());
    const Arcs emitted(nc::emit_edits(given.text, given.moves, edits, {}).text);
    EXPECT_LT(worst_stray(emitted.moves, out), kRounding_mm);
  }
}

/// R says the centre of half a turn only to a square root: one of 7 mm, rounded to 0.1 um, lies 26 um away.
TEST(ShiftedArc, HalfATurnByItsRadiusBecomesTwo) {
  for (const char* text : {"G21 G17 G90\nG0 X12. Y0.\nG1 X10. F300\nG3 X-10. Y0. R10.\nM30\n",
                           "G21 G17 G90\nG0 X12. Y0.\nG1 X10. F300\nG3 X-9.9954 Y-0.3034 R-10.\nM30\n"}) {
    const Arcs given(text);
    ShiftPath path(given.moves, {false, true, true}, std::numeric_limits<double>::infinity());
    ASSERT_EQ(path.points().size(), 4u);
    const auto out = [](double) { return 0.01; };
    shift_outwards(path, out);
    path.points().back().shift_mm.y() -= 0.0004;
    const nc::Emission emission = nc::emit_edits(given.text, given.moves, path.edits(kTolerance_mm), {});
    EXPECT_TRUE(emission.not_made.empty());
    const Arcs emitted(emission.text);
    EXPECT_EQ(emitted.moves.moves.size(), 4u) << emission.text;
    EXPECT_LT(worst_stray(emitted.moves, out), kTolerance_mm) << emission.text;
  }
}

}  // namespace
}  // namespace camber::compensate
