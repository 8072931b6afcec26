// Values of expressions, by hand and from the controls' manuals.
#include "nc/expression.h"

#include <cmath>

#include "tests/nc/macro_text.h"

namespace camber::nc {
namespace {

constexpr auto kFanuc = "fanuc";
constexpr auto kLinuxCnc = "linuxcnc";

TEST(NcExpression, ArithmeticGoesFromLeftToRightProductsFirst) {
  EXPECT_EQ(value_of("1+2*3-8/4"), 5);
  EXPECT_EQ(value_of("10-3-2"), 5);
  EXPECT_EQ(value_of("[1+2]*[3-1]"), 6);
  EXPECT_EQ(value_of("2*3**2"), 18);
  EXPECT_EQ(value_of("[2**3**2]", kLinuxCnc), 64);  // from left to right, as rs274 does
  EXPECT_EQ(value_of("[-2**2]", kLinuxCnc), 4);
  EXPECT_EQ(value_of("-[2+3]*-2"), 10);
  EXPECT_EQ(value_of(".5 + 1."), 1.5);
}

TEST(NcExpression, FunctionsTakeAndGiveDegrees) {
  EXPECT_NEAR(value_of("SIN[30]"), 0.5, 1e-12);
  EXPECT_NEAR(value_of("cos[60]"), 0.5, 1e-12);
  EXPECT_NEAR(value_of("TAN[45]"), 1, 1e-12);
  EXPECT_NEAR(value_of("ASIN[.5]"), 30, 1e-12);
  EXPECT_NEAR(value_of("ACOS[0]"), 90, 1e-12);
  EXPECT_NEAR(value_of("ATAN[1]"), 45, 1e-12);
  EXPECT_NEAR(value_of("ATAN[-1]/[-1]"), 225, 1e-12);  // 6004#0 NAT = 0: 0 to 360
  EXPECT_NEAR(value_of("ATAN[-1,-1]"), 225, 1e-12);
  EXPECT_NEAR(value_of("ATAN[-1]/[-1]", kLinuxCnc), -135, 1e-12);
  EXPECT_NEAR(value_of("ATAN[1]/3"), 15, 1e-12);
  EXPECT_EQ(value_of("SQRT[16]"), 4);
  EXPECT_EQ(value_of("SQR[16]"), 4);
  EXPECT_EQ(value_of("ABS[-2.5]"), 2.5);
  EXPECT_NEAR(value_of("LN[EXP[2]]"), 2, 1e-12);
  EXPECT_EQ(value_of("POW[2,10]"), 1024);
  EXPECT_EQ(value_of("BIN[18]"), 12);  // 0x12 read as decimal digits
  EXPECT_EQ(value_of("BCD[12]"), 18);
  EXPECT_EQ(value_of("NOT[0]"), 1);
}

TEST(NcExpression, RoundingDiffersBetweenControls) {
  EXPECT_EQ(value_of("ROUND[2.5]"), 3);
  EXPECT_EQ(value_of("ROUND[-2.5]"), -3);
  EXPECT_EQ(value_of("FIX[-1.2]"), -1);  // B-64484EN: FIX[-1.2] is -1.0, FUP[-1.2] is -2.0
  EXPECT_EQ(value_of("FUP[-1.2]"), -2);
  EXPECT_EQ(value_of("FIX[1.2]"), 1);
  EXPECT_EQ(value_of("FUP[1.2]"), 2);
  EXPECT_EQ(value_of("FIX[-2.8]", kLinuxCnc), -3);
  EXPECT_EQ(value_of("FUP[-2.8]", kLinuxCnc), -2);
  EXPECT_EQ(value_of("27 MOD 20", "haas"), 7);  // Haas 96-8000
  EXPECT_EQ(value_of("-7 MOD 3"), -1);
  EXPECT_EQ(value_of("[-7 MOD 3]", kLinuxCnc), 2);
  EXPECT_EQ(value_of("[7.5 MOD 2]", kLinuxCnc), 1.5);
}

TEST(NcExpression, RoundInAnAxisWordRoundsToTheLeastIncrement) {
  // Haas 96-8000: #1 = 1.00333, X[#1+#1] goes to 2.0067 and X[ROUND[#1]+ROUND[#1]] to 2.0066, inch.
  EXPECT_EQ(run_text("G20 #1=1.00333\nG0 X[ROUND[#1]+ROUND[#1]]", as("haas")), "50.9676 0 0");
  EXPECT_EQ(run_text("#1=1.00333\nG0 X[ROUND[#1]+ROUND[#1]]\n#2=ROUND[#1]\nX#2"), "2.006 0 0; 1 0 0");
}

TEST(NcExpression, LogicIsOfBitsOnFanucAndOfTruthOnLinuxCnc) {
  EXPECT_EQ(value_of("5 AND 2"), 0);
  EXPECT_EQ(value_of("5 OR 2"), 7);
  EXPECT_EQ(value_of("5 XOR 3"), 6);
  EXPECT_EQ(value_of("[5 AND 2]", kLinuxCnc), 1);
  EXPECT_EQ(value_of("[3 XOR 2]", kLinuxCnc), 0);
  EXPECT_EQ(value_of("1 + 6 AND 3"), 3);               // AND goes with the products: 1 + 2
  EXPECT_EQ(value_of("[1 + 6 AND 0]", kLinuxCnc), 0);  // and comes last
  EXPECT_EQ(value_of("[[2 EQ 2] AND [3 GT 1]]"), 1);
}

TEST(NcExpression, Comparisons) {
  EXPECT_EQ(value_of("[1 EQ 1] + 2*[1 NE 1] + 4*[2 GT 1] + 8*[1 GE 1] + 16*[1 LT 1] + 32*[1 LE 1]"), 45);
  EXPECT_EQ(value_of("[1 EQ 1.00005]"), 0);
  EXPECT_EQ(value_of("[1 EQ 1.00005]", kLinuxCnc), 1);
  EXPECT_EQ(value_of("[1 EQ 1.0002]", kLinuxCnc), 0);
}

TEST(NcExpression, VacantVariablesAreNoNumber) {
  // The table of #0 in Fanuc's manual: vacant equals vacant and not zero; else it counts as zero.
  EXPECT_EQ(value_of("[#5 EQ #0] + 2*[#5 EQ 0] + 4*[#5 NE 0] + 8*[#5 GE 0] + 16*[#5 GT 0]"), 1 + 4 + 8);
  EXPECT_EQ(value_of("#5 + 3"), 3);
  EXPECT_EQ(run_text("G0 X1 Y2 Z3\nX#5 Y7"), "1 2 3; 1 7 3");   // as if X were not written
  EXPECT_EQ(run_text("#6=#5\nG0 X1\nX#6 Y7"), "1 0 0; 1 7 0");  // a copy of nothing is nothing
  EXPECT_EQ(run_text("#6=#5*1\nG0 X1\nX#6 Y7"), "1 0 0; 0 7 0");
  EXPECT_EQ(run_text("#6=4\n#6=#0\nG0 X1\nX#6 Y7"), "1 0 0; 1 7 0");
  EXPECT_EQ(run_linuxcnc("G0 X1\nX#5 Y7"), "1 0 0; 0 7 0");  // LinuxCNC: zero
}

TEST(NcExpression, VariablesNameVariables) {
  EXPECT_EQ(run_text("#1=100\n#[#1+1]=7\n#100=101\nG0 X#101 Y##1 Z-#101\nX-[#101*2]"), "7 101 -7; -14 101 -7");
}

TEST(NcExpression, WordsTakeFunctionsAndSigns) {
  EXPECT_EQ(run_linuxcnc("G0 XSIN[30] Y-SIN[30] Z+#7\nG[1-1]X[2]"), "0.5 -0.5 0; 2 -0.5 0");
}

TEST(NcExpression, TellsWhatIsWrong) {
  EXPECT_EQ(said("#1=1/0\n"), "p.nc:1:5: error: a division by zero [expression]");
  EXPECT_EQ(said("#1=SQRT[-4]\n"), "p.nc:1:4: error: the square root of -4; zero or more was expected [expression]");
  EXPECT_EQ(said("#1=ASIN[2]\n"), "p.nc:1:4: error: ASIN of 2; -1 to 1 was expected [expression]");
  EXPECT_EQ(said("#1=LN[0]\n"),
            "p.nc:1:4: error: the logarithm of 0; a number greater than zero was expected [expression]");
  EXPECT_EQ(said("#1=5 MOD 0\n"), "p.nc:1:6: error: 5 MOD 0; a divisor other than zero was expected [expression]");
  EXPECT_EQ(said("#1=EXP[1000]\n"), "p.nc:1:4: error: EXP of 1000 is too large [expression]");
  EXPECT_EQ(said("#1=[-8]**0.5\n"), "p.nc:1:8: error: -8 to the power of 0.5 is no number [expression]");
  EXPECT_EQ(said("G0 X[1+2\n"), "p.nc:1:5: error: the bracket `[` is not closed in its block [expression]");
  EXPECT_EQ(said("G0 X[1 2]\n"),
            "p.nc:1:8: error: an operator (+ - * / MOD ** AND OR XOR EQ NE GT GE LT LE) or `]` was expected "
            "[expression]");
  EXPECT_EQ(said("#1=\n"),
            "p.nc:1:4: error: the expression ends; a number, a variable (#) or [ was expected [expression]");
  EXPECT_EQ(said("#1=2+*3\n"),
            "p.nc:1:6: error: a number, a variable (#), a function or [ was expected here [expression]");
  EXPECT_EQ(said("#1=#\n"),
            "p.nc:1:5: error: # has no number; a number, [ or <name> was expected after it [expression]");
  EXPECT_EQ(said("#1=POW[2]\n"), "p.nc:1:9: error: `,` was expected in POW[a,b] [expression]");
  EXPECT_EQ(said("#<a=1\n"), "p.nc:1:2: error: the name has no closing `>` [expression]");
  EXPECT_EQ(said("#1=" + std::string(200, '[') + "1" + std::string(200, ']')),
            "p.nc:1:104: error: more than 100 nested brackets [expression]");
  EXPECT_EQ(said("#1 5\n"),
            "p.nc:1:1: error: a variable without an assignment; #number = value was expected [statement]");
  EXPECT_EQ(said("#1=1e5\n"), "p.nc:1:5: error: E is not a letter of a milling program [unknown-letter]");
  EXPECT_EQ(said("#1=1000000000\nG0 X[#1*#1]\n"), "p.nc:2:4: error: X1e+18 is too large [expression]");
}

}  // namespace
}  // namespace camber::nc
