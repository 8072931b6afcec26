// Cycles 251 to 253, POCKET3 and POCKET4: what the cutter reaches, against the pocket that they describe.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "nc/tool_names.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

constexpr double kRadius_mm = 4;
constexpr double kStep_mm = 0.5;      ///< between the points of a path
constexpr double kReached_mm = 0.01;  ///< that points of a path lie apart costs so much

struct PocketCase {
  bool round = false, slot = false;
  double length = 60, width = 34, corner = 7, angle_deg = 0;
  double side = 0, floor = 0, overlap = 1.2;
  int operation = 0, climb = 1, place = 0;
};

std::string text_of(const PocketCase& p) {
  std::string out = fmt::format(
      "BEGIN PGM A MM\nTOOL DEF 1 L+0 R+{}\nTOOL CALL 1 Z S3000\nL X+20 Y+30 Z+50 R0 FMAX M3\nCYCL DEF {} ~\nQ215={} "
      "~\n",
      kRadius_mm,
      p.round  ? 252
      : p.slot ? 253
               : 251,
      p.operation);
  out += p.round  ? fmt::format("Q223={} ~\n", p.length)
         : p.slot ? fmt::format("Q218={} ~\nQ219={} ~\nQ374={} ~\nQ367={} ~\n", p.length, p.width, p.angle_deg, p.place)
                  : fmt::format("Q218={} ~\nQ219={} ~\nQ220={} ~\nQ224={} ~\nQ367={} ~\n", p.length, p.width, p.corner,
                                p.angle_deg, p.place);
  return out + fmt::format(
                   "Q368={} ~\nQ207=500 ~\nQ351={} ~\nQ201=-10 ~\nQ202=4 ~\nQ369={} ~\nQ206=150 ~\nQ338=5 ~\nQ200=2 "
                   "~\nQ203=0 ~\nQ204=20 ~\nQ370={} ~\nQ366=0 ~\nQ385=400\nCYCL CALL\nM30\nEND PGM A MM\n",
                   p.side, p.climb, p.floor, p.overlap);
}

struct Cut {
  std::vector<Vec3> points;  ///< of the feed moves, in coordinates of the pocket
  double turned_rad = 0;     ///< sum of the turns of its arcs
};

Cut cut_of(const PocketCase& p, const Interpretation& moves) {
  Cut out;
  const double c = std::cos(rad_from_deg(p.angle_deg)), s = std::sin(rad_from_deg(p.angle_deg));
  Vec3 middle(20, 30, 0);
  if (p.slot && p.place != 0) {  // left end, centres of the arcs, right end
    const double along = (p.place <= 2 ? 0.5 : -0.5) * (p.length - (p.place == 2 || p.place == 3 ? p.width : 0));
    middle += Vec3(c * along, s * along, 0);
  } else if (p.place == 1)
    middle += Vec3(c * p.length / 2 - s * p.width / 2, s * p.length / 2 + c * p.width / 2, 0);
  for (const Move& m : moves.moves) {
    if (m.kind != MoveKind::linear && m.kind != MoveKind::arc) continue;
    if (m.arc != Move::kNoArc) out.turned_rad += moves.arcs[m.arc].sweep_rad;
    const int least = m.arc == Move::kNoArc ? 1 : 24;  // small circles too are round
    const int n = std::max(least, static_cast<int>(length_mm(moves, m) / kStep_mm));
    for (int i = 0; i <= n; ++i) {
      const Vec3 d = point_at(moves, m, static_cast<double>(i) / n) - middle;
      out.points.emplace_back(c * d.x() + s * d.y(), -s * d.x() + c * d.y(), d.z());
    }
  }
  return out;
}

/// How far a point lies inside the walls of the pocket, less `off` all round.
double inside_mm(const PocketCase& p, double x, double y, double off) {
  if (p.round) return p.length / 2 - off - std::hypot(x, y);
  const double corner = std::max(p.corner - off, 0.0);
  const double u = std::abs(x) - (p.length / 2 - off - corner), v = std::abs(y) - (p.width / 2 - off - corner);
  return corner - std::hypot(std::max(u, 0.0), std::max(v, 0.0)) - std::min(std::max(u, v), 0.0);
}

