// Random programs that say the same in ISO and in Klartext: the same moves, also after edits of both.
#include <random>

#include <fmt/format.h>

#include "nc/emit.h"
#include "nc/language.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

/// Writes both texts. Positions are in units of 0.001 mm, so that both say the same numbers.
class Twins {
 public:
  explicit Twins(unsigned seed) : random_(seed) {
    numbered_ = seed % 3 != 0;
    iso_ = "%\nO1\nG21 G90 G94 G17\nT1 M6\nS2000 M3\n";
    line("BEGIN PGM TWIN MM");
    line("TOOL CALL 1 Z S2000");
    line("M3");
    both("G0 X0 Y0 Z20", "L X+0 Y+0 Z+20 R0 FMAX");
    place_ = {0, 0, 20000};
  }

  void run(int blocks, bool tilt = false) {
    for (int i = 0; i < blocks; ++i) block();
    if (tilt) tilted();
    both("G0 Z50", "L Z+50 FMAX");
    iso_ += "M30\n" + iso_subs_ + "%\n";
    line("M30");
    for (const std::string& l : klartext_subs_) line(l);
    line("END PGM TWIN MM");
  }

  const std::string& iso() const { return iso_; }
  const std::string& klartext() const { return klartext_; }
  bool frames() const { return frames_; }

 private:
  using Place = std::array<int, 3>;

