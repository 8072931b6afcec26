// The same geometry written in ISO G code and for a Sinumerik gives the same moves, also after edits.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include <fmt/format.h>

#include "nc/emit.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

/// Writes one program in both languages.
class TwinWriter {
 public:
  /// `plain`: every move has words of its own in both languages.
  TwinWriter(unsigned seed, bool plain) : random_(seed), plain_(plain) {
    add("G21 G17 G90 G94 G40 G80", "G710 G17 G90 G94 G40");
    add("G54", "G54");
    add("T1 M6", "T1 M6");
    add("S3000 M3", "S3000 M3");
    add("G0 X0. Y0. Z20.", "G0 X0 Y0 Z20");
    add("G1 F500.", "G1 F500");
  }

  void write(int parts, bool tilt) {
    for (int i = 0; i < parts; ++i) {
      switch (pick(9)) {
        case 0:
          line(true);
          break;
        case 1:
          line(false);
          break;
        case 2:
          arc();
          break;
        case 3:
          quarter();
          break;
        case 4:
          increments();
          break;
        case 5:
          subprogram();
          break;
        case 6:
          holes();
          break;
        case 7:
          frame();
          break;
        default:
          if (!plain_) polar();
      }
    }
    if (tilt) tilted();
    add("M30", "M30");
    iso += subs_iso_ + "%\n";
    own += subs_own_;
  }

  std::string iso = "%\nO0001\n", own = "%_N_TWIN_MPF\n";

 private:
  int pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  double number(double low, double high) {
    const int steps = static_cast<int>((high - low) * 1000);
    return low + pick(steps + 1) / 1000.0;
  }
  static std::string text(double v) { return fmt::format("{:.3f}", v == 0 ? 0.0 : v); }
  void add(const std::string& iso_line, const std::string& own_line) {
    iso += iso_line + "\n";
    own += (pick(4) == 0 ? fmt::format("N{} ", 10 * ++number_) : "") + own_line + (pick(6) == 0 ? " ; comment" : "") +
           "\n";
  }
  /// X12.5, X=12.5, X=AC(12.5), X=10+2.5.
  std::string word(char letter, double value) {
    switch (plain_ ? pick(2) : pick(8)) {
      case 0:
        return fmt::format("{}={}", letter, text(value));
      case 1:
        return fmt::format("{}=AC({})", letter, text(value));
      case 2:
        return fmt::format("{}={}*2", letter, fmt::format("{:.4f}", value / 2));
      default:
        return letter + text(value);
    }
  }
  std::string axes(const Vec3& p, bool plain) {
    return fmt::format("{} {} {}", plain ? "X" + text(p.x()) : word('X', p.x()),
                       plain ? "Y" + text(p.y()) : word('Y', p.y()), plain ? "Z" + text(p.z()) : word('Z', p.z()));
  }
  Vec3 place() { return {number(-50, 50), number(-50, 50), number(-20, 20)}; }

  void line(bool rapid) {
    at_ = place();
    const std::string g = rapid ? "G0 " : "G1 ", feed = rapid || pick(2) ? "" : fmt::format(" F{}", 100 + pick(900));
    add(g + axes(at_, true) + feed, g + axes(at_, false) + feed);
  }

