// What holds of every emitted program: random programs and all shared ones.
#include <rapidcheck.h>

#include <iostream>
#include <map>
#include <random>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/emit.h"
#include "tests/nc/nc_text.h"
#include "tests/support/random_program.h"
#include "tests/support/test_data.h"

namespace camber::nc {
namespace {

struct Counts {
  std::size_t programs = 0, moves = 0, edits = 0, edits_not_made = 0, via_points = 0;
  void print(const char* test) const {
    std::cout << fmt::format("{}: {} programs, {} moves, {} edits ({} not made and reported), {} via points\n", test,
                             programs, moves, edits, edits_not_made, via_points);
  }
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
    lines.push_back(text.substr(at, end + 1 - at));
    at = end + 1;
  }
  return lines;
}

/// The line without the words that an edit may change.
std::string frame_of(const std::string& line, bool with_feed) {
  std::string out;
  bool comment = false, word = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    comment = comment ? c != ')' : c == '(';
    const char letter = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    const bool begins = letter >= 'A' && letter <= 'Z';
    if (begins)
      word = !comment &&
             (std::string_view("XYZIJKR").find(letter) != std::string_view::npos || (letter == 'F' && !with_feed));
    const bool number = c == '.' || c == '-' || c == '+' || c == ' ' || (c >= '0' && c <= '9');
    if (!begins && !number) word = false;
    if (!word && (comment || c != ' ')) out += c;
  }
  return out;
}

bool editable(const Move& m) {
  return (m.kind == MoveKind::linear || m.kind == MoveKind::arc) && !m.canned && !m.reference;
}

bool is_full_turn(const Read& r, const Move& m) {
  if (m.arc == Move::kNoArc) return false;
  const Vec3 normal = r.moves.arcs[m.arc].normal, way = m.end_mm - m.start_mm;
  return (way - way.dot(normal) * normal).norm() < 1e-6;
}

MoveEdit shifted(const Read& r, std::uint32_t m, const Vec3& by, double fraction_of_centre = 0.5) {
  const Move& move = r.moves.moves[m];
  MoveEdit edit{.move = m, .end_mm = move.end_mm + by};
  if (move.arc != Move::kNoArc) edit.center_mm = r.moves.arcs[move.arc].center_mm + fraction_of_centre * by;
  return edit;
}

/// Rounding of a word, and in incremental programs nothing more: it does not add up.
double tolerance_mm(const Read& r, const Move& m) {
  return 0.5001 * (r.moves.state_of(m).inch ? 1e-5 * kMmPerInch : 1e-4) + 1e-9;
}

/// Reading the text again, with what the first reading knew.
Read read_again(const Read& before, const std::string& text) {
  InterpreterOptions options = units();
  if (!before.moves.states.empty()) options.absolute_arc_centre = before.moves.states[0].absolute_arc_centre;
  return read_text(text, options);
}

/// One edit: its move ends where it should, all others where they did, and no text changes without need.
class OneEdit {
 public:
  OneEdit(const Read& before, const MoveEdit& edit)
      : before_(before), edit_(edit), emission_(emit_edits(before.program, before.moves, std::span(&edit, 1), {})) {}

  /// Empty: all is well.
  std::string problem(Counts& counts) const {
    ++counts.edits;
    counts.edits_not_made += !emission_.not_made.empty();
    const Read after = read_again(before_, emission_.text);
    for (const auto& m : after.messages)
      if (m.find("error") != std::string::npos) return m;
    const auto &old = before_.moves.moves, &now = after.moves.moves;
    if (old.size() != now.size()) return fmt::format("{} moves instead of {}", now.size(), old.size());
    for (std::uint32_t i = 0; i < old.size(); ++i) {
      if (const std::string wrong = problem_of_move(after, i); !wrong.empty())
        return fmt::format("move {} of line {}: {}", i, old[i].block + 1, wrong);
    }
    return problem_of_text(after);
  }
  const std::string& text() const { return emission_.text; }

 private:
  bool given_up(std::uint32_t i) const {
    for (const auto& n : emission_.not_made)
      if (n.move == i) return true;
    return false;
  }

  std::string problem_of_move(const Read& after, std::uint32_t i) const {
    const Move &old = before_.moves.moves[i], &now = after.moves.moves[i];
    if (now.kind != old.kind) return "another kind of move";
    if (after.moves.state_of(now) != before_.moves.state_of(old)) return "another modal state";
    if (std::abs(now.feed_mm_per_s - old.feed_mm_per_s) > 1e-9 + 2e-3 * old.feed_mm_per_s) return "another feed";
    if (now.exact_stop != old.exact_stop) return "another stop at its end";
    if (old.arc != Move::kNoArc &&
        std::abs(after.moves.arcs[now.arc].sweep_rad - before_.moves.arcs[old.arc].sweep_rad) > kPi)
      return "the arc goes the other way round";
    // Rapids do not come back by themselves, and a full turn ends where it starts.
    if (!editable(old) || given_up(i) || is_full_turn(before_, old)) return {};
    const Vec3 wanted = i == edit_.move ? *edit_.end_mm : old.end_mm;
    const double away = (now.end_mm - wanted).cwiseAbs().maxCoeff();
    return away > tolerance_mm(before_, old) ? fmt::format("ends {:.6f} mm from where it should", away) : "";
  }