  int pick(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
  static std::string mm(int um, bool sign) {
    std::string out = fmt::format("{}{}.{:03}",
                                  um < 0 ? "-"
                                  : sign ? "+"
                                         : "",
                                  std::abs(um) / 1000, std::abs(um) % 1000);
    return out;
  }
  void line(const std::string& text) { klartext_ += (numbered_ ? fmt::format("{} ", number_++) : "") + text + "\n"; }
  void both(const std::string& iso, const std::string& klartext) {
    iso_ += iso + "\n";
    line(klartext);
  }

  void block() {
    switch (pick(0, 11)) {
      case 0:
        return straight(true);
      case 1:
        return arc_by_centre();
      case 2:
        return arc_by_radius();
      case 3:
        return helix();
      case 4:
        return steps();
      case 5:
        return subprogram();
      case 6:
        return holes();
      case 7:
        return frame();
      case 8:
        return dwell();
      case 9:
        return polar();
      default:
        return straight(false);
    }
  }

  std::string feed() {
    if (!new_feed_) return {};
    return fmt::format(" F{}", feed_);
  }
  void choose_feed() {
    new_feed_ = feed_ == 0 || pick(0, 3) == 0;
    if (new_feed_) feed_ = pick(1, 40) * 50;
  }

  void straight(bool rapid) {
    if (rapid)
      new_feed_ = false;
    else
      choose_feed();
    std::string iso = rapid ? "G0" : "G1", klartext = "L";
    bool any = false;
    for (int a = 0; a < 3; ++a) {
      if (pick(0, 2) == 0 && !(a == 2 && !any)) continue;
      any = true;
      place_[static_cast<std::size_t>(a)] = pick(-40000, 40000);
      iso += fmt::format(" {}{}", "XYZ"[a], mm(place_[static_cast<std::size_t>(a)], false));
      klartext += fmt::format(" {}{}", "XYZ"[a], mm(place_[static_cast<std::size_t>(a)], true));
    }
    both(iso + feed(), klartext + (rapid ? " FMAX" : feed()));
  }

  /// In the plane of two axes: a quarter, a half, three quarters or all of a circle with a corner of a square.
  void arc_by_centre(int last_plane = 2) {
    if (feed_ == 0) return;
    choose_feed();
    const int plane = pick(0, last_plane);  // XY, ZX, YZ
    const int first = plane == 0 ? 0 : plane == 1 ? 2 : 1, second = plane == 0 ? 1 : plane == 1 ? 0 : 2;
    const int i = pick(-9000, 9000), j = pick(-9000, 9000), quarters = pick(1, 4);
    const bool ccw = pick(0, 1) == 1;
    if (i == 0 && j == 0) return;
    const int cx = at(first) + i, cy = at(second) + j;
    int x = -i, y = -j;
    for (int q = 0; q < quarters; ++q) {
      const int old = x;
      x = ccw ? -y : y;
      y = ccw ? old : -old;
    }
    constexpr const char* kPlanes[] = {"G17", "G18", "G19"};
    std::string iso = fmt::format("{} {}", kPlanes[plane], ccw ? "G3" : "G2"), klartext = "C";
    Place end = place_;
    end[static_cast<std::size_t>(first)] = cx + x;
    end[static_cast<std::size_t>(second)] = cy + y;
    for (int a = 0; a < 3; ++a) {
      if (a != first && a != second) continue;
      iso += fmt::format(" {}{}", "XYZ"[a], mm(end[static_cast<std::size_t>(a)], false));
      klartext += fmt::format(" {}{}", "XYZ"[a], mm(end[static_cast<std::size_t>(a)], true));
    }
    iso += fmt::format(" {}{} {}{}", "IJK"[first], mm(i, false), "IJK"[second], mm(j, false));
    const auto [a, b] = std::minmax(first, second);
    line(fmt::format("CC {}{} {}{}", "XYZ"[a], mm(a == first ? cx : cy, true), "XYZ"[b],
                     mm(b == first ? cx : cy, true)));
    place_ = end;
    both(iso + feed(), klartext + (ccw ? " DR+" : " DR-") + feed());
    iso_ += "G17\n";
  }

  void arc_by_radius() {
    if (feed_ == 0) return;
    choose_feed();
    const int dx = pick(-8000, 8000), dy = pick(-8000, 8000);
    const double half = 0.5 * std::hypot(dx, dy);
    if (half < 500) return;
    const int r = static_cast<int>(half) + pick(100, 20000);
    const bool ccw = pick(0, 1) == 1, large = pick(0, 3) == 0;
    place_[0] += dx;
    place_[1] += dy;
    both(fmt::format("{} X{} Y{} R{}", ccw ? "G3" : "G2", mm(place_[0], false), mm(place_[1], false),
                     mm(large ? -r : r, false)) +
             feed(),
         fmt::format("CR X{} Y{} R{} DR{}", mm(place_[0], true), mm(place_[1], true), mm(large ? -r : r, true),
                     ccw ? "+" : "-") +
             feed());
  }

  /// Quarters of a turn, up to three turns.
  void helix() {
    if (feed_ == 0) return;
    const int i = pick(1000, 9000), quarters = pick(1, 12), dz = pick(-3000, 3000);
    const bool ccw = pick(0, 1) == 1;
    const int cx = place_[0] - i, cy = place_[1];
    int x = i, y = 0;
    for (int q = 0; q < quarters; ++q) {
      const int old = x;
      x = ccw ? -y : y;
      y = ccw ? old : -old;
    }
    place_ = {cx + x, cy + y, place_[2] + dz};
    const int turns = (quarters + 3) / 4;
    line(fmt::format("CC X{} Y{}", mm(cx, true), mm(cy, true)));
    both(fmt::format("{} X{} Y{} Z{} I{} J0 P{}", ccw ? "G3" : "G2", mm(place_[0], false), mm(place_[1], false),
                     mm(place_[2], false), mm(-i, false), turns),
         fmt::format("CP IPA{}{} {} DR{}", ccw ? "+" : "-", 90 * quarters,
                     pick(0, 1) == 0 ? "IZ" + mm(dz, true) : "Z" + mm(place_[2], true), ccw ? "+" : "-"));
  }

  void steps() {
    if (feed_ == 0) return;
    const Place by{pick(-5000, 5000), pick(-5000, 5000), pick(-2000, 2000)};
    for (int a = 0; a < 3; ++a) place_[static_cast<std::size_t>(a)] += by[static_cast<std::size_t>(a)];
    both(fmt::format("G91 G1 X{} Y{} Z{}", mm(by[0], false), mm(by[1], false), mm(by[2], false)),
         fmt::format("L IX{} IY{} IZ{}", mm(by[0], true), mm(by[1], true), mm(by[2], true)));
    iso_ += "G90\n";
  }

  /// A shape of steps, run once to three times.
  void subprogram() {
    if (feed_ == 0) return;
    const int number = ++subs_, times = pick(1, 3);
    const int dx = pick(-5000, 5000), dy = pick(-5000, 5000);
    iso_subs_ += fmt::format("O{}\nG91 G1 X{}\nY{}\nG90 M99\n", 100 + number, mm(dx, false), mm(dy, false));
    klartext_subs_.insert(klartext_subs_.end(),
                          {fmt::format("LBL {}", number), "L IX" + mm(dx, true), "L IY" + mm(dy, true), "LBL 0"});
    iso_ += fmt::format("M98 P{} L{}\n", 100 + number, times);
    for (int i = 0; i < times; ++i) line(fmt::format("CALL LBL {}", number));
    place_[0] += times * dx;
    place_[1] += times * dy;
  }

  void holes() {
    const int count = pick(1, 3), depth = -pick(1000, 12000), feed = pick(1, 20) * 20;
    const int top = pick(-5000, 5000), clearance = pick(500, 3000);
    place_[2] = top + clearance + pick(0, 10000);
    both(fmt::format("G0 Z{}", mm(place_[2], false)), fmt::format("L Z{} FMAX", mm(place_[2], true)));
    const int second = pick(0, 1) == 0 ? clearance : clearance + 2000;
    line("CYCL DEF 200 DRILLING ~");
    for (const auto& [q, v] : {std::pair(200, mm(clearance, true)),
                               {201, mm(depth, true)},
                               {206, fmt::format("+{}", feed)},
                               {202, mm(-depth, true)},
                               {210, std::string("+0")},
                               {203, mm(top, true)},
                               {204, mm(second, true)},
                               {211, std::string("+0")}})
      klartext_ += fmt::format("   Q{}={} ;TEXT{}\n", q, v, q == 211 ? "" : " ~");
    for (int i = 0; i < count; ++i) {
      place_[0] = pick(-40000, 40000);
      place_[1] = pick(-40000, 40000);
      const std::string xy = fmt::format("X{} Y{}", mm(place_[0], false), mm(place_[1], false));
      iso_ += "G0 " + xy + "\n";
      // To the clearance and no higher, or to the second one.
      iso_ += fmt::format("{} G81 Z{} R{} F{}\nG80\n", "G99", mm(top + depth, false), mm(top + clearance, false), feed);
      iso_ += fmt::format("G0 Z{}\n", mm(top + second, false));
      line(fmt::format("L X{} Y{} FMAX M99", mm(place_[0], true), mm(place_[1], true)));
      place_[2] = top + second;
    }
    new_feed_ = true;
    feed_ = 500;
    place_[2] += 1000;
    both(fmt::format("G1 Z{} F500", mm(place_[2], false)), fmt::format("L Z{} F500", mm(place_[2], true)));
  }

  /// Moves in a frame, which is then taken back.
  void frame() {
    if (feed_ == 0) return;
    frames_ = true;
    const int kind = pick(0, 4), a = pick(-20000, 20000), b = pick(-20000, 20000), angle = pick(-170, 170);
    constexpr const char* kOff[] = {"G52 X0 Y0", "G69", "G50.1", "G50", "G69\nG52 X0 Y0"};
    switch (kind) {
      case 0:
        iso_ += fmt::format("G52 X{} Y{}\n", mm(a, false), mm(b, false));
        line("CYCL DEF 7.0 DATUM SHIFT");
        line("CYCL DEF 7.1 X" + mm(a, true));
        line("CYCL DEF 7.2 Y" + mm(b, true));
        break;
      case 1:
        iso_ += fmt::format("G68 X0 Y0 R{}\n", angle);
        line("CYCL DEF 10.0 ROTATION");
        line(fmt::format("CYCL DEF 10.1 ROT{:+}", angle));
        break;
      case 2:
        iso_ += "G51.1 X0\n";
        line("CYCL DEF 8.0 MIRROR IMAGE");
        line("CYCL DEF 8.1 X");
        break;
      case 4:
        iso_ += fmt::format("G52 X{} Y{}\nG68 X0 Y0 R{}\n", mm(a, false), mm(b, false), angle);
        line(fmt::format("TRANS DATUM AXIS X{} Y{}", mm(a, true), mm(b, true)));
        line(fmt::format("TRANS ROTATION ROT{:+}", angle));
        break;
      default:
        iso_ += "G51 X0 Y0 Z0 P1.5\n";
        line("CYCL DEF 11.0 SCALING");
        line("CYCL DEF 11.1 SCL 1.5");
        break;
    }
    place_ = {pick(-40000, 40000), pick(-40000, 40000), pick(0, 20000)};
    both(fmt::format("G0 X{} Y{} Z{}", mm(place_[0], false), mm(place_[1], false), mm(place_[2], false)),
         fmt::format("L X{} Y{} Z{} FMAX", mm(place_[0], true), mm(place_[1], true), mm(place_[2], true)));
    straight(false);
    arc_by_radius();
    arc_by_centre(0);
    helix();
    steps();
    polar();
    straight(false);
    iso_ += std::string(kOff[kind]) + (kind == 2 ? " X0\n" : "\n");
    switch (kind) {
      case 0:
        line("CYCL DEF 7.0 DATUM SHIFT");
        line("CYCL DEF 7.1 X+0");
        line("CYCL DEF 7.2 Y+0");
        break;
      case 1:
        line("CYCL DEF 10.0 ROTATION");
        line("CYCL DEF 10.1 ROT+0");
        break;
      case 2:
        line("CYCL DEF 8.0 MIRROR IMAGE");
        line("CYCL DEF 8.1");
        break;
      case 4:
        line("TRANS DATUM RESET");
        line("TRANS ROTATION RESET");
        break;
      default:
        line("CYCL DEF 11.0 SCALING");
        line("CYCL DEF 11.1 SCL 1");
        break;
    }
    place_ = {pick(-40000, 40000), pick(-40000, 40000), pick(0, 20000)};
    both(fmt::format("G0 X{} Y{} Z{}", mm(place_[0], false), mm(place_[1], false), mm(place_[2], false)),
         fmt::format("L X{} Y{} Z{} FMAX", mm(place_[0], true), mm(place_[1], true), mm(place_[2], true)));
  }

  void dwell() {
    iso_ += "G4 P500\n";
    line("CYCL DEF 9.0 DWELL TIME");
    line("CYCL DEF 9.1 DWELL 0.5");
  }

  /// A line to a pole's 0, 90, 180 or 270 degrees.
  void polar() {
    if (feed_ == 0) return;
    const int cx = pick(-20000, 20000), cy = pick(-20000, 20000), r = pick(500, 9000), quarter = pick(0, 3);
    constexpr int kX[] = {1, 0, -1, 0}, kY[] = {0, 1, 0, -1};
    place_[0] = cx + kX[quarter] * r;
    place_[1] = cy + kY[quarter] * r;
    line(fmt::format("CC X{} Y{}", mm(cx, true), mm(cy, true)));
    both(fmt::format("G1 X{} Y{}", mm(place_[0], false), mm(place_[1], false)),
         fmt::format("LP PR{} PA{:+}", mm(r, true), 90 * quarter));
  }

  /// A plane by a datum and Euler's angles, and moves in it.
  void tilted() {
    frames_ = true;
    const Place datum{pick(-20000, 20000), pick(-20000, 20000), pick(-9000, 9000)};
    const int precession = pick(-90, 90), nutation = pick(-60, 60), rotation = pick(-90, 90);
    iso_ += fmt::format("G68.2 X{} Y{} Z{} I{} J{} K{}\nG53.1\n", mm(datum[0], false), mm(datum[1], false),
                        mm(datum[2], false), precession, nutation, rotation);
    line("CYCL DEF 7.0 DATUM SHIFT");
    for (int a = 0; a < 3; ++a)
      line(fmt::format("CYCL DEF 7.{} {}{}", a + 1, "XYZ"[a], mm(datum[static_cast<std::size_t>(a)], true)));
    line(fmt::format("PLANE EULER EULPR{:+} EULNU{:+} EULROT{:+} TURN FMAX", precession, nutation, rotation));
    place_ = {pick(-40000, 40000), pick(-40000, 40000), pick(0, 20000)};
    both(fmt::format("G0 X{} Y{} Z{}", mm(place_[0], false), mm(place_[1], false), mm(place_[2], false)),
         fmt::format("L X{} Y{} Z{} FMAX", mm(place_[0], true), mm(place_[1], true), mm(place_[2], true)));
    straight(false);
    arc_by_radius();
    arc_by_centre();
    helix();
    steps();
    polar();
    straight(false);
  }

  int at(int axis) const { return place_[static_cast<std::size_t>(axis)]; }

  std::mt19937 random_;
  std::string iso_, klartext_, iso_subs_;
  std::vector<std::string> klartext_subs_;
  Place place_{};
  int feed_ = 0, number_ = 0, subs_ = 0;
  bool new_feed_ = false, numbered_ = true, frames_ = false;
};

std::vector<const Move*> moves_that_go(const Interpretation& p) {
  std::vector<const Move*> out;
  for (const Move& m : p.moves)
    if (m.kind == MoveKind::arc || m.kind == MoveKind::dwell || (m.start_mm - m.end_mm).norm() > 1e-9)
      out.push_back(&m);
  return out;
}

Read read_klartext(const std::string& text) { return read_text(text, units(), "twin.h"); }

void expect_same_moves(const Interpretation& iso, const Interpretation& klartext, double tolerance_mm) {
  const auto a = moves_that_go(iso), b = moves_that_go(klartext);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    SCOPED_TRACE(fmt::format("move {}, Klartext line {}", i, b[i]->block + 1));
    ASSERT_EQ(a[i]->kind, b[i]->kind);
    if (i > 0) expect_near_mm(b[i]->start_mm, a[i]->start_mm, tolerance_mm);
    expect_near_mm(b[i]->end_mm, a[i]->end_mm, tolerance_mm);
    EXPECT_NEAR(b[i]->feed_mm_per_s, a[i]->feed_mm_per_s, 1e-9);
    EXPECT_NEAR(b[i]->dwell_s, a[i]->dwell_s, 1e-12);
    if (a[i]->arc == Move::kNoArc) continue;
    const Arc &of_a = iso.arcs[a[i]->arc], &of_b = klartext.arcs[b[i]->arc];
    expect_near_mm(of_b.normal * (of_b.sweep_rad < 0 ? -1 : 1), of_a.normal * (of_a.sweep_rad < 0 ? -1 : 1), 1e-9);
    EXPECT_NEAR(std::abs(of_b.sweep_rad), std::abs(of_a.sweep_rad), 1e-9 + tolerance_mm / 0.1);
    for (const double u : {0.25, 0.5, 0.75})
      expect_near_mm(point_at(klartext, *b[i], u), point_at(iso, *a[i], u), 1e-9 + 20 * (tolerance_mm - 1e-9));
  }
}