  /// An arc or a helix in one of the planes, by its centre or radius; ends rounded to a micrometre.
  void arc() {
    const int plane = pick(3),
              first = plane == 0   ? 0
                      : plane == 1 ? 2
                                   : 1,
              second = plane == 0   ? 1
                       : plane == 1 ? 0
                                    : 2,
              normal = 3 - first - second;
    const double radius = number(3, 20), from = number(0, 360) * kPi / 180, sweep = number(20, 340) * kPi / 180;
    const bool clockwise = pick(2) == 0, by_radius = pick(3) == 0;
    const int turns = by_radius ? 0 : pick(3);
    const auto rounded = [](double v) { return std::round(v * 1000) / 1000; };
    Vec3 centre = at_, end = at_;
    centre[first] = rounded(at_[first] + radius * std::cos(from));
    centre[second] = rounded(at_[second] + radius * std::sin(from));
    const double dx = at_[first] - centre[first], dy = at_[second] - centre[second], s = clockwise ? -sweep : sweep;
    end[first] = rounded(centre[first] + dx * std::cos(s) - dy * std::sin(s));
    end[second] = rounded(centre[second] + dx * std::sin(s) + dy * std::cos(s));
    if (pick(2) || turns > 0) end[normal] = rounded(at_[normal] + number(-3, 3));
    const std::string g = clockwise ? "G2 " : "G3 ";
    const char c1 = "IJK"[first], c2 = "IJK"[second];
    add(fmt::format("G{}", plane == 0   ? 17
                           : plane == 1 ? 18
                                        : 19),
        fmt::format("G{}", plane == 0   ? 17
                           : plane == 1 ? 18
                                        : 19));
    if (by_radius) {
      const double r = (sweep > kPi ? -1 : 1) * std::hypot(dx, dy);
      add(g + axes(end, true) + fmt::format(" R{:.6f}", r), g + axes(end, true) + fmt::format(" CR={:.6f}", r));
    } else {
      const std::string relative = fmt::format(" {}{} {}{}", c1, text(-dx), c2, text(-dy));
      const std::string absolute =
          fmt::format(" {}=AC({}) {}=AC({})", c1, text(centre[first]), c2, text(centre[second]));
      add(g + axes(end, true) + relative + (turns > 0 ? fmt::format(" P{}", turns + 1) : ""),
          g + axes(end, pick(2) == 0) + (pick(2) ? relative : absolute) +
              (turns > 0 ? fmt::format(" TURN={}", turns) : ""));
    }
    at_ = end;
    add("G17", "G17");
  }

  /// A quarter turn between places with whole coordinates: CIP, CT and AR lead to the same arc.
  void quarter() {
    const double r = number(2, 15);
    Vec3 start(number(-40, 40), number(-40, 40), at_.z());
    add("G0 X" + text(start.x()) + " Y" + text(start.y()), "G0 X" + text(start.x()) + " Y" + text(start.y()));
    add("G1 X" + text(start.x() + 5), "G1 X" + text(start.x() + 5));
    start.x() += 5;
    const Vec3 end(start.x() + r, start.y() + r, start.z());
    const std::string to = "X" + text(end.x()) + " Y" + text(end.y());
    const std::string iso_line = "G3 " + to + " I0. J" + text(r);
    switch (plain_ ? 4 : pick(4)) {
      case 4:
        add(iso_line, fmt::format("G3 {} I0 J{}", to, text(r)));
        break;
      case 0:
        add(iso_line, fmt::format("CIP {} I1={}+{}*SIN(45) J1={}+{}-{}*COS(45)", to, text(start.x()), text(r),
                                  text(start.y()), text(r), text(r)));
        break;
      case 1:
        add(iso_line, "CT " + to);
        break;
      case 2:
        add(iso_line, "G3 " + to + " AR=90");
        break;
      default:
        add(iso_line, "G3 I0 J" + text(r) + " AR=90");
        break;
    }
    at_ = end;
    add("G1 X" + text(at_.x()), "G1 X" + text(at_.x()));
  }

  void increments() {
    const Vec3 by(number(-5, 5), number(-5, 5), number(-2, 2));
    at_ += by;
    if (pick(2)) {
      add("G91 G1 " + axes(by, true), "G91 G1 " + axes(by, true));
      add("G90", "G90");
    } else {
      add("G91 G1 " + axes(by, true) + "\nG90",
          fmt::format("G1 X=IC({}) Y=IC({}) Z=IC({})", text(by.x()), text(by.y()), text(by.z())));
    }
  }

  void subprogram() {
    const int runs = 1 + pick(3), number = ++subs_;
    const Vec3 by(this->number(-3, 3), this->number(-3, 3), 0);
    subs_iso_ +=
        fmt::format("O{}\nG91 G1 X{} Y{}\nX{} Y1.\nG90\nM99\n", 100 + number, text(by.x()), text(by.y()), text(by.y()));
    subs_own_ += fmt::format("%_N_SUB{}_SPF\nN10 G91 G1 X{} Y{}\nN20 X{} Y1\nN30 G90\nN40 {}\n", number, text(by.x()),
                             text(by.y()), text(by.y()), pick(2) ? "M17" : "RET");
    add(fmt::format("M98 P{} L{}", 100 + number, runs),
        fmt::format("SUB{}{}", number, runs > 1 || pick(2) ? fmt::format(" P{}", runs) : ""));
    at_ += runs * Vec3(by.x() + by.y(), by.y() + 1, 0);
  }

