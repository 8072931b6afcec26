// Our macro language against LinuxCNC's interpreter: programs by hand, random expressions, random flow control.
#include <random>

#include "tests/nc/rs274_oracle.h"

namespace camber::nc {
namespace {

#define CAMBER_RS274_OR_SKIP() \
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH"

constexpr const char* kHead = "G21 G17 G90 G94\nF100\n";

TEST(MacroRs274, ProgramsByHandMoveAlike) {
  CAMBER_RS274_OR_SKIP();
  static const char* const kPrograms[] = {
      // operators, functions, vacant variables
      "G1 X[1 EQ 1.00005] Y[1 EQ 1.0002] Z1\nG1 X[2**3**2] Y[-7 MOD 3] Z[7 MOD -3]\nG1 X[FIX[-2.8]] Y[FUP[-2.8]] "
      "Z[ROUND[-2.5]]\nG1 X[5 AND 2] Y[0 OR 2] Z[3 XOR 2]\nG1 X[ATAN[-1]/[-1]] Y#200 Z#1\nG1 X[1+2 GT 2 AND 3] "
      "Y[2*3+4**0.5] Z[-2**2]\nG1 XSIN[30] Y-SIN[30] Z+#200\nM2\n",
      // values before settings
      "#3=15\n#3=6 G1 X#3\nG1 Y#3\n#1=1 #2=[#1+4]\nX#1 Y#2\nM2\n",
      // Fanuc's subprograms: counts, the caller's variables, nesting
      "#1=7\nM98 P100 L3\nG1 X#1\nM98 P200\nG1 Y9\nM2\nO100\nG91 G1 Y#1\nG90\n#1=[#1+0.5]\nM99\nO200\nG1 Z3\nM98 P100\n"
      "G1 Z4\nM99\n",
      // O-words: arguments, results, locals, recursion
      "o200 sub\nG1 X#1 Y#2 Z#3\n#1=100\no200 endsub [#1+#2]\no200 call [3] [4]\nG1 X#<_value> Y#1\nM2\n",
      "o1 sub\no2 if [#1 GT 1]\no1 call [#1-1]\n#2=[#1*#<_value>]\no2 else\n#2=1\no2 endif\no1 endsub [#2]\no1 call "
      "[5]\nG1 X#<_value>\nM2\n",
      "o<a> sub\n#<x>=5\n#<_g>=[#<_g>+1]\nG1 X#<x> Y#<_g>\no<a> endsub\n#<_g>=2\n#<x>=1\no<a> call\no<a> call\nG1 "
      "Z#<x>\n"
      "M2\n",
      "o1 sub\no2 if [#1 LT 0]\no1 return [11]\no2 endif\nG1 Y#1\no1 endsub [22]\no1 call [-1]\nG1 X#<_value>\no1 call "
      "[3]\nG1 X#<_value>\nM2\n",
      // loops
      "#1=0\no1 while [#1 LT 5]\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 elseif [#1 EQ 4]\no1 break\no2 else\nG1 "
      "X#1\no2 endif\nG1 Y#1\no1 endwhile\nG1 Z1\nM2\n",
      "#1=0\no1 do\nG1 X#1\n#1=[#1+1]\no1 while [#1 LT 3]\nG1 Y1\nM2\n",
      "G91\no1 repeat [3]\nG1 X1\no2 repeat [2]\nG1 Y1\no2 endrepeat\no1 endrepeat\nM2\n",
      "o1 repeat [2.7]\nG91 G1 X1\no1 endrepeat\nG90\nM2\n",
      // computed numbers
      "o7 sub\nG1 X#1\no7 endsub\n#100=7\no#100 call [2]\no[#100] call [3]\n#[100+1]=4\n#102=101\nG1 Y##102 "
      "Z#101\nM2\n",
      // positions and named parameters of the control
      "G1 X1 Y2 Z3\nG1 X[#5420+1] Y[#<_y>*2] Z[#5422-1]\nG20\nG1 X#<_x> Y[#<_metric>]\nG21\nG1 X#<_metric> Y#<_feed> "
      "Z[#<_plane>/10]\nG91\nG1 X#<_incremental> Y#<_motion_mode>\nM2\n",
      "G1 X[EXISTS[#<a>]] Y1\n#<a>=1\nG1 X[EXISTS[#<a>]]\nM2\n",
      // canned cycles inside a loop
      "G98 G0 Z5\n#1=0\no1 while [#1 LT 3]\nG81 X[#1*10] Y5 Z-3 R1\n#1=[#1+1]\no1 endwhile\nG80\nG0 Z5\nM2\n"};
  std::size_t moves = 0;
  for (const char* program : kPrograms) moves += expect_same_lines(std::string(kHead) + program);
  EXPECT_EQ(moves, 70u);
}

TEST(MacroRs274, SubprogramFilesMoveAlike) {
  CAMBER_RS274_OR_SKIP();
  std::map<std::string, std::string> files;
  files["hole.ngc"] = "o<hole> sub\nG0 X#1 Y#2\nG1 Z-#3\nG0 Z2\no<hole> endsub\nM2\n";
  const std::string text = fmt::format("{}G0 Z2\no<hole> call [1] [2] [3]\no<hole> call [4] [5] [1]\nM2\n", kHead);
  EXPECT_EQ(expect_same_lines(text, files), 7u);
}

/// Random expressions that rs274 reads too.
class RandomProgram {
 public:
  explicit RandomProgram(unsigned seed) : with_repeat_(seed % 2 == 0), random_(seed) {}