TEST(KlartextTwins, SayTheSameAsTheirIsoPrograms) {
  std::size_t moves = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Twins twins(seed);
    twins.run(12);
    const Read iso = read_text(twins.iso(), as("fanuc")), klartext = read_klartext(twins.klartext());
    ASSERT_FALSE(iso.diagnostics.has_errors()) << iso.messages.front() << "\n" << twins.iso();
    ASSERT_FALSE(klartext.diagnostics.has_errors()) << klartext.messages.front() << "\n" << twins.klartext();
    expect_same_moves(iso.moves, klartext.moves, 1e-9);
    EXPECT_EQ(emit(klartext.program, klartext.moves, {}, {}), twins.klartext());
    moves += klartext.moves.moves.size();
    if (HasFailure()) {
      ADD_FAILURE() << twins.iso() << "\n" << twins.klartext();
      break;
    }
  }
  std::cout << moves << " moves\n";
}

/// The same on a machine with rotary axes, and at the end in a tilted plane.
void expect_tilted_twins(unsigned from, unsigned to) {
  std::size_t tilted = 0;
  for (unsigned seed = from; seed <= to && !::testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Twins twins(seed);
    twins.run(8, true);
    InterpreterOptions options = as("fanuc");
    options.rotary_axes = {{.letter = 'A'}, {.letter = 'C'}};
    const Read iso = read_text(twins.iso(), options);
    options.dialect = *dialect_named("heidenhain");
    const Read klartext = read_text(twins.klartext(), options, "twin.h");
    ASSERT_FALSE(iso.diagnostics.has_errors()) << iso.messages.front() << "\n" << twins.iso();
    ASSERT_FALSE(klartext.diagnostics.has_errors()) << klartext.messages.front() << "\n" << twins.klartext();
    expect_same_moves(iso.moves, klartext.moves, 1e-9);
    for (const Move& m : klartext.moves.moves)
      tilted += m.arc != Move::kNoArc && klartext.moves.arcs[m.arc].normal.cwiseAbs().maxCoeff() < 0.99;
    if (::testing::Test::HasFailure()) ADD_FAILURE() << twins.iso() << "\n" << twins.klartext();
  }
  EXPECT_GE(tilted, (to - from + 1) / 2);
}

