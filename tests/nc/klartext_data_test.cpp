// Programs of others in Klartext, against figures that were worked out without this reader; one part in ISO and
// Klartext.
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/units.h"
#include "nc/emit.h"
#include "nc/emit/text_rules.h"
#include "nc/language.h"
#include "nc/summary.h"
#include "tests/nc/nc_text.h"
#include "tests/support/test_data.h"

namespace camber::nc {
namespace {

using nlohmann::json;

Read read_file(const std::string& path) {
  return read_text(SourceText::read(path).text(), {}, path.substr(path.find_last_of('/') + 1));
}

void add_extents(const Interpretation& program, const Move& move, Extents& box) {
  const Extents own = extents_of(program, move);
  box.add(own.min_mm);
  box.add(own.max_mm);
}

/// What expected.json counts.
struct Counted {
  std::size_t rapid = 0, line = 0, arc = 0;
  double length = 0;
  Extents box;
  Vec3 last = Vec3::Zero();
};

Counted count(const Read& r) {
  Counted out;
  const auto rules = language_of(r.program).text_rules(r.program);
  const double unit = !r.moves.states.empty() && r.moves.states.front().inch ? kMmPerInch : 1;
  std::array<bool, 3> known{};
  for (std::size_t m = 0; m < r.moves.moves.size(); ++m) {
    const Move& move = r.moves.moves[m];
    const Frame& frame = r.moves.frame_of(move);
    if (move.kind == MoveKind::dwell) continue;
    if (move.canned) {
      continue;
    }
    if (rules->goes_to_machine_place(move.block)) {
      for (int a = 0; a < 3; ++a)
        known[static_cast<std::size_t>(a)] = known[static_cast<std::size_t>(a)] && move.start_mm[a] == move.end_mm[a];
      continue;
    }
    const Vec3 end = frame.to_program(move.end_mm) / unit;
    bool all = true;
    for (const bool k : known) all = all && k;
    for (const Word& w : r.program.words_of(move.block))
      if (w.letter >= 'X' && w.letter <= 'Z') known[static_cast<std::size_t>(w.letter - 'X')] = true;
    out.last = end;
    if (move.kind == MoveKind::rapid) {
      ++out.rapid;
      continue;
    }
    ++(move.kind == MoveKind::arc ? out.arc : out.line);
    if (all) {
      out.length += length_mm(r.moves, move) / unit;
      add_extents(r.moves, move, out.box);
    } else {  // a start that is not known: the coordinates of the end that are
      for (int a = 0; a < 3; ++a) {
        if (!known[static_cast<std::size_t>(a)]) continue;
        out.box.min_mm[a] = std::min(out.box.min_mm[a], move.end_mm[a]);
        out.box.max_mm[a] = std::max(out.box.max_mm[a], move.end_mm[a]);
      }
    }
  }
  out.box.min_mm /= unit;
  out.box.max_mm /= unit;
  return out;
}

void expect_as(const json& e, const Read& r) {
  const Counted c = count(r);
  EXPECT_EQ(c.rapid, e["motion_blocks"]["rapid"].get<std::size_t>());
  EXPECT_EQ(c.line, e["motion_blocks"]["feed_line"].get<std::size_t>());
  EXPECT_EQ(c.arc, e["motion_blocks"]["feed_arc"].get<std::size_t>());
  const double length = e["feed_length"];
  EXPECT_NEAR(c.length, length, 1e-5 * length + 1e-3);
  for (int a = 0; a < 3; ++a) {
    const json& range = e["feed_box"][std::string(1, "XYZ"[a])];
    EXPECT_NEAR(c.box.min_mm[a], range[0].get<double>(), 1.1e-3) << "XYZ"[a];
    EXPECT_NEAR(c.box.max_mm[a], range[1].get<double>(), 1.1e-3) << "XYZ"[a];
    const json& last = e["last_position"][std::string(1, "XYZ"[a])];
    if (!last.is_null()) {
      EXPECT_NEAR(c.last[a], last.get<double>(), 1e-3) << "XYZ"[a];
    }
  }
  std::vector<double> speeds;
  std::vector<std::string> tools;
  for (const Event& event : r.moves.events) {
    if (event.kind == EventKind::spindle_speed) speeds.push_back(event.value);
    if (event.kind != EventKind::tool_change) continue;
    const auto name = r.moves.tool_names.find(static_cast<int>(event.value));
    tools.push_back(name == r.moves.tool_names.end() ? fmt::format("{}", event.value) : name->second);
  }
  EXPECT_EQ(speeds, e["spindle_speeds"].get<std::vector<double>>());
  std::vector<std::string> expected;
  for (const json& tool : e["tools"])
    expected.push_back(tool.is_string() ? tool.get<std::string>() : fmt::format("{}", tool.get<int>()));
  EXPECT_EQ(tools, expected);
}

class KlartextPrograms : public testing::TestWithParam<const char*> {};

TEST_P(KlartextPrograms, HaveTheFiguresThatWereWorkedOut) {
  const std::string name = GetParam(), path = tests::unshipped_data("lang/heidenhain/" + name);
  if (path.empty()) GTEST_SKIP() << tests::not_shipped("lang/heidenhain/" + name);
  std::ifstream file(tests::unshipped_data("lang/expected.json"));
  const json expected = json::parse(file)["klartext"][name];
  const Read r = read_file(path);
  EXPECT_FALSE(r.diagnostics.has_errors()) << (r.messages.empty() ? "" : r.messages.front());
  expect_as(expected, r);
  EXPECT_EQ(emit(r.program, r.moves, {}, {}), r.program.source.text());
}
INSTANTIATE_TEST_SUITE_P(, KlartextPrograms,
                         testing::Values("hsm_thread_form.h", "nx_cavity_3axis.h", "cam_frameop4_inch.h",
                                         "sweep_5axis_ln_cut.h", "hm_plate_a38_finish.h", "hm_plate_a22_3plus2.h",
                                         "nx_dmc75v_training.h"));

TEST(KlartextData, AContourWithApproachAndRoundings) {
  const std::string path = tests::unshipped_data("lang/heidenhain/keller_octagon.h");
  if (path.empty()) GTEST_SKIP() << tests::not_shipped("lang/heidenhain/keller_octagon.h");
  const Read r = read_file(path);
  EXPECT_FALSE(r.diagnostics.has_errors()) << r.messages.front();
  const auto& moves = r.moves.moves;
  // Between the arc of APPR and that of DEP.
  std::size_t first = 0, last = moves.size();
  while (first < moves.size() && moves[first].kind != MoveKind::arc) ++first;
  while (last > first && moves[last - 1].kind != MoveKind::arc) --last;
  double length = 0;
  Extents box;
  for (std::size_t m = first + 1; m + 1 < last; ++m) {
    length += length_mm(r.moves, moves[m]);
    add_extents(r.moves, moves[m], box);
  }
  EXPECT_NEAR(length, 296.8578, 3e-3);
  EXPECT_NEAR(box.min_mm.x(), -45, 1e-9);
  EXPECT_NEAR(box.max_mm.x(), 45, 1e-9);
  EXPECT_NEAR(box.min_mm.y(), -45, 1e-9);
  EXPECT_NEAR(box.max_mm.y(), 45, 1e-9);
  expect_near_mm(moves.back().end_mm, Vec3(150, 150, 150));
  // The lines to the arc of APPR and from that of DEP are tangent to it.
  EXPECT_NEAR((direction_at(r.moves, moves[first - 1], 1) - direction_at(r.moves, moves[first], 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((direction_at(r.moves, moves[last - 1], 1) - direction_at(r.moves, moves[last], 0)).norm(), 0, 1e-6);
}

TEST(KlartextData, ProgramsThatAreReadOrRefusedForAReason) {
  const auto check = [](const char* name, const std::vector<std::string>& errors) {
    const std::string path = tests::unshipped_data(std::string("lang/heidenhain/") + name);
    if (path.empty()) return;
    const Read r = read_file(path);
    std::vector<std::string> found;
    for (const std::string& message : r.messages)
      if (message.find(": error: ") != std::string::npos) found.push_back(message);
    EXPECT_EQ(found, errors) << name;
  };
  if (tests::unshipped_data("lang").empty()) GTEST_SKIP() << tests::not_shipped("lang");
  check("apt_board_11.h", {});
  // Pieces of a program: a parameter of a part that was left out, and an arc from where another piece ends.
  check("hm_cup_5axis.h",
        {"hm_cup_5axis.h:80:48: error: Q8 has no value here; FN 0 or Q8 = was expected before [undefined-parameter]",
         "hm_cup_5axis.h:201:8: error: the radius of the arc is 6.0066 mm at its start and 2.9999 mm at its end; a "
         "difference below 0.05 mm was expected [arc-radius]"});
  check("tool_table_cleanup.h", {});
}

/// Arcs of one helix that follow each other are one.
struct Flat {
  MoveKind kind;
  Vec3 start, end;
  double feed = 0, sweep = 0;
  Vec3 centre = Vec3::Zero();
};

std::vector<Flat> flat(const Interpretation& p) {
  std::vector<Flat> out;
  for (const Move& m : p.moves) {
    if (m.start_mm == m.end_mm && m.kind != MoveKind::arc) continue;
    Flat f{m.kind, m.start_mm, m.end_mm, m.feed_mm_per_s};
    if (m.arc != Move::kNoArc) {
      f.sweep = p.arcs[m.arc].sweep_rad;
      f.centre = p.arcs[m.arc].center_mm;
      f.centre.z() = 0;
      const double pitch = (m.end_mm.z() - m.start_mm.z()) / f.sweep;
      if (!out.empty() && out.back().kind == MoveKind::arc && (out.back().centre - f.centre).norm() < 1e-9 &&
          pitch != 0 && std::abs((out.back().end.z() - out.back().start.z()) / out.back().sweep - pitch) < 1e-9) {
        out.back().sweep += f.sweep;
        out.back().end = f.end;
        continue;
      }
    }
    out.push_back(f);
  }
  return out;
}

TEST(KlartextData, OnePartInTwoLanguages) {
  const Read iso = read_file(tests::data_path("lang/same/iso.nc")),
             klartext = read_file(tests::data_path("lang/same/klartext.h"));
  EXPECT_FALSE(klartext.diagnostics.has_errors()) << klartext.messages.front();
  const auto a = flat(iso.moves), b = flat(klartext.moves);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(a[i].kind, b[i].kind);
    if (i > 0) expect_near_mm(a[i].start, b[i].start);
    expect_near_mm(a[i].end, b[i].end);
    EXPECT_NEAR(a[i].feed, b[i].feed, 1e-12);
    EXPECT_NEAR(a[i].sweep, b[i].sweep, 1e-9);
    expect_near_mm(a[i].centre, b[i].centre);
  }
  EXPECT_EQ(klartext.program.language_reason, "BEGIN PGM in line 1");
}

}  // namespace
}  // namespace camber::nc