std::vector<PocketCase> cases() {
  return {{},
          {.angle_deg = 33, .side = 0.4, .floor = 0.3, .place = 1},
          {.corner = 0, .overlap = 1, .climb = -1},
          {.width = 60, .side = 0.5, .floor = 0.5, .operation = 1},
          {.side = 0.5, .floor = 0.5, .operation = 2},
          {.slot = true, .width = 20, .corner = 10},
          {.slot = true, .width = 8, .corner = 4, .angle_deg = 90},
          {.slot = true, .width = 12, .corner = 6, .angle_deg = -20, .side = 0.2, .floor = 0.1, .place = 1},
          {.slot = true, .width = 20, .corner = 10, .place = 2},
          {.slot = true, .width = 20, .corner = 10, .place = 3},
          {.slot = true, .width = 20, .corner = 10, .place = 4},
          {.round = true},
          {.round = true, .length = 21, .side = 0.3, .floor = 0.2, .overlap = 0.7, .climb = -1},
          {.round = true, .length = 8.5}};
}

TEST(KlartextPocket, TheCutterKeepsWithinTheWallsAndReachesAllOfTheFloor) {
  for (std::size_t k = 0; k < cases().size(); ++k) {
    SCOPED_TRACE(k);
    const PocketCase p = cases()[k];
    const Read r = read_clean(text_of(p));
    Cut cut = cut_of(p, r.moves);
    const double side = p.operation == 1 ? p.side : 0, floor = p.operation == 1 ? p.floor : 0;
    double nearest = 1e9, lowest = 1e9;
    for (const Vec3& at : cut.points) {
      nearest = std::min(nearest, inside_mm(p, at.x(), at.y(), std::max(side, 0.0)));
      lowest = std::min(lowest, at.z());
    }
    const double corner_gap = p.corner < kRadius_mm && !p.round ? 0 : kReached_mm;
    EXPECT_GE(nearest, kRadius_mm - 1e-6 - corner_gap);
    EXPECT_LE(nearest, kRadius_mm + kReached_mm);
    EXPECT_NEAR(lowest, -10 + floor, 1e-9);
    // All of the floor, but for what the cutter cannot reach in sharp corners.
    PocketCase reached = p;
    if (!p.round) reached.corner = std::max(p.corner, kRadius_mm);
    std::erase_if(cut.points, [&](const Vec3& at) { return at.z() > lowest + 1e-9; });
    std::size_t left = 0, all = 0;
    for (double x = -p.length / 2; x <= p.length / 2; x += 1.3)
      for (double y = -p.length / 2; y <= p.length / 2; y += 1.3) {
        if (inside_mm(reached, x, y, side) < 2 * kReached_mm) continue;
        ++all;
        left += std::ranges::none_of(cut.points, [&](const Vec3& at) {
          return (at.head<2>() - Vec2(x, y)).squaredNorm() < kRadius_mm * kRadius_mm;
        });
      }
    EXPECT_GT(all, 20u);
    EXPECT_EQ(left, 0u);
    EXPECT_EQ(cut.turned_rad > 0,
              p.climb > 0 && !(p.slot && p.width <= 2 * kRadius_mm));  // as wide as the cutter: no arc
    EXPECT_NEAR(r.moves.moves.back().end_mm.z(), 20, 1e-9);
  }
}

/// The feed moves, as text.
std::string feeds_of(const Read& r) {
  std::string out;
  for (const Move& m : r.moves.moves)
    if (m.kind == MoveKind::linear || m.kind == MoveKind::arc)
      out += fmt::format("{:.4f} {:.4f} {:.4f} {:.3f} F{:.3f}\n", m.end_mm.x() + 0.0, m.end_mm.y() + 0.0, m.end_mm.z(),
                         m.arc == Move::kNoArc ? 0 : r.moves.arcs[m.arc].sweep_rad, m.feed_mm_per_s);
  return out;
}

