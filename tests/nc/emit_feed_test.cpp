// Edits of feeds and splits: which F words are written, and where.
#include <map>
#include <random>
#include <set>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/emit.h"
#include "tests/nc/macro_text.h"
#include "tests/support/test_data.h"

namespace camber::nc {
namespace {

constexpr double kOtherUnit = 1.001e-6;     ///< of a modal feed that is brought back in the other unit
constexpr double kFeedRounding = 1.001e-3;  ///< of what was asked for: EmitOptions' 0.1 %, and the last bit

double mm_per_min(double feed) { return mm_per_s_from_mm_per_min(feed); }

/// New feeds, mm/min, for some moves.
std::vector<MoveEdit> feeds(std::initializer_list<std::pair<std::uint32_t, double>> of) {
  std::vector<MoveEdit> edits;
  for (const auto& [move, feed] : of) edits.push_back({.move = move, .feed_mm_per_s = mm_per_min(feed)});
  return edits;
}

std::string with_feeds(const std::string& text, std::initializer_list<std::pair<std::uint32_t, double>> of,
                       const InterpreterOptions& options = as("fanuc")) {
  const Read r = read_clean(text, options);
  const Emission out = emit_edits(r.program, r.moves, feeds(of), {});
  EXPECT_TRUE(out.not_made.empty());
  return out.text;
}

/// The only reason why the edits are not in the text as they were asked for.
std::string gap_of(const std::string& text, const std::vector<MoveEdit>& edits, std::string wanted = {}) {
  const Read r = read_text(text, as("fanuc"));
  const Emission out = emit_edits(r.program, r.moves, edits, {});
  EXPECT_EQ(out.text, wanted.empty() ? text : wanted);
  EXPECT_EQ(out.not_made.size(), 1u);
  return out.not_made.empty() ? "" : to_string(out.not_made.front().why);
}

TEST(EmitFeed, TheFOfTheBlockChangesAndTheNextMoveThatReliedOnItGetsItBack) {
  EXPECT_EQ(with_feeds("G0 X0 Y0 Z0\nG1 X1. F500 (a)\nX2.\nX3.\n", {{1, 300}}),
            "G0 X0 Y0 Z0\nG1 X1. F300 (a)\nX2. F500\nX3.\n");
  EXPECT_EQ(with_feeds("G0 X0 Y0 Z0\nG1 X1. F500\nX2. M9 (b)\nX3.\n", {{2, 300}}),
            "G0 X0 Y0 Z0\nG1 X1. F500\nX2. F300 M9 (b)\nX3. F500\n");
}

TEST(EmitFeed, OneFWordServesAllMovesOfOneFeed) {
  EXPECT_EQ(with_feeds("G0X0Y0Z0\nG1X1.F500\nX2.\nG3X4.I1.\nG0Z5.\nG1Z0.\nX9.F600\n", {{2, 300}, {3, 300}}),
            "G0X0Y0Z0\nG1X1.F500\nX2.F300\nG3X4.I1.\nG0Z5.\nG1Z0.F500\nX9.F600\n");
  EXPECT_EQ(with_feeds("G0X0Y0Z0\nG1X1.F500\nX2.\nX3.F600\nX4.\n", {{1, 300}, {2, 300}}),
            "G0X0Y0Z0\nG1X1.F300\nX2.\nX3.F600\nX4.\n");
}

TEST(EmitFeed, AnFOnALineOfItsOwnStays) {
  EXPECT_EQ(with_feeds("G0X0Y0Z0\nF500\nG1X1.\nX2.\nF400\nX3.\n", {{1, 300}, {2, 300}}),
            "G0X0Y0Z0\nF500\nG1X1.F300\nX2.\nF400\nX3.\n");
  EXPECT_EQ(with_feeds("G0X0Y0Z0\nG1F500X1.\nG0Z5.F200\nG1X2.\nG4P1.F100\nX3.\nX4.\n", {{1, 300}, {3, 250}, {5, 350}}),
            "G0X0Y0Z0\nG1F300X1.\nG0Z5.F200\nG1X2.F250\nG4P1.F100\nX3.F350\nX4.F100\n");
}

TEST(EmitFeed, FeedsLookAsTheProgramWritesThem) {
  EXPECT_EQ(with_feeds("G0X0Y0Z0\nG1X1.F500.\nX2.\n", {{1, 300}}), "G0X0Y0Z0\nG1X1.F300.\nX2.F500.\n");
  EXPECT_EQ(with_feeds("G0X0Y0Z0\nG1X1.F500.0\nX2.F487.5\nX3.\n", {{1, 300}, {2, 312.3}}),
            "G0X0Y0Z0\nG1X1.F300.0\nX2.F312.3\nX3.F487.5\n");
  EXPECT_EQ(with_feeds("g0 x0 y0 z0\ng1 x1. f500\nx2.\n", {{2, 612.4}}), "g0 x0 y0 z0\ng1 x1. f500\nx2. f612\n");
  // Whole numbers would be wrong by half a percent.
  EXPECT_EQ(with_feeds("G0 X0 Y0 Z0\nG1 X1. F500\nX2.\n", {{2, 87.43}}), "G0 X0 Y0 Z0\nG1 X1. F500\nX2. F87.4\n");
}

TEST(EmitFeed, InInchesAndAcrossAChangeOfUnit) {
  EXPECT_EQ(with_feeds("G20G0X0Y0Z0\nG1X1.F20.\nX2.\n", {{1, 254}}), "G20G0X0Y0Z0\nG1X1.F10.\nX2.F20.\n");
  EXPECT_EQ(with_feeds("G20G0X0Y0Z0\nG1X1.F20.\nG21X30.\n", {{1, 254}}), "G20G0X0Y0Z0\nG1X1.F10.\nG21X30.F508.\n");
  EXPECT_EQ(with_feeds("G20G0X0Y0Z0\nG1X1.F20.\nX2.\n", {{1, 333}}), "G20G0X0Y0Z0\nG1X1.F13.11\nX2.F20.\n");
}

TEST(EmitFeed, PerRevolutionForTheSpindleSpeedAtTheMove) {
  EXPECT_EQ(with_feeds("G0X0Y0Z0S1000M3\nG95G1X1.F0.2\nX2.\nS2000\nX3.\n", {{1, 150}, {3, 300}}),
            "G0X0Y0Z0S1000M3\nG95G1X1.F0.15\nX2.F0.2\nS2000\nX3.F0.15\n");
  EXPECT_EQ(with_feeds("G0X0Y0Z0S1000M3\nG95G1X1.F.2\nX2.\nG94X3.F50\n", {{2, 150}}),
            "G0X0Y0Z0S1000M3\nG95G1X1.F.2\nX2.F.15\nG94X3.F50\n");
}

TEST(EmitFeed, InverseTimeForTheNewLength) {
  EXPECT_EQ(with_feeds("G0X0Y0Z0\nG93G1X10.F6.\nX20.F6.\n", {{1, 30}}), "G0X0Y0Z0\nG93G1X10.F3.\nX20.F6.\n");
  const Read r = read_clean("G0 X0. Y0. Z0.\nG93 G1 X10. F6.\nG3 X30. I10. F6.\nX40. I5. F6.\n");
  const std::vector<MoveEdit> edits{
      {.move = 1, .via = {{.point_mm = Vec3(4, 0, 0), .feed_mm_per_s = 0.25}}, .feed_mm_per_s = 0.5},
      {.move = 2, .feed_mm_per_s = 2.0},
      {.move = 3, .end_mm = Vec3(41, 0, 0), .center_mm = Vec3(35.5, 0, 0), .feed_mm_per_s = 3.0}};
  const Read again = read_clean(emit(r.program, r.moves, edits, {}));
  ASSERT_EQ(again.moves.moves.size(), 5u);
  const std::vector<double> wanted{0, 0.25, 0.5, 2, 3};
  for (std::size_t i = 1; i < 5; ++i)
    EXPECT_NEAR(again.moves.moves[i].feed_mm_per_s, wanted[i], kFeedRounding * wanted[i]) << i;
}

TEST(EmitFeed, ASplitMovesNoPoint) {
  const Read r = read_clean("G0 X0 Y0 Z0\nG1 X10.12345 F500 M9 (a)\nX20.\n");
  const std::vector<MoveEdit> one{{.move = 1, .via = {{.point_mm = Vec3(4, 0, 0), .feed_mm_per_s = mm_per_min(300)}}}};
  EXPECT_EQ(emit(r.program, r.moves, one, {}), "G0 X0 Y0 Z0\nG1 X4. F300 (a)\nX10.12345 F500 M9\nX20.\n");
  const std::vector<MoveEdit> behind{{.move = 1,
                                      .via = {{.point_mm = Vec3(4, 0, 0), .feed_mm_per_s = mm_per_min(500)}},
                                      .feed_mm_per_s = mm_per_min(300)}};
  EXPECT_EQ(emit(r.program, r.moves, behind, {}), "G0 X0 Y0 Z0\nG1 X4. F500 (a)\nX10.12345 F300 M9\nX20. F500\n");
}

TEST(EmitFeed, AnArcIsSplitAsItIs) {
  const Read r = read_clean("G0 X10. Y0 Z0\nG3 X-10. Y0 I-10. J0 F500\nX10. R10.\nI-10.\n");
  const Vec3 top(0, 10, 0);
  const std::vector<MoveEdit> edits{
      {.move = 1, .via = {{.point_mm = top, .feed_mm_per_s = mm_per_min(300)}}},
      {.move = 2, .via = {{.point_mm = Vec3(-top)}}},
      {.move = 3, .via = {{.point_mm = top}, {.point_mm = Vec3(-top)}}, .feed_mm_per_s = mm_per_min(250)}};
  EXPECT_EQ(emit(r.program, r.moves, edits, {}),
            "G0 X10. Y0 Z0\nG3 X0. Y10. I-10. J0 F300\nX-10. Y0. I0. J-10. F500\nX0. Y-10. R10.\nX10. Y0. R10.\n"
            "X0. Y10. I-10. F250\nY-10. I0. J-10.\nX10. Y0. I0. J10.\n");
}

TEST(EmitFeed, AFeedAloneLeavesTheArcAlone) {
  EXPECT_EQ(with_feeds("G0 X10. Y0 Z0\nG3 X-10. Y0.0004 I-10. J0.0002 F500\nG2 X10. Y0 R10.\n", {{1, 300}}),
            "G0 X10. Y0 Z0\nG3 X-10. Y0.0004 I-10. J0.0002 F300\nG2 X10. Y0 R10. F500\n");
}

TEST(EmitFeed, CyclesAndTheMachinesFrameGetTheFThatTheyReliedOn) {
  EXPECT_EQ(with_feeds("G0X0Y0Z5.\nG1X1.F500\nG99G81X2.Z-3.R1.\nG80\n", {{1, 300}}),
            "G0X0Y0Z5.\nG1X1.F300\nG99G81X2.Z-3.R1.F500\nG80\n");
  EXPECT_EQ(with_feeds("G0X0Y0Z5.\nG1X1.F500\nG53X5.\n", {{1, 300}}), "G0X0Y0Z5.\nG1X1.F300\nG53X5.F500\n");
}

TEST(EmitFeed, ModalAcrossSubprogramsAndLoops) {
  // Run once: its blocks are edited where they stand. Run twice, or in a loop: the F stands before the call.
  EXPECT_EQ(with_feeds("G0 X0 Y0 Z0\nG1 X1 F500\nM98 P7\nX5\nM30\nO7\nX2\nX3\nM99\n", {{1, 300}, {3, 200}}),
            "G0 X0 Y0 Z0\nG1 X1 F300\nM98 P7\nX5 F500\nM30\nO7\nX2 F500\nX3 F200\nM99\n");
  EXPECT_EQ(with_feeds("G0 X0 Y0 Z0\nG1 X1 F500\nG0 Z5\nM98 P7 L2\nG1 X5\nM30\nO7\nG1 Y1\nY0\nM99\n", {{1, 300}}),
            "G0 X0 Y0 Z0\nG1 X1 F300\nF500\nG0 Z5\nM98 P7 L2\nG1 X5\nM30\nO7\nG1 Y1\nY0\nM99\n");
  EXPECT_EQ(with_feeds("G20 G0 X0 Y0 Z0\n#1=3\nG1 X1 F10.5\nWHILE[#1GT1]DO1\nX#1\n#1=#1-1\nEND1\nX5\n", {{1, 127}}),
            "G20 G0 X0 Y0 Z0\n#1=3\nG1 X1 F5\nF10.5\nWHILE[#1GT1]DO1\nX#1\n#1=#1-1\nEND1\nX5\n");
}

TEST(EmitFeed, BlocksThatMayBeSkippedKeepTheFeedToThemselves) {
  EXPECT_EQ(with_feeds("G0X0Y0Z0\nG1X1.F500\n/X2.\nX3.\n", {{2, 300}}), "G0X0Y0Z0\nG1X1.F500\n/X2.F300\n/F500\nX3.\n");
  EXPECT_EQ(with_feeds("G0X0Y0Z0\nG1X1.F500\n/X2.F400\nX3.\n", {{1, 300}}),
            "G0X0Y0Z0\nG1X1.F300\nF500\n/X2.F400\nX3.\n");
}

TEST(EmitFeed, SaysWhatItDoesNotMake) {
  const auto one = [](std::uint32_t move) { return feeds({{move, 300}}); };
  EXPECT_EQ(gap_of("G0 X0 Y0 Z0\nG1 X1 F500\n", one(0)), "a rapid, which has no feed");
  const std::string expression = "a move whose feed is set by an expression, or a program that reads its own feed";
  EXPECT_EQ(gap_of("#1=500\nG0 X0 Y0 Z0\nG1 X1 F#1\nX2\n", one(1)), expression);
  EXPECT_EQ(gap_of("#1=500\nG0 X0 Y0 Z0\nG1 X1 F[#1*2]\nX2\n", one(2)), expression);
  EXPECT_EQ(gap_of("G0 X0 Y0 Z0\nG1 X1 F500\n#1=#4109\nX2 F300\n", one(1)), expression);
  EXPECT_EQ(gap_of("G0 X0 Y0 Z0\nG1 X1 F500 M98 P7\nM30\nO7\nX2\nM99\n", one(1)),
            "a block that also calls or ends a subprogram");
  EXPECT_EQ(gap_of("G0 X0 Y0 Z0\nG93 G3 X1 R5 F5\n",
                   {{.move = 1, .via = {{.point_mm = Vec3(0.5, -0.025, 0), .feed_mm_per_s = 1.0}}}}),
            "an arc of several turns, in inverse time (G93), or whose pieces do not close");
  // Only the feed is left out.
  EXPECT_EQ(
      gap_of("#1=500\nG0 X0 Y0 Z0\nG1 X1 F#1\nX2\n", {{.move = 2, .end_mm = Vec3(2.5, 0, 0), .feed_mm_per_s = 5.0}},
             "#1=500\nG0 X0 Y0 Z0\nG1 X1 F#1\nX2.5\n"),
      expression);
}

// --- what holds of every program
// --------------------------------------------------------------------------------------

/// Programs with modal feeds of every kind: F in blocks, on lines of their own, with rapids; G93 G94 G95, inches; loops
/// and subprograms that rely on the modal F; blocks that may be skipped; arcs and drilling cycles.
class FeedProgram {
 public:
  explicit FeedProgram(unsigned seed) : random_(seed) {}

