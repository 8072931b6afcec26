// Real Sinumerik programs against figures worked out by a script of its own (../shared/data/lang/README.md).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

#include "nc/emit.h"
#include "nc/summary.h"
#include "test_paths.h"
#include "tests/nc/nc_text.h"
#include "tests/support/test_data.h"

namespace camber::nc {
namespace {

using Json = nlohmann::json;

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What expected.json counts: without cycles' own moves, machine coordinates and rotary axes alone; coordinates as
/// programmed.
struct Figures {
  int rapid = 0, line = 0, arc = 0;
  Extents box;
  double length = 0;
  Vec3 last = Vec3::Zero();
};

bool in_machine_coordinates(const Program& program, const Move& move) {
  const std::string line(program.source.line(move.block + 1));
  return line.find("SUPA") != std::string::npos || line.find("G53") != std::string::npos ||
         line.find("CYCLE800") != std::string::npos;
}

bool turns_alone(const Program& program, const Move& move) {
  for (const Word& w : program.words_of(move.block))
    if (w.letter >= 'X' && w.letter <= 'Z') return false;
  return program.source.line(move.block + 1).find_first_of("BC") != std::string_view::npos &&
         move.start_mm == move.end_mm;
}

Figures figures_of(const Read& r) {
  Figures f;
  const Interpretation& all = r.moves;
  Interpretation own;  // one move in program coordinates
  for (const Move& move : all.moves) {
    if (move.kind == MoveKind::dwell || move.canned || in_machine_coordinates(r.program, move) ||
        turns_alone(r.program, move))
      continue;
    const double unit = all.state_of(move).inch ? 25.4 : 1;
    f.rapid += move.kind == MoveKind::rapid;
    f.line += move.kind == MoveKind::linear;
    f.arc += move.kind == MoveKind::arc;
    const Frame& frame = all.frame_of(move);
    Move there = move;
    there.start_mm = frame.to_program(move.start_mm);
    there.end_mm = frame.to_program(move.end_mm);
    f.last = there.end_mm / unit;
    if (move.kind == MoveKind::rapid) continue;
    own.arcs.clear();
    if (move.arc != Move::kNoArc) {
      Arc arc = all.arcs[move.arc];
      arc.center_mm = frame.to_program(arc.center_mm);
      arc.normal = (frame.inverse * arc.normal).normalized();
      own.arcs.push_back(arc);
      there.arc = 0;
    }
    const Extents box = extents_of(own, there);
    f.box.add(box.min_mm / unit);
    f.box.add(box.max_mm / unit);
    if (r.program.source.line(move.block + 1).find("TURN=1") == std::string_view::npos &&
        r.program.source.line(move.block + 1).find("TURN=.5") == std::string_view::npos)
      f.length += length_mm(own, there) / unit;  // how many turns a closed arc makes is open
  }
  return f;
}

class SiemensPrograms : public ::testing::TestWithParam<const char*> {};

TEST_P(SiemensPrograms, HaveTheExpectedMoves) {
  const std::string folder = tests::unshipped_data("lang");
  if (folder.empty()) GTEST_SKIP() << tests::not_shipped("lang");
  const std::string name = GetParam();
  const Json expected = Json::parse(read_file(folder + "/expected.json")).at("siemens").at(name);
  InterpreterOptions options;
  options.rotary_axes = {{.letter = 'A'}, {.letter = 'B'}, {.letter = 'C'}};
  const Read r = read_text(read_file(folder + "/siemens/" + name), options, folder + "/siemens/" + name);
  // A rectangular spigot under MCALL, which no control runs: refused by name.
  for (const std::string& message : r.messages) {
    if (name == "nx_dmu70_evo_inch.mpf" && message.find("CYCLE76") != std::string::npos) continue;
    EXPECT_EQ(message.find(": error: "), std::string::npos) << message;
  }
  EXPECT_EQ(r.program.language, LanguageId::siemens);
  EXPECT_EQ(emit(r.program, r.moves, {}, {}), r.program.source.text());

  const Figures f = figures_of(r);
  const Json& counts = expected.at("motion_blocks");
  EXPECT_EQ(f.rapid, counts.at("rapid").get<int>());
  EXPECT_EQ(f.line, counts.at("feed_line").get<int>());
  EXPECT_EQ(f.arc, counts.at("feed_arc").get<int>());
  const bool chaotic = name == "SINULORENZ.MPF";
  const double of_box = chaotic ? 0.05 : 1e-3;
  for (int axis = 0; axis < 3; ++axis) {
    const Json& range = expected.at("feed_box").at(std::string(1, "XYZ"[axis]));
    EXPECT_NEAR(f.box.min_mm[axis], range.at(0).get<double>(), of_box);
    EXPECT_NEAR(f.box.max_mm[axis], range.at(1).get<double>(), of_box);
    const Json& last = expected.at("last_position").at(std::string(1, "XYZ"[axis]));
    if (!last.is_null() && !chaotic) {
      EXPECT_NEAR(f.last[axis], last.get<double>(), 1e-3);
    }
  }
  double length = expected.at("feed_length").get<double>();
  if (expected.contains("feed_length_of_blocks_with_TURN"))
    length -= expected["feed_length_of_blocks_with_TURN"].get<double>();
  EXPECT_NEAR(f.length, length, chaotic ? 0.5 : 1e-5 * length);

  std::vector<double> speeds;
  std::vector<Json> tools;
  for (const Event& e : r.moves.events) {
    if (e.kind == EventKind::spindle_speed) speeds.push_back(e.value);
    if (e.kind != EventKind::tool_change) continue;
    const int tool = static_cast<int>(e.value);
    const auto named = r.moves.tool_names.find(tool);
    tools.push_back(named != r.moves.tool_names.end() ? Json(named->second) : Json(tool));
  }
  EXPECT_EQ(speeds, expected.at("spindle_speeds").get<std::vector<double>>());
  EXPECT_EQ(Json(tools), expected.at("tools"));
}

INSTANTIATE_TEST_SUITE_P(Lang, SiemensPrograms,
                         ::testing::Values("thesis_plate.mpf", "thesis_gear_arcs.mpf", "nx_plate_840d.mpf",
                                           "nx_bottle_opener.mpf", "hand_screw_groove.mpf", "demo1_swivel_facing.mpf",
                                           "nx_huron_kx20_training.mpf", "nx_dmu70_evo_inch.mpf", "SINULORENZ.MPF"));

/// The same part in ISO and in this language.
TEST(SiemensSame, HasTheMovesOfTheIsoProgram) {
  const std::string folder = CAMBER_SOURCE_DIR "/tests/data/lang";
  const Read iso = read_text(read_file(folder + "/same/iso.nc"), units(), "iso.nc");
  const Read own = read_text(read_file(folder + "/same/siemens.mpf"), {}, "siemens.mpf");
  EXPECT_EQ(own.messages, std::vector<std::string>{});
  // In ISO the helix of one and a half turns is two arcs.
  std::vector<Move> wanted = iso.moves.moves;
  std::size_t n = 0;
  const auto sweep = [](const Read& r, const Move& m) {
    return m.arc == Move::kNoArc ? 0.0 : r.moves.arcs[m.arc].sweep_rad;
  };
  for (std::size_t i = 0; i < own.moves.moves.size(); ++i, ++n) {
    ASSERT_LT(n, wanted.size());
    const Move& m = own.moves.moves[i];
    double turned = sweep(iso, wanted[n]);
    const Vec3 start = wanted[n].start_mm;
    while (m.kind == MoveKind::arc && (wanted[n].end_mm - m.end_mm).norm() > 1e-9 && n + 1 < wanted.size() &&
           wanted[n + 1].kind == MoveKind::arc)
      turned += sweep(iso, wanted[++n]);
    EXPECT_EQ(m.kind, wanted[n].kind) << i;
    expect_near_mm(m.start_mm, start);
    expect_near_mm(m.end_mm, wanted[n].end_mm);
    EXPECT_NEAR(sweep(own, m), turned, 1e-9) << i;
    if (m.arc != Move::kNoArc) {
      Vec3 centre = iso.moves.arcs[wanted[n].arc].center_mm;
      centre.z() = m.start_mm.z();
      expect_near_mm(own.moves.arcs[m.arc].center_mm, centre);
    }
    EXPECT_NEAR(m.feed_mm_per_s, wanted[n].feed_mm_per_s, 1e-12) << i;
  }
  EXPECT_EQ(n, wanted.size());
}

}  // namespace
}  // namespace camber::nc