TEST(KlartextPocket, SinumerikPocketsCutTheSame) {
  InterpreterOptions options = units();
  set_cutter_radius(options.tool_offsets, 1, kRadius_mm);
  const auto sinumerik = [&](const std::string& cycle) {
    const Read r = read_text("G710 G17 G90\nT1 M6\nS3000 M3\nG0 X20 Y30 Z50\n" + cycle + "\nM30\n", options, "p.mpf");
    EXPECT_FALSE(r.diagnostics.has_errors()) << r.messages.front();
    return r;
  };
  const std::string rough = feeds_of(read_clean(text_of({.side = 0.5, .floor = 0.5, .operation = 1})));
  EXPECT_EQ(feeds_of(sinumerik("POCKET3(20,0,2,-10,60,34,7,20,30,0,4,0.5,0.5,500,150,0,11,4.8)")), rough);
  // Depth, sideways infeed in percent of the cutter, a corner: as newer controls write them.
  EXPECT_EQ(feeds_of(sinumerik("POCKET3(20,0,2,10,60,34,7,-10,13,0,4,0.5,0.5,500,150,0,1,60,,,,,,0,1,2,2100,1,11)")),
            rough);
  const std::string round =
      feeds_of(read_clean(text_of({.round = true, .length = 40, .overlap = 1, .operation = 1, .climb = -1})));
  EXPECT_EQ(feeds_of(sinumerik("POCKET4(20,0,2,-10,20,20,30,4,0,0,500,150,1,21,4)")), round);
  EXPECT_EQ(feeds_of(sinumerik("POCKET4(20,0,2,10,40,20,30,4,0,0,500,150,2,21,50,9,15,6,1,0,1,2,10100,111,111)")),
            round);
  const Read done = sinumerik("POCKET4(20,0,2,-10,20,20,30,4,0.1,0.1,500,150,0,2,4)");
  EXPECT_NEAR(done.moves.moves.back().end_mm.z(), 20, 1e-9);
  EXPECT_EQ(done.messages.size(), 1u);
}

TEST(KlartextPocket, SinumerikSlotsCutTheSame) {
  InterpreterOptions options = units();
  set_cutter_radius(options.tool_offsets, 1, kRadius_mm);
  const auto feeds = [&](const std::string& cycle) {
    const Read r = read_text("G710 G17 G90\nT1 M6\nS3000 M3\nG0 X20 Y30 Z50\n" + cycle + "\nM30\n", options, "p.mpf");
    EXPECT_FALSE(r.diagnostics.has_errors()) << r.messages.front();
    return feeds_of(r);
  };
  const auto of_253 = [](double width, double side, double angle_deg) {
    return feeds_of(read_clean(text_of({.slot = true,
                                        .length = 62,
                                        .width = width,
                                        .corner = width / 2,
                                        .angle_deg = angle_deg,
                                        .side = side,
                                        .operation = 1})));
  };
  EXPECT_EQ(feeds("SLOT1(20,0,2,-10,,1,62,20,-16,30,5,0,0,150,500,4,0,0.5,1)"), of_253(20, 0.5, 0));
  EXPECT_EQ(feeds("SLOT1(20,0,2,,10,1,62,20,20,-6,5,90,0,150,500,4,3,0,1)"), of_253(20, 0, 90));
  EXPECT_EQ(feeds("LONGHOLE(20,0,2,-10,,1,62,-16,30,5,0,0,150,500,4)"), of_253(2 * kRadius_mm, 0, 0));
  // Three on a circle: a third of a turn apart.
  const std::string three = feeds("LONGHOLE(20,0,2,-10,,3,62,-16,30,5,0,0,150,500,4)");
  EXPECT_EQ(std::ranges::count(three, '\n'), 3 * std::ranges::count(of_253(2 * kRadius_mm, 0, 0), '\n'));
}

