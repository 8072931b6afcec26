// Programs written from nothing, in each language.
#include "nc/write/program_writer.h"

#include <random>

#include <gtest/gtest.h>

#include "nc/language.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

WrittenProgram small_program(const Dialect& dialect) {
  const auto writer = program_writer(dialect, {.title = "Copy milling", .decimals = 3, .coolant = true});
  writer->begin();
  writer->change_tool({.number = 3, .comment = "BALL D6", .spindle_rpm = 9000, .safe_z_mm = 12});
  writer->rapid({0, -1.5, 12});
  writer->rapid({0, -1.5, 2});
  writer->line({0, -1.5, -0.25}, 400);
  writer->line({10, -1.5, -0.25}, 1200.5);
  writer->arc({10, 1.5, -0.25}, {10, 0}, true, 1200.5);
  writer->line({10, 3, -0.25}, 1200.5);
  writer->dwell(0.2);
  writer->rapid({10, 3, 12});
  return writer->finish();
}

std::string small_text(std::string_view dialect) {
  const Dialect& d = *dialect_named(dialect);
  return text_of(d, small_program(d));
}

TEST(ProgramWriter, WritesGCode) {
  EXPECT_EQ(small_text("fanuc"), R"(%
O0001 (Copy milling)
G21 G17 G90 G94 G40 G49 G80
T3 M6 (BALL D6)
G54 S9000 M3
G43 H3 G0 Z12.
M8
X0. Y-1.5 Z12.
Z2.
G1 Z-0.25 F400.
X10. F1200.5
G3 Y1.5 I0. J1.5
G1 Y3.
G4 P200
G0 Z12.
M9
M5
M30
%
)");
}

TEST(ProgramWriter, WritesKlartext) {
  EXPECT_EQ(small_text("heidenhain"), R"(0 BEGIN PGM COPY_MILLING MM
1 TOOL CALL 3 Z S9000 ; BALL D6
2 L Z+12 R0 FMAX M3
3 M8
4 L X+0 Y-1.5 Z+12 FMAX
5 L Z+2 FMAX
6 L Z-0.25 F400
7 L X+10 F1200.5
8 CC X+10 Y+0
9 C X+10 Y+1.5 DR+
10 L Y+3
11 CYCL DEF 9.0 DWELL TIME
12 CYCL DEF 9.1 DWELL 0.2
13 L Z+12 FMAX
14 M9
15 M5
16 M30
17 END PGM COPY_MILLING MM
)");
}

TEST(ProgramWriter, WritesSinumerik) {
  EXPECT_EQ(small_text("siemens"), R"(%_N_COPY_MILLING_MPF
;$PATH=/_N_MPF_DIR
G17 G71 G90 G94 G40
T3 ; BALL D6
M6 D1
G54 S9000 M3
G0 Z12
M8
X0 Y-1.5 Z12
Z2
G1 Z-0.25 F400
X10 F1200.5
G3 Y1.5 I0 J1.5
G1 Y3
G4 F0.2
G0 Z12
M9
M5
M30
)");
}

TEST(ProgramWriter, AnOperationComesBackFromATextInWhichNumbersWereChanged) {
  for (const char* name : {"fanuc", "heidenhain", "siemens"}) {
    const Dialect& dialect = *dialect_named(name);
    const WrittenProgram program = small_program(dialect);
    EXPECT_EQ(operation_of(dialect, program, text_of(dialect, program)), program.operations.at(0)) << name;
  }
}

/// Lines, rapids, arcs in three planes and rests of random sizes: the same moves from every language.
class SamePath {
 public:
  explicit SamePath(unsigned seed) : random_(seed) {
    for (int i = 0; i < 40; ++i) {
      Step step{.kind = std::uniform_int_distribution(0, 5)(random_), .to = place(), .feed = size(100, 5000)};
      if (step.kind >= 3) step.to = Vec3::Zero();
      steps_.push_back(step);
      arcs_.push_back({size(-20, 20), size(-20, 20)});
    }
  }

  std::string write(const Dialect& dialect) const {
    const auto writer = program_writer(dialect, {.title = "SAME", .decimals = 4});
    writer->begin();
    writer->change_tool({.number = 1, .comment = "", .spindle_rpm = 1000, .safe_z_mm = 50});
    writer->rapid({0, 0, 50});
    Vec3 at{0, 0, 50};
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const Step& step = steps_[i];
      if (step.kind == 0)
        writer->rapid(at = step.to);
      else if (step.kind == 1)
        writer->line(at = step.to, step.feed);
      else if (step.kind == 2)
        writer->dwell(0.5);
      else
        arc(*writer, at, i);
    }
    return text_of(dialect, writer->finish());
  }

 private:
  struct Step {
    int kind = 0;
    Vec3 to = Vec3::Zero();
    double feed = 0;
  };

  /// A half turn, or all round.
  void arc(ProgramWriter& writer, Vec3& at, std::size_t i) const {
    const auto plane = static_cast<Plane>(steps_[i].kind - 3);
    const PlaneAxes axes = axes_of(plane);
    const Vec2 centre = Vec2(at[axes.first], at[axes.second]) + arcs_[i];
    if (i % 3 != 0) {
      at[axes.first] += 2 * arcs_[i].x();
      at[axes.second] += 2 * arcs_[i].y();
    }
    writer.arc(at, centre, i % 2 == 0, steps_[i].feed, plane);
  }

  double size(double from, double to) {
    return std::round(1e3 * std::uniform_real_distribution(from, to)(random_)) / 1e3;
  }
  Vec3 place() { return {size(-90, 90), size(-90, 90), size(-90, 90)}; }

  std::mt19937 random_;
  std::vector<Step> steps_;
  std::vector<Vec2> arcs_;
};

TEST(ProgramWriter, SaysTheSameInEveryLanguage) {
  for (unsigned seed = 1; seed <= 70; ++seed) {
    SCOPED_TRACE(seed);
    const SamePath path(seed);
    const Read iso = read_clean(path.write(*dialect_named("fanuc")), as("fanuc"));
    for (const char* name : {"linuxcnc", "heidenhain", "siemens"}) {
      SCOPED_TRACE(name);
      const std::string text = path.write(*dialect_named(name));
      const Read other = read_clean(text, as(name));
      ASSERT_EQ(other.moves.moves.size(), iso.moves.moves.size()) << text;
      for (std::size_t m = 0; m < iso.moves.moves.size(); ++m) {
        const Move &a = iso.moves.moves[m], &b = other.moves.moves[m];
        ASSERT_EQ(a.kind, b.kind) << m;
        ASSERT_LT((a.end_mm - b.end_mm).norm(), 1e-9) << m;
        ASSERT_NEAR(length_mm(iso.moves, a), length_mm(other.moves, b), 1e-9) << m;
        ASSERT_NEAR(a.feed_mm_per_s, b.feed_mm_per_s, 1e-9) << m;
      }
    }
  }
}

}  // namespace
}  // namespace camber::nc