  std::string run() {
    out_ = "G21 G17 G90 G94\nG0 X0. Y0. Z5.\nS1000 M3 F400\n";
    for (int i = 0; i < 40; ++i) add(static_cast<int>(random_() % 16));
    out_ += "G94 F100\nM30\nO7\nG1 X1.\nX2. F210\nM99\nO8\nG1 Y1.\nY2.\nM99\n";
    return out_;
  }

 private:
  double number(double size) { return std::round((static_cast<double>(random_() % 2001) - 1000) * size) / 1000; }
  std::string feed() {
    const int f = 1 + static_cast<int>(random_() % 900);
    if (mode_ == 93) return fmt::format(" F{}", f / 50.0);
    if (mode_ == 95) return fmt::format(" F{}", f / 1000.0);
    return inch_ ? fmt::format(" F{}", f / 20.0) : fmt::format(" F{}", f + 20);
  }
  std::string maybe_feed() { return mode_ == 93 || random_() % 4 == 0 ? feed() : ""; }
  double far() const { return inch_ ? 0.4 : 10; }

  void add(int kind) {
    switch (kind) {
      case 0:
        out_ += fmt::format("G0 X{} Y{}{}\n", number(far()), number(far()),
                            mode_ != 93 && random_() % 3 == 0 ? feed() : "");
        return;
      case 1:
        if (mode_ != 93) out_ += feed().substr(1) + "\n";
        return;
      case 2: {
        mode_ = std::array{93, 94, 95}[random_() % 3];
        out_ += fmt::format("G{}{}\n", mode_, feed());
        return;
      }
      case 3:
        inch_ = !inch_;
        out_ += inch_ ? "G20\n" : "G21\n";
        return;
      case 4:
        out_ += fmt::format("S{}\n", 500 + 100 * (random_() % 20));
        return;
      case 5:
        if (mode_ != 93 && !called_) out_ += "M98 P7\n";
        called_ = called_ || mode_ != 93;
        return;
      case 6:
        if (mode_ != 93) out_ += "M98 P8 L2\n";
        return;
      case 7:
        if (mode_ != 93) out_ += "#1=2\nWHILE[#1GT0]DO1\nG1 X#1\n#1=#1-1\nEND1\n";
        return;
      case 8:
        out_ += fmt::format("/G1 Z{}{}\n", number(far()), maybe_feed());
        return;
      case 9:
        out_ += fmt::format("G{} I{} J{}{}\n", 2 + random_() % 2, 0.3 * far() + std::abs(number(far())), number(far()),
                            maybe_feed());
        return;
      case 10:
        if (mode_ != 93) out_ += fmt::format("G99 G81 X{} Z-9. R6.{}\nG80\n", number(far()), maybe_feed());
        return;
      default:
        out_ += fmt::format("G1 X{} Y{}{} (c)\n", number(far()), number(far()), maybe_feed());
    }
  }