TEST(KlartextTwins, SayTheSameInTiltedPlanes) { expect_tilted_twins(1, 40); }
TEST(KlartextTwinsSlow, SayTheSameInTiltedPlanes) { expect_tilted_twins(41, 240); }

/// Edits of moves whose text stands by itself: new ends, via points, feeds.
std::vector<MoveEdit> edits_of(const Read& r, std::mt19937& random) {
  std::uniform_real_distribution<double> shift(-0.05, 0.05);
  std::vector<MoveEdit> out;
  for (std::uint32_t m = 0; m < r.moves.moves.size(); ++m) {
    const Move& move = r.moves.moves[m];
    if (!move.editable || move.canned || move.reference || random() % 2 == 0) continue;
    if (move.kind != MoveKind::linear && move.kind != MoveKind::arc) continue;
    const bool full = move.kind == MoveKind::arc && (move.start_mm - move.end_mm).norm() < 1e-6;
    if (full) continue;
    MoveEdit edit{.move = m, .end_mm = move.end_mm + Vec3(shift(random), shift(random), shift(random))};
    if (move.arc != Move::kNoArc) {
      edit.center_mm = r.moves.arcs[move.arc].center_mm;
      const Vec3& n = r.moves.arcs[move.arc].normal;
      edit.end_mm = *edit.end_mm - n * n.dot(*edit.end_mm - move.end_mm);
    } else if (random() % 3 == 0) {
      edit.via = {
          {.point_mm = 0.5 * (move.start_mm + *edit.end_mm) + Vec3(shift(random), shift(random), shift(random))}};
    }
    if (random() % 3 == 0 && !move.feed_by_variable) edit.feed_mm_per_s = move.feed_mm_per_s * 0.75;
    out.push_back(edit);
  }
  return out;
}