  void holes() {
    const double level = std::max(at_.z(), 25.0) + 1, reference = number(-5, 5), depth = reference - number(1, 20);
    add("G0 Z" + text(level), "G0 Z" + text(level));
    const bool pecks = pick(2) == 0;
    const double safety = pecks ? 0 : number(1, 3), peck = number(1, 5);
    const Vec3 a = place(), b = place();
    add(fmt::format("G98 G{} X{} Y{} Z{} R{}{} F120.", pecks ? 83 : 81, text(a.x()), text(a.y()), text(depth),
                    text(reference + safety), pecks ? " Q" + text(peck) : ""),
        fmt::format("F120\nMCALL {}\nX{} Y{}",
                    pecks
                        ? fmt::format("CYCLE83({},{},0,{},,,{},0,,0,1,1,,,,,0.6)", text(level), text(reference),
                                      text(depth), text(peck))
                        : fmt::format("CYCLE81({},{},{},{})", text(level), text(reference), text(safety), text(depth)),
                    text(a.x()), text(a.y())));
    add("X" + text(b.x()) + " Y" + text(b.y()), "X" + text(b.x()) + " Y" + text(b.y()));
    add("G80", "MCALL");
    at_ = {b.x(), b.y(), level};
  }

  void frame() {
    const Vec3 shift = place();
    const double angle = number(-180, 180);
    const bool mirrored = pick(2) == 0;
    add(fmt::format("G52 X{} Y{} Z{}\nG68 X0. Y0. R{}", text(shift.x()), text(shift.y()), text(shift.z()), text(angle)),
        fmt::format("TRANS X{} Y{} Z{}\nAROT {}{}", text(shift.x()), text(shift.y()), text(shift.z()),
                    pick(2) ? "RPL=" : "Z", text(angle)));
    if (mirrored) add("G51.1 X0.", "AMIRROR X0");
    line(true);
    line(false);
    arc();
    increments();
    subprogram();
    if (mirrored) add("G50.1 X0.", "; back");
    add("G69\nG52 X0. Y0. Z0.", "TRANS");
    line(true);
  }

  void polar() {
    const double radius = number(5, 30), angle = number(-170, 170);
    add(fmt::format("G16\nG1 X{} Y{}\nG15", text(radius), text(angle)),
        fmt::format("G111 X0 Y0\nG1 AP={} RP={}", text(angle), text(radius)));
    at_.x() = radius * std::cos(angle * kPi / 180);
    at_.y() = radius * std::sin(angle * kPi / 180);
    line(false);
  }

  void tilted() {
    const Vec3 p = place();
    const double about_z = number(-90, 90), about_x = number(-60, 60);
    add(fmt::format("G68.2 X{} Y{} Z{} I{} J{} K0.\nG53.1", text(p.x()), text(p.y()), text(p.z()), text(about_z),
                    text(about_x)),
        fmt::format("CYCLE800(0,\"TABLE\",0,39,{},{},{},{},{},0,0,0,0,1)", text(p.x()), text(p.y()), text(p.z()),
                    text(about_z), text(about_x)));
    line(true);
    line(false);
    arc();
    increments();
    subprogram();
  }

  std::mt19937 random_;
  bool plain_;
  Vec3 at_ = Vec3(0, 0, 20);
  int number_ = 0, subs_ = 0;
  std::string subs_iso_, subs_own_;
};

InterpreterOptions options_of(bool tilt, std::string_view dialect) {
  InterpreterOptions options = as(dialect);
  options.peck_clearance_mm = 0.6;
  if (tilt) options.rotary_axes = {{.letter = 'A'}, {.letter = 'C'}};
  return options;
}

