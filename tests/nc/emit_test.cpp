#include "nc/emit.h"

#include <fmt/format.h>

#include <random>

#include "base/units.h"
#include "tests/nc/nc_text.h"
#include "tests/support/test_data.h"

namespace camber::nc {
namespace {

/// Shifts of ends (and centres) by a vector for the moves that `which` picks.
std::vector<MoveEdit> shifted(const Read& r, const Vec3& by, const std::vector<std::uint32_t>& which) {
  std::vector<MoveEdit> edits;
  for (const std::uint32_t m : which) {
    MoveEdit e{.move = m, .end_mm = r.moves.moves[m].end_mm + by};
    if (r.moves.moves[m].arc != Move::kNoArc) e.center_mm = r.moves.arcs[r.moves.moves[m].arc].center_mm + by;
    edits.push_back(e);
  }
  return edits;
}

std::string emitted(const std::string& text, const Vec3& by, const std::vector<std::uint32_t>& which,
                    const EmitOptions& options = {}) {
  const Read r = read_clean(text);
  return emit(r.program, r.moves, shifted(r, by, which), options);
}

TEST(NcEmit, AnUntouchedProgramComesOutByteForByte) {
  const std::string text =
      "%\r\nO1 (A)\r\n\r\nN10 G0X1.Y.5Z0 (c)\r\n ; x\r\nG1 X-0. F100\r\n/M8\r\nG3X-2.I-1.\r\nM30\r\n%";
  const Read r = read_clean(text);
  EXPECT_EQ(emit(r.program, r.moves, {}, {}), text);
  EXPECT_EQ(emit(r.program, r.moves, shifted(r, {1e-5, 0, 0}, {1, 2}), {}), text);  // less than the decimals can say
}

TEST(NcEmit, ChangesOnlyTheWordsThatMustChange) {
  EXPECT_EQ(emitted("G0 X0 Y0 Z0\nN5 G01 X10.500 Y2. F100 S1000 (keep)\nX20.0\nM30\n", {0.25, 0, 0}, {1}),
            "G0 X0 Y0 Z0\nN5 G01 X10.75 Y2. F100 S1000 (keep)\nX20.0\nM30\n");
}

TEST(NcEmit, AddsAbsentWordsBesideTheirNeighbours) {
  EXPECT_EQ(emitted("G0X0Y0Z0\nG1X1.F100\nY2.\nG1F50Z3.\n", {0, 0, 0.125}, {1, 2}),
            "G0X0Y0Z0\nG1X1.Z0.125F100\nY2.\nG1F50Z3.\n");
  EXPECT_EQ(emitted("G0X0Y0Z0\nG1X1.F100\nY2.\nG1F50Z3.\n", {0.5, 0, 0}, {3}),
            "G0X0Y0Z0\nG1X1.F100\nY2.\nG1F50X1.5Z3.\n");
  EXPECT_EQ(emitted("G0 X0.5 Y0.5 Z0.5\nG1 Z1. F100\nG1 Z2.\n", {0.1, 0.2, 0}, {1}),
            "G0 X0.5 Y0.5 Z0.5\nG1 X0.6 Y0.7 Z1. F100\nG1 X0.5 Y0.5 Z2.\n");
}

TEST(NcEmit, KeepsTheStyleOfNumbers) {
  EXPECT_EQ(emitted("G0 X0.000 Y0.500 Z1.250\nG1 X10.000 Y5.000 Z-0.500 F100\n", {0.5, 0.0005, 0.00002}, {1}),
            "G0 X0.000 Y0.500 Z1.250\nG1 X10.500 Y5.0005 Z-0.500 F100\n");
  EXPECT_EQ(emitted("G0X.5Y-.5Z1.\nG1X-.25Y.1Z+1.5F100\n", {0.5, -1.1, 0.25}, {1}),
            "G0X.5Y-.5Z1.\nG1X.25Y-1.Z+1.75F100\n");
  EXPECT_EQ(emitted("G0 X5 Y5 Z1\nG1 X 10 F100\n", {2, 0, 0}, {1}), "G0 X5 Y5 Z1\nG1 X 12 F100\n");
}

TEST(NcEmit, AddsWordsInTheCaseOfTheBlock) {
  EXPECT_EQ(emitted("g0 x0 y0 z0\ng1 x1. f100\ny2.\n", {0, 0, 0.125}, {1}),
            "g0 x0 y0 z0\ng1 x1. z0.125 f100\ny2. z0.\n");
}

TEST(NcEmit, WritesInchesWithFiveDecimals) {
  const Read r = read_clean("G20G0X0Y0Z0\nG1X1.F10.\n");
  EXPECT_EQ(emit(r.program, r.moves, shifted(r, {0.01, 0, 0}, {1}), {}), "G20G0X0Y0Z0\nG1X1.00039F10.\n");
}

TEST(NcEmit, RapidsKeepTheirWordsAndTheNextCutComesBack) {
  EXPECT_EQ(emitted("G0X0Y0Z0\nG1X1.F100\nG0Z5.\nG1Z1.\nX2.\n", {0, 0.1, 0}, {1}),
            "G0X0Y0Z0\nG1X1.Y0.1F100\nG0Z5.\nG1Y0.Z1.\nX2.\n");
}

TEST(NcEmit, IncrementalBlocksEndWhereTheyDid) {
  EXPECT_EQ(emitted("G0X0Y0Z0\nG91G1X1.F100\nX1.\nG0Z5.\nG1X1.\n", {0.25, 0, 0.5}, {1}),
            "G0X0Y0Z0\nG91G1X1.25Z0.5F100\nX0.75Z-0.5\nG0Z5.\nG1X1.\n");
}

TEST(NcEmit, RoundingDoesNotAddUpInIncrementalBlocks) {
  std::string text = "G91 G0 X0 Y0 Z0\n";
  for (int i = 0; i < 1000; ++i) text += "G1 X0.1 F100\n";
  const Read r = read_text(text);
  std::vector<MoveEdit> edits;
  for (std::uint32_t i = 1; i <= 1000; ++i) edits.push_back({.move = i, .end_mm = Vec3(i / 30.0, 0, 0)});
  const Read again = read_text(emit(r.program, r.moves, edits, {.decimals_mm = 3}));
  for (std::uint32_t i = 1; i <= 1000; ++i) EXPECT_NEAR(again.moves.moves[i].end_mm.x(), i / 30.0, 0.00051);
}

TEST(NcEmit, ArcsByCentreStayArcs) {
  EXPECT_EQ(emitted("G0X10.Y0.Z0.\nG3X0.Y10.I-10.J0.F100\nG1X-5.\n", {0.5, 0, 0}, {1}),
            "G0X10.Y0.Z0.\nG3X0.5Y10.I-9.7434J0.2563F100\nG1X-5.\n");
}

TEST(NcEmit, ArcsByRadiusGetANewRadius) {
  const std::string text = "G0 X10. Y0. Z0.\nG3 X0. Y10. R10. F100\n";
  const Read r = read_clean(text);
  const MoveEdit e{.move = 1, .end_mm = Vec3(-0.5, 10.5, 0), .center_mm = Vec3(-0.25, 0.25, 0)};
  const std::string out = emit(r.program, r.moves, std::vector{e}, {});
  EXPECT_EQ(out, "G0 X10. Y0. Z0.\nG3 X-0.5 Y10.5 R10.253 F100\n");
}

/// No arc of a quarter turn fits where its end is asked for at its start.
TEST(NcEmit, AnArcWithoutRoomIsTheOldOneWhereTheToolStands) {
  const Read r = read_clean("G0X0.Y0.Z0.\nG1X20.F100\nG3X10.Y10.I-10.J0.\n");
  const Vec3 stands(20.5, 0.2, 0);
  const std::vector<MoveEdit> edits{{.move = 1, .end_mm = stands}, {.move = 2, .end_mm = stands}};
  EXPECT_EQ(emit(r.program, r.moves, edits, {}), "G0X0.Y0.Z0.\nG1X20.5Y0.2F100\nG3X10.5Y10.2I-10.J0.\n");
}

TEST(NcEmit, FullTurnsStayClosed) {
  EXPECT_EQ(emitted("G0X10.Y0.Z0.\nG1X9.F100\nG3I-9.\nX9.Y0.Z-1.I-9.J0.\n", {0.1, 0, 0}, {1, 2, 3}),
            "G0X10.Y0.Z0.\nG1X9.1F100\nG3I-9.\nX9.1Y0.Z-1.I-9.J0.\n");
}

TEST(NcEmit, AnUneditedArcBehindAnEditStartsWhereTheToolStands) {
  const std::string out = emitted("G0X0.Y0.Z0.\nG1X10.F100\nG3X0.Y10.I-10.J0.\n", {0.1, 0, 0}, {1});
  const Read again = read_clean(out);
  expect_near_mm(again.moves.moves[2].end_mm, {0, 10, 0}, 1e-9);
  EXPECT_NEAR(again.moves.arcs[0].sweep_rad, kPi / 2, 0.02);
}

TEST(NcEmit, ViaPointsBecomeBlocksOfTheirOwn) {
  const Read r = read_clean("G0 X0 Y0 Z0\r\nN7 G1 X3. F100 S500 M3 (cut)\r\nX6.\r\n");
  const MoveEdit e{.move = 1, .via = {{Vec3(1, 0.5, 0)}, {Vec3(2, 0.5, 0)}}, .end_mm = Vec3(3, 0, 0)};
  EXPECT_EQ(emit(r.program, r.moves, std::vector{e}, {}),
            "G0 X0 Y0 Z0\r\nN7 G1 X1. Y0.5 F100 S500 M3 (cut)\r\nX2.\r\nX3. Y0.\r\nX6.\r\n");
}

/// The program's second move through one via point.
std::string with_via(const std::string& text, const Vec3& via, const Vec3& end) {
  const Read r = read_clean(text);
  const MoveEdit e{.move = 1, .via = {{via}}, .end_mm = end};
  return emit(r.program, r.moves, std::vector{e}, {});
}

TEST(NcEmit, WordsThatActAtTheEndGoBehindTheViaPoints) {
  EXPECT_EQ(with_via("G0 X0 Y0 Z0\nG1 X3. F100 M5 (off)\nM30\n", {1, 0.5, 0}, {3, 0.5, 0}),
            "G0 X0 Y0 Z0\nG1 X1. Y0.5 F100 (off)\nX3. M5\nM30\n");
  EXPECT_EQ(with_via("G0X0Y0Z0\nM9G9G1X3.F100M1\n", {1, 0.5, 0}, {3, 0, 0}), "G0X0Y0Z0\nG1X1.Y0.5F100\nG9X3.Y0.M9M1\n");
}

TEST(NcEmit, ViaPointsAreKeptWhereTheBlockAlsoChangesModes) {
  EXPECT_EQ(with_via("G0 X0 Y0 Z0\nN5 G91 G17 G1 X3. F100 S500 M3 M9\nM30\n", {1, 0.5, 0}, {3, 0, 0}),
            "G0 X0 Y0 Z0\nN5 G91 G17 G1 X1. Y0.5 F100 S500 M3\nX2. Y-0.5 M9\nM30\n");
  EXPECT_EQ(with_via("G0 X0 Y0 Z0\nG61.1 G1 X3. F100 M30\n", {1, 0.5, 0}, {3, 0, 0}),
            "G0 X0 Y0 Z0\nG61.1 G1 X1. Y0.5 F100\nX3. Y0. M30\n");
}

TEST(NcEmit, ViaPointsAtTheStartOrTheEndAreLeftOut) {
  EXPECT_EQ(with_via("G0 X0 Y0 Z0\nG1 X3. F100 M5\n", {3, 0.00005, 0}, {3, 0, 0}), "G0 X0 Y0 Z0\nG1 X3. F100 M5\n");
  EXPECT_EQ(with_via("G0 X0 Y0 Z0\nG1 X3. F100 M5\n", {0.00002, 0, 0}, {3, 0, 0}), "G0 X0 Y0 Z0\nG1 X3. F100 M5\n");
}

TEST(NcEmit, ViaPointsInIncrementalAndSkippedBlocks) {
  const Read r = read_clean("G0X0Y0Z0\n/G91G1X3.F100\n");
  const MoveEdit e{.move = 1, .via = {{Vec3(1, 0.5, 0)}}, .end_mm = Vec3(3, 0, 0)};
  EXPECT_EQ(emit(r.program, r.moves, std::vector{e}, {}), "G0X0Y0Z0\n/G91G1X1.Y0.5F100\n/X2.Y-0.5\n");
}

TEST(NcEmit, InverseTimeFeedsKeepTheSpeed) {
  const Read r = read_clean("G0 X0. Y0. Z0.\nG93 G1 X10. F6.\n");
  const MoveEdit e{.move = 1, .via = {{Vec3(2.5, 0, 0)}}, .end_mm = Vec3(10, 0, 0)};
  const Read again = read_clean(emit(r.program, r.moves, std::vector{e}, {}) + "\n");
  ASSERT_EQ(again.moves.moves.size(), 3u);
  for (std::size_t i : {1, 2}) EXPECT_NEAR(again.moves.moves[i].feed_mm_per_s, r.moves.moves[1].feed_mm_per_s, 1e-9);
}

TEST(NcEmit, DrillsAtTheOldPlace) {
  EXPECT_EQ(emitted("G0X0Y0Z5.\nG1X1.F100\nG99G81Z-3.R1.\nG80\n", {0, 0.1, 0}, {1}),
            "G0X0Y0Z5.\nG1X1.Y0.1F100\nG99G81Y0.Z-3.R1.\nG80\n");
}

TEST(NcEmit, PassesOverEditsOfCyclesAndReferenceMoves) {
  const std::string text = "G0X0Y0Z5.\nG99G81X1.Z-3.R1.F100\nG80\nG91G28Z0\nG4P1.\n";
  EXPECT_EQ(emitted(text, {0.1, 0.1, 0.1}, {1, 2, 3, 4, 5, 6}), text);
}

TEST(NcEmit, SaysWhichEditsAreNotInTheText) {
  const Read r =
      read_clean("G0X0Y0Z5.\nG99G81X1.Z-3.R1.F100\nG80\nG4P1.\nG1X5.\nG53G0Z0\nG91G28X1.\nG90G0X0.Y0.Z0.\nG3X2.R1.\n");
  const auto& moves = r.moves.moves;
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < moves.size(); ++i)
    if (moves[i].kind != MoveKind::rapid || moves[i].canned || moves[i].reference) all.push_back(i);
  auto edits = shifted(r, {0.1, 0, 0}, all);
  edits.back().end_mm = edits[edits.size() - 2].end_mm;  // an arc by R that ends where it starts
  const Emission out = emit_edits(r.program, r.moves, edits, {});
  std::vector<std::string> said;
  for (const auto& n : out.not_made) {
    const std::string one = fmt::format("line {}: {}", moves[n.move].block + 1, to_string(n.why));
    if (said.empty() || said.back() != one) said.push_back(one);
  }
  EXPECT_EQ(said, (std::vector<std::string>{"line 2: a drilling cycle", "line 4: a dwell",
                                            "line 6: a move of G28, G30 or G53", "line 7: a move of G28, G30 or G53",
                                            "line 9: an arc that does not reach the new ends"}));
}

TEST(NcEmit, PutsAHeaderCommentBehindTheProgramNumber) {
  EmitOptions o;
  o.header_comment = "COMPENSATED";
  EXPECT_EQ(emitted("%\r\nO1(A)\r\nG0X1\r\nM30\r\n%\r\n", {0, 0, 0}, {}, o),
            "%\r\nO1(A)\r\n(COMPENSATED)\r\nG0X1\r\nM30\r\n%\r\n");
  EXPECT_EQ(emitted("G0X1\n", {0, 0, 0}, {}, o), "(COMPENSATED)\nG0X1\n");
}

// --- round trips
// ------------------------------------------------------------------------------------------------------

/// The text says what was wished for: ends within half a unit of the last decimal, centres and radii too.
struct RoundTrip {
  double resolution_mm;
  void check(const Read& before, const std::vector<MoveEdit>& edits, const std::string& text) const {
    InterpreterOptions options = units();
    options.absolute_arc_centre = !before.moves.states.empty() && before.moves.states[0].absolute_arc_centre;
    const Read after = read_text(text, options);
    for (const auto& m : after.messages) EXPECT_EQ(m.find("error"), std::string::npos) << m;
    ASSERT_EQ(after.moves.arcs.size(), before.moves.arcs.size());
    std::size_t at = 0, next = 0, far = 0;
    for (std::size_t i = 0; i < before.moves.moves.size(); ++i) {
      const Move& m = before.moves.moves[i];
      const MoveEdit* edit = next < edits.size() && edits[next].move == i ? &edits[next++] : nullptr;
      const Vec3 end = edit ? *edit->end_mm : m.end_mm;
      if (edit) at += edit->via.size();
      ASSERT_LT(at, after.moves.moves.size());
      const Move& now = after.moves.moves[at++];
      ASSERT_EQ(now.kind, m.kind) << "move " << i;
      EXPECT_NEAR(now.feed_mm_per_s, m.feed_mm_per_s, 1e-9 + 1e-6 * m.feed_mm_per_s);
      const bool full_turn = m.arc != Move::kNoArc && std::abs(before.moves.arcs[m.arc].sweep_rad) > 2 * kPi - 1e-6;
      const bool cutting = m.kind != MoveKind::rapid && m.kind != MoveKind::dwell && !full_turn;
      if (cutting && (now.end_mm - end).cwiseAbs().maxCoeff() > 0.5001 * resolution_mm && far++ < 5)
        ADD_FAILURE() << "move " << i << " of block " << m.block + 1 << " ends at " << now.end_mm.transpose()
                      << " and not at " << end.transpose();
      if (m.arc != Move::kNoArc) check_arc(before, m, after, now);
    }
    EXPECT_EQ(at, after.moves.moves.size());
  }
  void check_arc(const Read& before, const Move& m, const Read& after, const Move& now) const {
    const Arc &old = before.moves.arcs[m.arc], &arc = after.moves.arcs[now.arc];
    EXPECT_EQ(arc.normal, old.normal);
    EXPECT_LT(std::abs(arc.sweep_rad - old.sweep_rad), kPi) << "block " << m.block + 1;
    const auto radius = [&](const Vec3& p) {
      const Vec3 r = p - arc.center_mm;
      return (r - r.dot(arc.normal) * arc.normal).norm();
    };
    EXPECT_NEAR(radius(now.start_mm), radius(now.end_mm), std::max(resolution_mm, 0.0051));
  }
};

/// Random edits, as compensation makes them: runs of moves shifted by a smooth vector; lines sometimes split.
std::vector<MoveEdit> random_edits(const Read& r, std::mt19937& random, double size_mm, bool split) {
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<MoveEdit> edits;
  Vec3 shift = Vec3::Zero();
  bool open = false;
  for (std::uint32_t i = 0; i < r.moves.moves.size(); ++i) {
    const Move& m = r.moves.moves[i];
    const bool own = (m.kind == MoveKind::linear || m.kind == MoveKind::arc) && !m.canned && !m.reference;
    if (random() % 50 == 0) open = !open;
    if (!own || !open) continue;
    shift = 0.9 * shift + 0.1 * size_mm * Vec3(u(random), u(random), u(random));
    MoveEdit e{.move = i, .end_mm = m.end_mm + shift};
    if (m.arc != Move::kNoArc) {
      const Vec3 turn = m.end_mm - m.start_mm;
      const Vec3 normal = r.moves.arcs[m.arc].normal;
      if ((turn - turn.dot(normal) * normal).norm() < 1e-6) continue;  // full turns follow their start
      e.center_mm = r.moves.arcs[m.arc].center_mm + shift;
    } else if (split && random() % 5 == 0 && length_mm(r.moves, m) > 0.5) {
      e.via = {{point_at(r.moves, m, 0.3) + shift}, {point_at(r.moves, m, 0.7) + shift}};
    }
    edits.push_back(e);
  }
  return edits;
}

std::string random_program(std::mt19937& random, bool inch, bool incremental, bool by_radius) {
  std::uniform_real_distribution<double> u(-1, 1);
  std::string out = fmt::format("G17G40G{}\nG0X0.Y0.Z0.\nF100.\n{}", inch ? 20 : 21, incremental ? "G91\n" : "");
  Vec3 at = Vec3::Zero();
  for (int i = 0; i < 300; ++i) {
    Vec3 end = at + 5 * Vec3(u(random), u(random), u(random));
    for (int axis = 0; axis < 3; ++axis) end[axis] = std::round(end[axis] * 1000) / 1000;
    const Vec3 word = incremental ? Vec3(end - at) : end;
    if (i % 3 != 2) {
      out += fmt::format("G1X{:.3f}Y{:.3f}Z{:.3f}\n", word.x(), word.y(), word.z());
    } else {
      const double chord = std::hypot(end.x() - at.x(), end.y() - at.y());
      const double side = 0.4 + u(random) * 0.3;
      const Vec3 middle = 0.5 * (at + end), across(at.y() - end.y(), end.x() - at.x(), 0);
      const Vec3 centre = middle + side * across;
      const double radius = std::hypot(0.5 * chord, side * chord);
      out += fmt::format("G3X{:.3f}Y{:.3f}Z{:.3f}", word.x(), word.y(), word.z());
      out += by_radius ? fmt::format("R{:.5f}\n", radius)
                       : fmt::format("I{:.5f}J{:.5f}\n", centre.x() - at.x(), centre.y() - at.y());
    }
    at = end;
  }
  return out;
}

TEST(NcEmit, RandomEditsOfRandomProgramsRoundTrip) {
  std::mt19937 random(11);
  for (int i = 0; i < 40; ++i) {
    const bool inch = i & 1, incremental = i & 2, by_radius = i & 4;
    SCOPED_TRACE(fmt::format("program {} inch {} incremental {} by radius {}", i, inch, incremental, by_radius));
    const Read r = read_clean(random_program(random, inch, incremental, by_radius));
    const auto edits = random_edits(r, random, 0.2, true);
    const std::string text = emit(r.program, r.moves, edits, {});
    RoundTrip{inch ? 1e-5 * kMmPerInch : 1e-4}.check(r, edits, text);
    EXPECT_EQ(emit(r.program, r.moves, {}, {}), r.program.source.text());
  }
}

TEST(NcEmit, EveryReadableCamProgramRoundTrips) {
  auto files = tests::data_files("nc");
  for (const auto& f : tests::data_files("linuxcnc/programs")) files.push_back(f);
  files.push_back(tests::data_path("nist/box_op5.nc"));
  std::mt19937 random(5);
  int readable = 0;
  for (const auto& file : files) {
    SCOPED_TRACE(file);
    Read r;
    try {
      r.program = read_program(SourceText::read(file), r.diagnostics);
      r.moves = interpret(r.program, {.inch = false}, r.diagnostics);
    } catch (const InputError&) {
      continue;
    }
    if (r.diagnostics.has_errors() || r.program.words.empty()) continue;
    ++readable;
    EXPECT_EQ(emit(r.program, r.moves, {}, {}), r.program.source.text());
    const auto edits = random_edits(r, random, 0.05, true);
    RoundTrip{r.moves.states[0].inch ? 1e-5 * kMmPerInch : 1e-4}.check(r, edits, emit(r.program, r.moves, edits, {}));
  }
  EXPECT_GE(readable, 15);
}

}  // namespace
}  // namespace camber::nc