  /// A line differs only where the emitted program comes to it at another place, and then in its coordinates only.
  std::string problem_of_text(const Read& after) const {
    const auto old = lines_of(before_.program.source.text()), now = lines_of(emission_.text);
    if (old.size() != now.size()) return "another number of lines";
    std::vector<bool> may_differ(old.size(), false);
    may_differ[before_.moves.moves[edit_.move].block] = true;
    for (std::size_t i = 0; i < before_.moves.moves.size(); ++i)
      if ((before_.moves.moves[i].start_mm - after.moves.moves[i].start_mm).cwiseAbs().maxCoeff() > 1e-9)
        may_differ[before_.moves.moves[i].block] = true;
    for (std::size_t line = 0; line < old.size(); ++line) {
      if (old[line] == now[line]) continue;
      if (!may_differ[line]) return fmt::format("line {} changed without need", line + 1);
      if (frame_of(old[line], true) != frame_of(now[line], true))
        return fmt::format("line {} is now {}", line + 1, now[line]);
    }
    return {};
  }

  const Read& before_;
  const MoveEdit& edit_;
  Emission emission_;
};

std::vector<std::uint32_t> editable_moves(const Read& r, bool lines_only) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < r.moves.moves.size(); ++i) {
    const Move& m = r.moves.moves[i];
    if (editable(m) && !is_full_turn(r, m) && (!lines_only || m.kind == MoveKind::linear)) out.push_back(i);
  }
  return out;
}

/// Up to a fifth of a millimetre, or a few steps of the last decimal.
Vec3 random_shift() {
  Vec3 shift;
  const double step_mm = *rc::gen::element(1e-4, 1e-6);
  for (int axis = 0; axis < 3; ++axis)
    shift[axis] = *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(-2000, 2001)) * step_mm + 1e-5;
  return shift;
}

/// Lines through two more points: they are passed in order, and everything else is as it was.
std::string problem_of_via(const Read& r, const MoveEdit& edit) {
  const Emission emission = emit_edits(r.program, r.moves, std::span(&edit, 1), {});
  if (!emission.not_made.empty()) return "not made: " + to_string(emission.not_made.front().why);
  const Read after = read_again(r, emission.text);
  for (const auto& m : after.messages)
    if (m.find("error") != std::string::npos) return m;
  const std::size_t more = edit.via.size();
  const auto &old = r.moves.moves, &now = after.moves.moves;
  if (now.size() != old.size() + more) return fmt::format("{} moves instead of {}", now.size(), old.size() + more);
  const Move& whole = old[edit.move];
  const double near = tolerance_mm(r, whole);
  for (std::size_t i = 0; i <= more; ++i) {
    const Move& piece = now[edit.move + i];
    const Vec3 wanted = i < more ? edit.via[i].point_mm : *edit.end_mm;
    if ((piece.end_mm - wanted).cwiseAbs().maxCoeff() > near) return fmt::format("via point {} is missed", i);
    if (after.moves.state_of(piece) != r.moves.state_of(whole)) return fmt::format("piece {} in another state", i);
    if (std::abs(piece.feed_mm_per_s - whole.feed_mm_per_s) > 1e-9) return fmt::format("piece {} at another feed", i);
    if (piece.exact_stop != (i == more && whole.exact_stop)) return fmt::format("piece {} stops otherwise", i);
  }
  for (std::size_t i = edit.move + 1; i < old.size(); ++i) {
    if (after.moves.state_of(now[i + more]) != r.moves.state_of(old[i])) return "another state behind the edit";
    if (!editable(old[i]) || is_full_turn(r, old[i])) continue;
    bool given_up = false;
    for (const auto& n : emission.not_made) given_up = given_up || n.move == i;
    if (!given_up && (now[i + more].end_mm - old[i].end_mm).cwiseAbs().maxCoeff() > tolerance_mm(r, old[i]))
      return fmt::format("move {} of line {} ends elsewhere", i, old[i].block + 1);
  }
  return {};
}

class NcEmitProperty : public testing::Test {
 protected:
  void TearDown() override { counts_.print(testing::UnitTest::GetInstance()->current_test_info()->name()); }
  Counts counts_;
};

TEST_F(NcEmitProperty, RandomProgramsComeOutByteForByte) {
  EXPECT_TRUE(rc::check([&] {
    const std::string text = tests::text_of(*tests::random_program(60));
    const Read r = read_text(text);
    RC_ASSERT(r.messages == std::vector<std::string>{});
    RC_ASSERT(emit(r.program, r.moves, {}, {}) == text);
    ++counts_.programs;
    counts_.moves += r.moves.moves.size();
  }));
  EXPECT_GT(counts_.moves, 2000u);
}

