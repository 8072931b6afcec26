// camber post in the words of Klartext and Sinumerik controls, against ISO and against the machine.
#include "repath/post/post_processing.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "repath/path_deviation.h"
#include "tests/kinematics/machines.h"
#include "tests/repath/five_axis_program.h"

namespace camber::repath {
namespace {

using kinematics::tests::sample;
using tests::FiveAxisProgram;
using tests::read_five_axes;

constexpr double kSamePlace_mm = 1e-6, kSameDirection = 1e-9;

machine::Machine with_control(machine::Machine machine, const char* make) {
  machine.control.kind = *machine::control_kind_named(make);
  return machine;
}

Posted posted(const FiveAxisProgram& given, const machine::Machine& machine, const PostOptions& options) {
  Diagnostics diagnostics;
  Posted out = post(given.program, given.moves, machine, options, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

std::string said(const FiveAxisProgram& given, const machine::Machine& machine, const PostOptions& options) {
  Diagnostics diagnostics;
  post(given.program, given.moves, machine, options, diagnostics);
  std::string out;
  for (Diagnostic d : diagnostics.all()) {
    d.source_line.clear();
    out += to_string(d) + "\n";
  }
  return out;
}

/// A cut of random tips and directions, in the words of all the languages.
struct Cut {
  struct Point {
    Vec3 tip_mm, deg;
    bool rapid;
    double feed;
  };
  std::vector<Point> points;
  std::string axes;  ///< "AC"
};

Cut random_cut(std::mt19937& random, const machine::Machine& machine) {
  std::uniform_real_distribution<double> one(-1, 1);
  Cut out;
  for (const char letter : {'a', 'b', 'c'})
    if (machine.kinematics.chain.find(letter) != std::string::npos) out.axes += static_cast<char>(letter - 'a' + 'A');
  const auto rounded = [](double value, double unit) { return std::round(value / unit) * unit; };
  for (int i = 0; i < 12; ++i) {
    Cut::Point p;
    for (int a = 0; a < 3; ++a) p.tip_mm[a] = rounded(30 * one(random), 1e-3) + (a == 2 ? 40 : 0);
    for (int a = 0; a < 3; ++a) p.deg[a] = i == 0 ? 0 : rounded(25 * (one(random) + 1), 1e-3);
    p.rapid = i == 0 || i % 5 == 4;
    p.feed = 100 * (1 + i / 3);
    out.points.push_back(p);
  }
  return out;
}

std::string places(const Cut& cut, const Cut::Point& p, const char* format) {
  std::string out;
  for (int a = 0; a < 3; ++a) out += fmt::format(fmt::runtime(format), "XYZ"[a], p.tip_mm[a]);
  for (const char letter : cut.axes) out += fmt::format(fmt::runtime(format), letter, p.deg[letter - 'A']);
  return out;
}

std::string iso(const Cut& cut, bool tip) {
  std::string out = "G21 G17 G90 G94\nG54\nT1 M6\nS3000 M3\n";
  out += tip ? "G43.4 H1\n" : "G43 H1\n";
  for (const Cut::Point& p : cut.points)
    out +=
        (p.rapid ? "G0" : "G1") + places(cut, p, " {}{:.3f}") + (p.rapid ? "" : fmt::format(" F{:.0f}", p.feed)) + "\n";
  return out + "G49\nM30\n";
}

std::string klartext(const Cut& cut, bool tip) {
  std::string out = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S3000\n2 M3\n";
  int number = 3;
  const auto line = [&](const std::string& text) { out += fmt::format("{} {}\n", number++, text); };
  if (tip) line("M128");
  for (const Cut::Point& p : cut.points)
    line("L" + places(cut, p, " {}{:+.3f}") + (p.rapid ? " R0 FMAX" : fmt::format(" F{:.0f}", p.feed)) + " ; p");
  if (tip) line("M129");
  line("M30");
  return out + fmt::format("{} END PGM A MM\n", number);
}

std::string siemens(const Cut& cut, bool tip) {
  std::string out = "%_N_A_MPF\nN1 G17 G71 G90 G94\nN2 T1\nN3 M6 D1\nN4 G54 S3000 M3\n";
  if (tip) out += "N5 TRAORI\n";
  int number = 10;
  for (const Cut::Point& p : cut.points)
    out += fmt::format("N{} {}", number++, p.rapid ? "G0" : "G1") + places(cut, p, " {}={:.3f}") +
           (p.rapid ? "" : fmt::format(" F{:.0f}", p.feed)) + " ; p\n";
  return out + (tip ? "N80 TRAFOOF\n" : "") + "N90 M30\n";
}

/// Poses at the ends of all moves that have one.
std::vector<ToolPose> ends(const FiveAxisProgram& program, const machine::Machine& machine) {
  kinematics::ProgramJoints joints(machine, program.moves);
  std::vector<ToolPose> out;
  while (!joints.done()) {
    joints.next();
    const nc::Move& m = program.moves.moves[joints.index()];
    if (m.kind != nc::MoveKind::linear && m.kind != nc::MoveKind::rapid) continue;
    if (const auto pose = joints.pose_at(1)) out.push_back(*pose);
  }
  return out;
}

void expect_same_poses(const std::vector<ToolPose>& a, const std::vector<ToolPose>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_LT((a[i].tip_mm - b[i].tip_mm).norm(), kSamePlace_mm) << i;
    EXPECT_LT((a[i].axis - b[i].axis).norm(), kSameDirection) << i;
  }
}

/// A block of G1 in G91 counts from where the moves before it, which stay, have left the axes.
TEST(PostLanguages, IncrementsCountFromMovesThatStay) {
  const machine::Machine machine = with_control(sample("table_bc"), "fanuc");
  const std::string head = "G21 G17 G90 G94\nG54\nT1 M6\nG43 H1\nG0 X5. Y3. Z50.\n";
  const FiveAxisProgram steps = read_five_axes(head + "G91 G1 X5. B5. F600\nX5. B-5.\nG90 G0 Z90.\nM30\n", machine);
  const FiveAxisProgram absolute = read_five_axes(head + "G1 X10. B5. F600\nX15. B0.\nG0 Z90.\nM30\n", machine);
  const PostOptions options{.target = PostTarget::tcp};
  expect_same_poses(ends(read_five_axes(posted(absolute, machine, options).text, machine), machine),
                    ends(read_five_axes(posted(steps, machine, options).text, machine), machine));
}

/// The same cut in three languages becomes the same poses, in joints and under tool-centre-point control.
TEST(PostLanguages, TheSameCutBecomesTheSamePosesInEveryLanguage) {
  std::mt19937 random(11);
  for (const char* name : {"table_bc", "table_ab", "head_table", "head_head"}) {
    const machine::Machine fanuc = with_control(sample(name), "fanuc");
    const machine::Machine heidenhain = with_control(sample(name), "heidenhain");
    const machine::Machine sinumerik = with_control(sample(name), "siemens");
    for (int i = 0; i < 2; ++i)
      for (const bool tip : {true, false}) {
        SCOPED_TRACE(fmt::format("{} {} {}", name, i, tip));
        const Cut cut = random_cut(random, fanuc);
        const PostOptions options{.target = tip ? PostTarget::joints : PostTarget::tcp,
                                  .tolerance_mm = 0.02,
                                  .rapid_tolerance_mm = 1,
                                  .decimals = 6};
        std::vector<std::vector<ToolPose>> given, made;
        const auto add = [&](const std::string& text, const machine::Machine& machine) {
          const FiveAxisProgram before = read_five_axes(text, machine);
          given.push_back(ends(before, machine));
          const Posted out = posted(before, machine, options);
          const FiveAxisProgram after = read_five_axes(out.text, machine);
          made.push_back(ends(after, machine));
          const PostDeviation d = post_deviation(before.moves, after.moves, machine, out, 16);
          EXPECT_GT(d.samples, 100u);
          EXPECT_LE(d.tip_mm, out.tip_bound_mm) << out.text;
          EXPECT_LE(d.axis_rad, out.axis_bound_rad);
          EXPECT_LE(out.tip_bound_mm, options.tolerance_mm);
        };
        add(iso(cut, tip), fanuc);
        add(klartext(cut, tip), heidenhain);
        add(siemens(cut, tip), sinumerik);
        for (std::size_t k = 1; k < 3; ++k) {
          expect_same_poses(given[0], given[k]);
          expect_same_poses(made[0], made[k]);
        }
        // The control of the machine need not be that of the program.
        add(klartext(cut, tip), sinumerik);
        expect_same_poses(made[1], made[3]);
      }
  }
}

TEST(PostLanguages, KlartextKeepsNumbersLayoutAndComments) {
  const machine::Machine machine = with_control(sample("table_bc"), "heidenhain");
  const std::string head = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S3000\n";
  const FiveAxisProgram given = read_five_axes(head +
                                                   "2 L X+0 Y+0 Z+50 R0 FMAX M3\n"
                                                   "3 L M128\n"
                                                   "4 LN X+5 Y+0 Z+50 TX+0 TY+0 TZ+1 F600\n"
                                                   "5 L X+10 F500 M8 ; cut\n"
                                                   "6 L B+0.5 C+0.25 M9\n"
                                                   "7 FUNCTION RESET TCPM\n"
                                                   "8 L Z+100 FMAX M30\n9 END PGM A MM\n",
                                               machine);
  EXPECT_EQ(posted(given, machine, {}).text, head +
                                                 "2 L X+0 Y+0 Z+50 R0 FMAX M3\n"
                                                 "3 ; L M128\n"
                                                 "4 L X+5 Y+0 Z+50 B+0 C+0 F600\n"
                                                 "5 L X+10 F500 M8 ; cut\n"
                                                 "6 L B+0.5 C+0.25 X+8.2329 Z+49.9922 F1657.8 M9\n"
                                                 "7 ; FUNCTION RESET TCPM\n"
                                                 "8 L Z+100 FMAX M30\n9 END PGM A MM\n");
}

TEST(PostLanguages, KlartextArcsBecomeLinesUnderTipControl) {
  const machine::Machine machine = with_control(sample("table_bc"), "heidenhain");
  const FiveAxisProgram given = read_five_axes(
      "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S3000\n2 L X+0 Y+0 Z+50 R0 FMAX M3\n3 L B+10 C+20 FMAX\n4 L IX+5 Y+3 Z+40 "
      "FMAX\n5 CC X+10 Y+3\n6 C X+15 Y+3 DR- F500\n7 CR X+15 Y+13 R+6 DR+ F500\n8 L B+0 C+0 FMAX\n9 L Z+90 FMAX M30\n"
      "10 END PGM A MM\n",
      machine);
  const Posted out = posted(given, machine, {.target = PostTarget::tcp});
  const FiveAxisProgram after = read_five_axes(out.text, machine);
  const PostDeviation d = post_deviation(given.moves, after.moves, machine, out, 32);
  EXPECT_LE(d.tip_mm, out.tip_bound_mm);
  EXPECT_LE(out.tip_bound_mm, 0.005);
  EXPECT_LE(d.axis_rad, out.axis_bound_rad);
  EXPECT_NE(out.text.find("\n3 M128\n"), std::string::npos) << out.text;
  EXPECT_NE(out.text.find(" M129\n"), std::string::npos) << out.text;
  EXPECT_EQ(out.text.find("DR"), std::string::npos) << out.text;
}

TEST(PostLanguages, SiemensTakesTransformationsAndDirectionsOut) {
  const machine::Machine machine = with_control(sample("table_bc"), "siemens");
  const std::string head = "N1 G17 G71 G90 G94 G54\nN2 T1\nN3 M6 D1\nN4 G0 X0 Y0 Z50 S3000 M3\n";
  const FiveAxisProgram given =
      read_five_axes(head +
                         "N5 TRAORI\nN6 G1 X10 A3=0 B3=0 C3=1 F600 M8 ; cut\n"
                         "N7 B=AC(0.5) C=DC(0.25) M9\nN8 TRAFOOF\nN9 G0 X0 Y0 Z=AC(50)\nN10 M30\n",
                     machine);
  EXPECT_EQ(posted(given, machine, {}).text,
            head +
                "N5\nN6 G1 X10 Y0 Z50 B0 C0 F600 M8 ; cut\n"
                "N7 X8.2329 Z49.9922 B0.5 C0.25 F1989.3 M9\nN8\nN9 G0 X0 Y0 Z=AC(50)\nN10 M30\n");
}

TEST(PostLanguages, SaysWhatALanguageCannot) {
  const machine::Machine machine = with_control(sample("table_bc"), "heidenhain");
  const std::string head = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S3000\n2 L X+0 Y+0 Z+50 R0 FMAX M3\n";
  EXPECT_EQ(said(read_five_axes(head + "3 M128\n4 L X+5 B+5 F500\n5 END PGM A MM\n", machine), machine,
                 {.inverse_time = true}),
            "p.nc:1:1: error: Klartext has no feed in inverse time; F per minute was expected [inverse-time]\n");
  EXPECT_EQ(said(read_five_axes(head + "3 L X+5 F500\n4 END PGM A MM\n", machine), machine, {}),
            "p.nc:1:1: error: no move is under tool-centre-point control; M128 or FUNCTION TCPM was expected "
            "[nothing-to-post]\n");
  const machine::Machine sinumerik = with_control(sample("table_bc"), "siemens");
  EXPECT_EQ(said(read_five_axes("%_N_A_MPF\nN1 G17 G71 G90 G94 G54\nN2 T1 M6 D1\nN3 G0 X0 Y0 Z50\nN4 M30\n", sinumerik),
                 sinumerik, {}),
            "p.nc:1:1: error: no move is under tool-centre-point control; TRAORI was expected [nothing-to-post]\n");
}

}  // namespace
}  // namespace camber::repath