/// Turns of the helices of cycle 262 and the heights from which and to which they go, as text.
std::string helices_of(const std::string& values) {
  const Read r = read_text(
      "BEGIN PGM A MM\nTOOL DEF 1 L+0 R+4\nTOOL CALL 1 Z S3000\nL X+20 Y+30 Z+50 R0 FMAX M3\nCYCL DEF 262 Q335=16 "
      "Q201=-15 Q253=750 Q200=2 Q203=0 Q204=50 Q207=500 " +
          values + "\nCYCL CALL\nM30\nEND PGM A MM\n",
      units(), "p.h");
  EXPECT_EQ(r.messages.size(), 1u);  // the ways in and out
  std::string out;
  for (const Move& m : r.moves.moves) {
    if (m.arc == Move::kNoArc || m.start_mm.z() == m.end_mm.z()) continue;
    out += fmt::format("{:g}: {:g} to {:g}\n", r.moves.arcs[m.arc].sweep_rad / (2 * kPi), m.start_mm.z(), m.end_mm.z());
    EXPECT_NEAR((m.start_mm - Vec3(20, 30, m.start_mm.z())).norm(), 16.0 / 2 - 4, 1e-9);
  }
  EXPECT_LT((r.moves.moves.back().end_mm - Vec3(20, 30, 50)).norm(), 1e-9);
  return out;
}

/// Climb cutting inside goes round counter-clockwise: a right-hand thread upwards, a left-hand one downwards.
TEST(KlartextPocket, ThreadsRiseByTheirPitchAndHand) {
  EXPECT_EQ(helices_of("Q239=1.5 Q355=1 Q351=1"), "10: -15 to 0\n");
  EXPECT_EQ(helices_of("Q239=1.5 Q355=1 Q351=-1"), "-10: 0 to -15\n");
  EXPECT_EQ(helices_of("Q239=-1.5 Q355=1 Q351=1"), "10: 0 to -15\n");
  EXPECT_EQ(helices_of("Q239=1.5 Q355=0 Q351=1"), "1: -15 to -13.5\n");
  EXPECT_EQ(helices_of("Q239=1.5 Q355=4 Q351=1"), "1: -15 to -13.5\n1: -9 to -7.5\n1: -3 to -1.5\n");
}

TEST(KlartextPocket, CutsNoDeeperThanQ202AtOnce) {
  const PocketCase p;
  const Read r = read_clean(text_of(p));
  std::vector<double> heights;
  for (const Move& m : r.moves.moves)
    if (m.kind == MoveKind::arc && (heights.empty() || heights.back() != m.end_mm.z())) heights.push_back(m.end_mm.z());
  EXPECT_EQ(heights, (std::vector<double>{-4, -8, -10}));
}

TEST(KlartextPocket, TheRadiusOfTheCutterMayComeFromTheJob) {
  const std::string text = text_of({.round = true});
  const std::string without = text.substr(0, text.find("TOOL DEF")) + text.substr(text.find("TOOL CALL"));
  const Read unknown = read_text(without, units(), "p.h");
  ASSERT_TRUE(unknown.diagnostics.has_errors());
  EXPECT_EQ(unknown.diagnostics.all().front().check, "radius-unknown");
  InterpreterOptions options = units();
  set_cutter_radius(options.tool_offsets, 1, kRadius_mm);
  const Read known = read_text(without, options, "p.h"), given = read_clean(text);
  EXPECT_FALSE(known.diagnostics.has_errors());
  ASSERT_EQ(known.moves.moves.size(), given.moves.moves.size());
  for (std::size_t i = 0; i < known.moves.moves.size(); ++i)
    EXPECT_LT((known.moves.moves[i].end_mm - given.moves.moves[i].end_mm).norm(), 1e-12);
}

TEST(KlartextPocket, SaysWhatIsWrong) {
  const auto said = [](const PocketCase& p) {
    const Read r = read_text(text_of(p), units(), "p.h");
    std::string out;
    for (Diagnostic d : r.diagnostics.all()) {
      d.source_line.clear();
      out += to_string(d) + "\n";
    }
    return out;
  };
  EXPECT_EQ(said({.round = true, .length = 7}),
            "p.h:22:1: error: the pocket of cycle 252 is smaller than the tool of 8.0000 mm and its allowance "
            "[cutter-too-large]\n");
  EXPECT_EQ(said({.overlap = 2}),
            "p.h:26:1: error: an overlap Q370 of 2; greater than 0 and less than 2 was expected [cycle]\n");
}

}  // namespace
}  // namespace camber::nc