  std::mt19937 random_;
  std::string out_;
  int mode_ = 94;
  bool inch_ = false, called_ = false;
};

bool is_of_own_text(const Move& m) {
  return m.editable && !m.canned && (m.kind == MoveKind::linear || m.kind == MoveKind::arc);
}

std::vector<MoveEdit> random_feeds(const Read& r, std::mt19937& random) {
  std::vector<MoveEdit> edits;
  for (std::uint32_t i = 0; i < r.moves.moves.size(); ++i) {
    const Move& m = r.moves.moves[i];
    if (!is_of_own_text(m) || random() % 3 == 0) continue;
    MoveEdit e{.move = i};
    const double factor = std::array{0.5, 0.5, 0.733, 1.0, 1.517}[random() % 5];
    if (random() % 4 != 0) e.feed_mm_per_s = factor * m.feed_mm_per_s;
    const bool inverse_arc = m.kind == MoveKind::arc && r.moves.state_of(m).feed_mode == FeedMode::inverse_time;
    if (random() % 4 == 0 && length_mm(r.moves, m) > 1 && !inverse_arc) {
      e.via.push_back({.point_mm = point_at(r.moves, m, 0.3), .feed_mm_per_s = 0.8 * m.feed_mm_per_s});
      e.via.push_back({.point_mm = point_at(r.moves, m, 0.6)});
    }
    edits.push_back(e);
  }
  return edits;
}

/// The feed that each move of the emitted program should have, in order, and whether it was asked for.
struct WantedFeed {
  double feed_mm_per_s = 0;
  bool edited = false;
};
std::vector<WantedFeed> wanted_feeds(const Read& r, const std::vector<MoveEdit>& edits) {
  std::vector<WantedFeed> out;
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < r.moves.moves.size(); ++i) {
    const double own = r.moves.moves[i].feed_mm_per_s;
    if (next == edits.size() || edits[next].move != i) {
      out.push_back({own, false});
      continue;
    }
    const MoveEdit& e = edits[next++];
    const double feed = e.feed_mm_per_s.value_or(own);
    for (const ViaPoint& v : e.via) out.push_back({v.feed_mm_per_s.value_or(feed), true});
    out.push_back({feed, true});
  }
  return out;
}

TEST(EmitFeed, EveryMoveOfARandomProgramHasTheFeedThatWasAskedFor) {
  std::size_t edited = 0, kept = 0, moves = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const std::string text = FeedProgram(seed).run();
    const Read r = read_text(text, as("fanuc"));
    ASSERT_FALSE(r.diagnostics.has_errors()) << text << r.messages.front();
    std::mt19937 random(seed);
    const auto edits = random_feeds(r, random);
    const Emission out = emit_edits(r.program, r.moves, edits, {});
    ASSERT_TRUE(out.not_made.empty()) << text << to_string(out.not_made.front().why);
    const Read again = read_text(out.text, as("fanuc"));
    ASSERT_FALSE(again.diagnostics.has_errors()) << out.text << again.messages.front();
    const auto wanted = wanted_feeds(r, edits);
    ASSERT_EQ(again.moves.moves.size(), wanted.size()) << text << "---\n" << out.text;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const Move& now = again.moves.moves[i];
      const double near = wanted[i].edited ? kFeedRounding : kOtherUnit;
      ASSERT_NEAR(now.feed_mm_per_s, wanted[i].feed_mm_per_s, near * wanted[i].feed_mm_per_s)
          << "move " << i << ", line " << now.block + 1 << "\n"
          << text << "---\n"
          << out.text;
      ++(wanted[i].edited ? edited : kept);
    }
    expect_near_mm(again.moves.moves.back().end_mm, r.moves.moves.back().end_mm, 1e-3);
    moves += wanted.size();
  }
  EXPECT_GT(edited, 3000u);
  EXPECT_GT(kept, 3000u);
  std::cout << fmt::format("{} moves, {} edited\n", moves, edited);
}