  std::string expression(int depth) {
    if (depth == 0 || pick(5) == 0) return pick(2) == 0 ? number() : fmt::format("#{}", 1 + pick(6));
    switch (pick(9)) {
      case 0:
        return "[" + expression(depth - 1) + "]";
      case 1:
        return "-[" + expression(depth - 1) + "]";
      case 2:
        return "SIN[" + expression(depth - 1) + "]";
      case 3:
        return "ABS[" + expression(depth - 1) + "]";
      case 4:
        return "ROUND[10*COS[" + expression(depth - 1) + "]]";
      case 5:
        return fmt::format("ATAN[{}]/[{}]", expression(depth - 1), number());
      case 6:
        return fmt::format("SQRT[ABS[{}]]", expression(depth - 1));
      default:
        return fmt::format("{} {} {}", expression(depth - 1), operation(), expression(depth - 1));
    }
  }

  /// A list of statements that ends: loops have counters of their own.
  std::string statements(int depth, int count) {
    std::string out;
    for (int i = 0; i < count; ++i) out += statement(depth);
    return out;
  }

  int pick(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }

 private:
  std::string number() { return fmt::format("{}.{}", 1 + pick(9), pick(100)); }
  std::string operation() {
    static const char* const kAll[] = {"+",  "-",  "*",  "+",  "-",  "*",   "MOD", "EQ",
                                       "NE", "GT", "GE", "LT", "LE", "AND", "OR",  "XOR"};
    return kAll[pick(16)];
  }
  std::string small() { return fmt::format("[[{}] MOD 50]", expression(2)); }

  std::string statement(int depth) {
    const int label = ++labels_, branch = ++labels_, counter = 100 + label;
    switch (depth == 0 ? pick(3) : pick(9)) {
      case 0:
        return fmt::format("G{} X{} Y{}\n", pick(2), small(), small());
      case 1:
        return fmt::format("#{}={}\n", 1 + pick(6), small());
      case 2:
        return fmt::format("G91 G1 Z{}\nG90\n", small());
      case 3:
        return fmt::format("o{0} if [{1}]\n{2}o{0} elseif [{3}]\n{4}o{0} else\n{5}o{0} endif\n", label, expression(2),
                           statements(depth - 1, 2), expression(1), statements(depth - 1, 1), statements(depth - 1, 2));
      case 4:
        return fmt::format("#{1}=0\no{0} while [#{1} LT {2}]\n#{1}=[#{1}+1]\n{3}o{0} endwhile\n", label, counter,
                           1 + pick(4), statements(depth - 1, 2));
      case 5:
        if (!with_repeat_) return fmt::format("M98 P9 L{}\n", 1 + pick(2));
        return fmt::format("o{0} repeat [{1}]\n{2}o{0} endrepeat\n", label, pick(4), statements(depth - 1, 2));
      case 6:
        return fmt::format(
            "#{1}=0\no{0} do\n#{1}=[#{1}+1]\n{2}o{3} if [{4}]\no{0} {5}\no{3} endif\n{6}o{0} while [#{1} LT 3]\n",
            label, counter, statements(depth - 1, 1), branch, expression(1),
            with_repeat_ || pick(2) == 0 ? "break" : "continue", statements(depth - 1, 1));
      case 7:
        return fmt::format("o{} call [{}] [{}]\n#1=[#<_value> MOD 20]\n", 1 + pick(2), small(), number());
      default:
        return fmt::format("M98 P9 L{}\n", 1 + pick(2));
    }
  }

  /// rs274 2.9.0 repeats without end, or too often, where a program has o repeat and o continue in an o do: one or the
  /// other.
  bool with_repeat_;
  std::mt19937 random_;
  int labels_ = 10;
};

TEST(MacroRs274, RandomExpressionsAreAlike) {
  CAMBER_RS274_OR_SKIP();
  std::size_t moves = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    RandomProgram random(seed);
    std::string text = kHead;
    for (int i = 1; i <= 6; ++i) text += fmt::format("#{}={}.5\n", i, random.pick(9) - 4);
    for (int i = 0; i < 60; ++i) text += fmt::format("G1 X[[{}] MOD 1000] Y{}\n", random.expression(4), i);
    moves += expect_same_lines(text + "M2\n");
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GE(moves, 12u * 59u);
}

TEST(MacroRs274, RandomFlowControlMovesAlike) {
  CAMBER_RS274_OR_SKIP();
  std::size_t moves = 0;
  for (unsigned seed = 100; seed < 140; ++seed) {
    RandomProgram random(seed);
    std::string text = kHead;
    text += "o1 sub\nG1 X[#1 MOD 30] Z#3\no1 endsub [#1*3]\n";
    text +=
        "o2 sub\n#1=[#1+#2]\no3 if [#1 GT 40]\no2 return [#1-40]\no3 endif\nG0 Y[#1 MOD 30]\no1 call [#2]\no2 endsub "
        "[#<_value>+#1]\n";
    for (int i = 1; i <= 6; ++i) text += fmt::format("#{}={}\n", i, random.pick(9));
    text += random.statements(3, 8);
    moves += expect_same_lines(text + "M2\nO9\nG91 G0 X1 Z0.5\nG90\nM99\n");
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(moves, 1000u);
}

}  // namespace
}  // namespace camber::nc