TEST_F(NcEmitProperty, OneEditOfARandomProgramChangesNoMoreThanItMust) {
  EXPECT_TRUE(rc::check([&] {
    const std::string text = tests::text_of(*tests::random_program(40));
    const Read r = read_text(text);
    RC_ASSERT(r.messages == std::vector<std::string>{});
    const auto moves = editable_moves(r, false);
    RC_PRE(!moves.empty());
    ++counts_.programs;
    counts_.moves += r.moves.moves.size();
    for (int i = 0; i < 3; ++i) {
      const MoveEdit edit = shifted(r, *rc::gen::elementOf(moves), random_shift(), *rc::gen::element(0.0, 0.5));
      const OneEdit one(r, edit);
      const std::string problem = one.problem(counts_);
      if (!problem.empty()) RC_LOG() << text << "--- line " << r.moves.moves[edit.move].block + 1 << "\n" << one.text();
      RC_ASSERT(problem == "");
    }
  }));
  EXPECT_GT(counts_.edits, 100u);
  EXPECT_LT(counts_.edits_not_made, counts_.edits / 10);
}

TEST_F(NcEmitProperty, ViaPointsArePassedInOrder) {
  EXPECT_TRUE(rc::check([&] {
    const std::string text = tests::text_of(*tests::random_program(40));
    const Read r = read_text(text);
    const auto moves = editable_moves(r, true);
    RC_PRE(!moves.empty());
    ++counts_.programs;
    counts_.moves += r.moves.moves.size();
    const std::uint32_t m = *rc::gen::elementOf(moves);
    const Move& move = r.moves.moves[m];
    RC_PRE(length_mm(r.moves, move) > 0.1);
    MoveEdit edit = shifted(r, m, random_shift());
    for (const double u : {0.3, 0.6}) edit.via.push_back({point_at(r.moves, move, u) + random_shift()});
    ++counts_.edits;
    counts_.via_points += edit.via.size();
    const std::string problem = problem_of_via(r, edit);
    if (!problem.empty())
      RC_LOG() << text << "--- line " << move.block + 1 << "\n" << emit(r.program, r.moves, std::span(&edit, 1), {});
    RC_ASSERT(problem == "");
  }));
  EXPECT_GT(counts_.via_points, 100u);
}

/// Every program of tests/data that reads without an error, of CAM systems and others.
std::map<std::string, Read> real_programs() {
  std::map<std::string, Read> out;
  for (const char* folder : {"nc", "linuxcnc/programs", "nist"})
    for (const auto& file : tests::data_files(folder)) {
      if (!file.ends_with(".nc") && std::string_view(folder) == "nist") continue;
      Read r = read_text(SourceText::read(file).text());
      if (r.diagnostics.has_errors() || r.moves.moves.empty()) continue;
      out.emplace(file, std::move(r));
    }
  return out;
}

TEST_F(NcEmitProperty, RealProgramsComeOutByteForByte) {
  const auto programs = real_programs();
  for (const auto& [file, r] : programs) {
    EXPECT_TRUE(emit(r.program, r.moves, {}, {}) == r.program.source.text()) << file;
    ++counts_.programs;
    counts_.moves += r.moves.moves.size();
  }
  EXPECT_GE(programs.size(), 15u);
}

TEST_F(NcEmitProperty, OneEditOfARealProgramChangesNoMoreThanItMust) {
  const auto programs = real_programs();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-0.05, 0.05);
  for (const auto& [file, r] : programs) {
    const auto moves = editable_moves(r, false), lines = editable_moves(r, true);
    if (moves.empty()) continue;
    ++counts_.programs;
    counts_.moves += r.moves.moves.size();
    for (int i = 0; i < 10; ++i) {
      const MoveEdit edit = shifted(r, moves[random() % moves.size()], {u(random), u(random), u(random)});
      EXPECT_EQ(OneEdit(r, edit).problem(counts_), "") << file << ":" << r.moves.moves[edit.move].block + 1;
    }
    for (int i = 0; i < 10 && !lines.empty(); ++i) {
      const std::uint32_t m = lines[random() % lines.size()];
      if (length_mm(r.moves, r.moves.moves[m]) < 0.5) continue;
      MoveEdit edit = shifted(r, m, {u(random), u(random), u(random)});
      for (const double fraction : {0.3, 0.6})
        edit.via.push_back({point_at(r.moves, r.moves.moves[m], fraction) + Vec3(u(random), u(random), u(random))});
      counts_.via_points += 2;
      EXPECT_EQ(problem_of_via(r, edit), "") << file << ":" << r.moves.moves[m].block + 1;
    }
  }
}

}  // namespace
}  // namespace camber::nc