TEST(EmitFeed, SkippedBlocksChangeNoOthersFeed) {
  InterpreterOptions skipping = as("fanuc");
  skipping.skip_slash_blocks = true;
  std::size_t compared = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    const Read r = read_text(FeedProgram(seed).run(), as("fanuc"));
    std::mt19937 random(seed);
    auto edits = random_feeds(r, random);
    for (MoveEdit& e : edits) e.via.clear();
    const Read again = read_text(emit(r.program, r.moves, edits, {}), skipping);
    const Read given = read_text(r.program.source.text(), skipping);
    ASSERT_EQ(again.moves.moves.size(), given.moves.moves.size());
    // By block: drilling cycles leave out steps that go nowhere, which depends on what is skipped.
    std::set<std::uint32_t> edited;
    for (const MoveEdit& e : edits) edited.insert(r.moves.moves[e.move].block);
    std::map<std::uint32_t, std::set<double>> feeds_of_block;
    for (const Move& m : r.moves.moves) feeds_of_block[m.block].insert(m.feed_mm_per_s);
    for (std::size_t k = 0; k < given.moves.moves.size(); ++k) {
      const Move &now = again.moves.moves[k], &old = given.moves.moves[k];
      // A move that relied on the F of a skipped block gets the F that it had relied on.
      if (edited.contains(old.block) || !feeds_of_block[old.block].contains(old.feed_mm_per_s)) continue;
      ASSERT_NEAR(now.feed_mm_per_s, old.feed_mm_per_s, kOtherUnit * old.feed_mm_per_s)
          << "line " << now.block + 1 << "\n"
          << r.program.source.text() << "---\n"
          << again.program.source.text();
      ++compared;
    }
  }
  EXPECT_GT(compared, 500u);
}

