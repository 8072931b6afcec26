// Programs as the post-processors of CAM systems write them for a TNC and an 840D: headers, home positions, cycles.
#include <set>

#include "tests/nc/nc_text.h"
#include "tests/support/test_data.h"

namespace camber::nc {
namespace {

struct Counts {
  const char* file;
  std::size_t lines, arcs;  ///< that cut, beside cycles; counted by hand
  std::size_t holes;        ///< places in which cycles drill
  std::vector<int> tools;
};

std::vector<Counts> programs() {
  return {{"hypermill_tnc.H", 6, 2, 0, {1, 2}},    {"fusion_tnc.H", 6, 3, 3, {1, 3}},
          {"powermill_tnc.H", 3, 0, 0, {5}},       {"solidcam_tnc.H", 4, 4, 0, {2}},
          {"mastercam_tnc.H", 3, 2, 3, {1}},       {"nx_tnc.H", 4, 1, 2, {3}},
          {"hypermill_840d.mpf", 4, 2, 0, {1, 2}}, {"fusion_840d.mpf", 5, 2, 3, {1}},
          {"powermill_840d.mpf", 2, 0, 0, {5}},    {"nx_840d.mpf", 2, 2, 0, {1}},
          {"mastercam_840d.mpf", 3, 1, 9, {1}},    {"solidcam_840d.mpf", 9, 0, 0, {1}}};
}

Counts counted(const Interpretation& program) {
  Counts out{"", 0, 0, 0, {}};
  std::set<std::pair<long, long>> holes;
  std::set<int> tools;
  for (const Move& m : program.moves) {
    if (m.kind != MoveKind::linear && m.kind != MoveKind::arc) continue;
    tools.insert(program.state_of(m).tool);
    if (m.canned)
      holes.insert({std::lround(m.end_mm.x() * 1000), std::lround(m.end_mm.y() * 1000)});
    else
      ++(m.kind == MoveKind::arc ? out.arcs : out.lines);
  }
  out.holes = holes.size();
  out.tools.assign(tools.begin(), tools.end());
  return out;
}

TEST(PostPrograms, AreReadWhole) {
  InterpreterOptions options = units();
  options.rotary_axes = {{.letter = 'A'}, {.letter = 'B'}, {.letter = 'C'}};
  for (const Counts& expected : programs()) {
    SCOPED_TRACE(expected.file);
    const std::string path = tests::data_path(std::string("lang/posts/") + expected.file);
    const Read r = read_text(SourceText::read(path).text(), options, expected.file);
    for (const std::string& message : r.messages) EXPECT_EQ(message.find(": error: "), std::string::npos) << message;
    const Counts c = counted(r.moves);
    EXPECT_EQ(c.lines, expected.lines);
    EXPECT_EQ(c.arcs, expected.arcs);
    EXPECT_EQ(c.holes, expected.holes);
    EXPECT_EQ(c.tools, expected.tools);
  }
}

}  // namespace
}  // namespace camber::nc