/// Empty where the moves are the same.
std::string difference(const Interpretation& a, const Interpretation& b, double of_centres) {
  if (a.moves.size() != b.moves.size()) return fmt::format("{} moves and {}", a.moves.size(), b.moves.size());
  for (std::size_t i = 0; i < a.moves.size(); ++i) {
    const Move &m = a.moves[i], &n = b.moves[i];
    if (m.kind != n.kind) return fmt::format("kind of move {}", i);
    if ((m.start_mm - n.start_mm).norm() > 1e-9 || (m.end_mm - n.end_mm).norm() > 1e-9)
      return fmt::format("place of move {}: {:g}", i, (m.end_mm - n.end_mm).norm());
    if (std::abs(m.feed_mm_per_s - n.feed_mm_per_s) > 1e-9)
      return fmt::format("feed of move {}: {} and {}", i, m.feed_mm_per_s, n.feed_mm_per_s);
    if (m.arc == Move::kNoArc) continue;
    const Arc &p = a.arcs[m.arc], &q = b.arcs[n.arc];
    if ((p.center_mm - q.center_mm).norm() > of_centres || (p.normal - q.normal).norm() > 1e-9 ||
        std::abs(p.sweep_rad - q.sweep_rad) > of_centres)
      return fmt::format("arc of move {}: {:g} {:g}", i, (p.center_mm - q.center_mm).norm(), p.sweep_rad - q.sweep_rad);
  }
  return {};
}

/// New ends for some of the moves that both texts say alone.
std::vector<MoveEdit> edits_for(const Interpretation& iso, const Interpretation& own, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<MoveEdit> edits;
  for (std::size_t i = 0; i < iso.moves.size(); ++i) {
    const Move &m = iso.moves[i], &n = own.moves[i];
    if (!m.editable || !n.editable || m.canned || n.canned || m.kind == MoveKind::dwell || m.kind == MoveKind::rapid ||
        random() % 3 != 0)
      continue;
    const Vec3 by(static_cast<int>(random() % 41) * 0.001 - 0.02, static_cast<int>(random() % 41) * 0.001 - 0.02,
                  static_cast<int>(random() % 41) * 0.001 - 0.02);
    MoveEdit edit{.move = static_cast<std::uint32_t>(i), .end_mm = m.end_mm + by};
    if (m.arc != Move::kNoArc)
      edit.center_mm = iso.arcs[m.arc].center_mm + by / 2;
    else if (random() % 3 == 0)
      edit.via = {{0.5 * (m.start_mm + m.end_mm) + by}};
    if (random() % 4 == 0 && m.kind == MoveKind::linear) edit.feed_mm_per_s = m.feed_mm_per_s * 0.8;
    edits.push_back(edit);
  }
  return edits;
}

class SiemensRandom : public ::testing::TestWithParam<int> {};

TEST_P(SiemensRandom, ProgramsHaveTheMovesOfTheirTwinsInIsoAlsoWhenEdited) {
  for (int k = 0; k < 50; ++k) {
    const unsigned seed = static_cast<unsigned>(1000 * GetParam() + k);
    const bool tilt = k % 5 == 0;
    const bool plain = k % 2 == 0;
    TwinWriter twin(seed, plain);
    twin.write(12, tilt);
    const Read iso = read_text(twin.iso, options_of(tilt, "fanuc")),
               own = read_text(twin.own, options_of(tilt, "siemens"), "twin.mpf");
    for (const Read* r : {&iso, &own})
      for (const std::string& message : r->messages)
        ASSERT_EQ(message.find("error"), std::string::npos) << message << "\n" << (r == &iso ? twin.iso : twin.own);
    ASSERT_EQ(difference(iso.moves, own.moves, 1e-9), "") << seed << "\n" << twin.iso << "\n" << twin.own;
    ASSERT_EQ(emit(own.program, own.moves, {}, {}), twin.own);
    if (tilt || !plain) continue;
    const auto edits = edits_for(iso.moves, own.moves, seed);
    const Emission of_iso = emit_edits(iso.program, iso.moves, edits, {}),
                   of_own = emit_edits(own.program, own.moves, edits, {});
    ASSERT_EQ(of_iso.not_made.size(), of_own.not_made.size());
    const Read iso2 = read_text(of_iso.text, options_of(tilt, "fanuc")),
               own2 = read_text(of_own.text, options_of(tilt, "siemens"), "twin.mpf");
    for (const std::string& message : own2.messages)
      ASSERT_EQ(message.find("error"), std::string::npos) << message << "\n" << of_own.text;
    ASSERT_EQ(difference(iso2.moves, own2.moves, 5e-4), "") << seed << "\n"
                                                            << twin.own << "\n"
                                                            << of_own.text << "\n"
                                                            << of_iso.text;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, SiemensRandom, ::testing::Range(0, 4));

}  // namespace
}  // namespace camber::nc