TEST(KlartextTwins, AreEditedAsAsked) {
  std::size_t edits = 0, not_made = 0;
  for (unsigned seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE(seed);
    Twins twins(seed);
    twins.run(12);
    std::mt19937 random(seed);
    const Read before = read_klartext(twins.klartext());
    ASSERT_FALSE(before.diagnostics.has_errors());
    const std::vector<MoveEdit> wanted = edits_of(before, random);
    const Emission emission = emit_edits(before.program, before.moves, wanted, {.decimals_mm = 4});
    const Read after = read_klartext(emission.text);
    ASSERT_FALSE(after.diagnostics.has_errors()) << after.messages.front() << "\n" << emission.text;
    edits += wanted.size();
    not_made += emission.not_made.size();
    // Moves of the old program by the line that they come from.
    std::size_t m = 0, n = 0, e = 0;
    const auto& old_moves = before.moves.moves;
    const auto& new_moves = after.moves.moves;
    for (; m < old_moves.size(); ++m) {
      const Move& old_move = old_moves[m];
      const MoveEdit* edit = e < wanted.size() && wanted[e].move == m ? &wanted[e++] : nullptr;
      const bool made =
          edit && std::ranges::none_of(emission.not_made, [&](const EditNotMade& g) { return g.move == m; });
      const std::size_t pieces = made ? 1 + edit->via.size() : 1;
      // A piece that rounds to nothing is left out; a step of a cycle that goes nowhere too.
      for (std::size_t i = 0; i < pieces && n < new_moves.size(); ++i, ++n) {
        if (emission.block_of_line[new_moves[n].block] != old_move.block && !old_move.canned) break;
      }
      if (n == 0) break;
      const Move& last = new_moves[n - 1];
      const bool own = emission.block_of_line[last.block] == old_move.block;
      if (!own) {
        ADD_FAILURE() << "move " << m << " of line " << old_move.block + 1 << " is not where it was";
        break;
      }
      const double tolerance = 0.51e-4 * 1.5;  // scale of a frame
      if (made && old_move.kind != MoveKind::arc) expect_near_mm(last.end_mm, *edit->end_mm, tolerance);
      if (made && edit->feed_mm_per_s) {
        EXPECT_NEAR(last.feed_mm_per_s, *edit->feed_mm_per_s, 1e-3 * last.feed_mm_per_s);
      }
      if (!edit && old_move.kind == MoveKind::linear && !old_move.canned && old_move.editable) {
        expect_near_mm(last.end_mm, old_move.end_mm, 1e-4);
        EXPECT_NEAR(last.feed_mm_per_s, old_move.feed_mm_per_s, 1e-9 + 1e-3 * last.feed_mm_per_s);
      }
      if (made && old_move.kind == MoveKind::arc) {
        const Arc &a = before.moves.arcs[old_move.arc], &b = after.moves.arcs[last.arc];
        EXPECT_NEAR(a.sweep_rad, b.sweep_rad, 0.7);
      }
    }
    if (HasFailure()) {
      ADD_FAILURE() << twins.klartext() << "\n---\n" << emission.text;
      break;
    }
  }
  std::cout << edits << " edits, " << not_made << " not made\n";
}

}  // namespace
}  // namespace camber::nc