TEST(EmitFeed, AskingForWhatIsThereChangesNoByte) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const std::string text = FeedProgram(seed).run();
    const Read r = read_text(text, as("fanuc"));
    std::vector<MoveEdit> edits;
    for (std::uint32_t i = 0; i < r.moves.moves.size(); ++i) {
      const Move& m = r.moves.moves[i];
      if (!is_of_own_text(m)) continue;
      MoveEdit e{.move = i, .end_mm = m.end_mm, .feed_mm_per_s = m.feed_mm_per_s};
      if (m.arc != Move::kNoArc) e.center_mm = r.moves.arcs[m.arc].center_mm;
      edits.push_back(e);
    }
    const Emission out = emit_edits(r.program, r.moves, edits, {});
    EXPECT_TRUE(out.not_made.empty());
    ASSERT_EQ(out.text, text) << seed;
  }
}

TEST(EmitFeed, CamProgramsAtHalfTheirFeed) {
  auto files = tests::data_files("nc");
  for (const auto& f : tests::data_files("linuxcnc/programs")) files.push_back(f);
  std::size_t programs = 0, edited = 0, not_made = 0;
  for (const auto& file : files) {
    SCOPED_TRACE(file);
    const Read r = read_text(SourceText::read(file).text());
    if (r.diagnostics.has_errors() || r.moves.moves.empty()) continue;
    ++programs;
    std::vector<MoveEdit> edits;
    for (std::uint32_t i = 0; i < r.moves.moves.size(); ++i)
      if (is_of_own_text(r.moves.moves[i]) && i % 3 != 0)
        edits.push_back({.move = i, .feed_mm_per_s = 0.5 * r.moves.moves[i].feed_mm_per_s});
    const Emission out = emit_edits(r.program, r.moves, edits, {});
    const Read again = read_text(out.text);
    ASSERT_EQ(again.moves.moves.size(), r.moves.moves.size());
    auto wanted = wanted_feeds(r, edits);
    for (const auto& n : out.not_made) wanted[n.move] = {r.moves.moves[n.move].feed_mm_per_s, false};
    not_made += out.not_made.size();
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      ASSERT_NEAR(again.moves.moves[i].feed_mm_per_s, wanted[i].feed_mm_per_s,
                  (wanted[i].edited ? kFeedRounding : 1e-9) * wanted[i].feed_mm_per_s)
          << "move " << i << " of line " << r.moves.moves[i].block + 1;
      edited += wanted[i].edited;
    }
  }
  EXPECT_GE(programs, 15u);
  EXPECT_GT(edited, 10000u);
  std::cout << fmt::format("{} programs, {} feeds edited, {} not made\n", programs, edited, not_made);
}

}  // namespace
}  // namespace camber::nc
