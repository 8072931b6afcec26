#include "calib/trace.h"

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace camber::calib {
namespace {

/// What reading the text says: the errors, or else the warnings.
std::string messages_of(const std::string& text) {
  const tests::TempFolder folder;
  const std::string path = folder.write("trace.csv", text);
  Diagnostics diagnostics;
  std::string out;
  try {
    read_trace(path, diagnostics);
    for (const Diagnostic& d : diagnostics.all()) out += to_string(d) + "\n";
  } catch (const InputError& e) {
    out = e.what();
    if (out.empty() || out.back() != '\n') out += "\n";
  }
  return tests::replaced(out, folder.path() + "/", "");
}

TEST(ReadTrace, TakesAnyOrderCrlfAndBlanks) {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  const ServoTrace t = read_trace(
      folder.write("t.csv",
                   "line, x_act_mm ,t_s,x_cmd_mm,feed_mm_per_min\r\n3,1.5,0.000,2,600\r\n4,1.6,0.001,2.1,600\r\n"),
      diagnostics);
  ASSERT_EQ(t.size(), 2u);
  EXPECT_EQ(t.line[1], 4u);
  EXPECT_DOUBLE_EQ(t.actual_mm[0].x(), 1.5);
  EXPECT_DOUBLE_EQ(t.feed_mm_per_s[0], 10);
  EXPECT_FALSE(t.has_command[1]);
  EXPECT_DOUBLE_EQ(t.period_s, 0.001);
  EXPECT_TRUE(diagnostics.all().empty());
}

TEST(ReadTrace, RefusesAnEmptyFile) {
  EXPECT_EQ(messages_of(""),
            "trace.csv: error: the trace is empty; a header line that names the columns is expected "
            "[trace-empty]\n");
}

TEST(ReadTrace, RefusesNotANumber) {
  EXPECT_EQ(
      messages_of("t_s,x_cmd_mm\n0,1\n0.001,nan\n"),
      "trace.csv:3:7: error: x_cmd_mm is \"nan\"; a number is expected [trace-number]\n    0.001,nan\n          ^\n");
}

TEST(ReadTrace, RefusesATraceWithoutTime) {
  EXPECT_EQ(
      messages_of("x_cmd_mm\n0\n"),
      "trace.csv:1:1: error: the header has no column t_s (time in seconds) [trace-column]\n    x_cmd_mm\n    ^\n");
}

TEST(ReadTrace, RefusesARowOfTheWrongLength) {
  EXPECT_EQ(messages_of("t_s,x_cmd_mm\n0,1\n0.001\n"),
            "trace.csv:3:1: error: 1 fields; the header names 2 columns [trace-fields]\n    0.001\n    ^\n");
}

TEST(ReadTrace, RefusesTimeThatGoesBack) {
  EXPECT_EQ(messages_of("t_s,x_cmd_mm\n0.002,1\n0.001,1\n"),
            "trace.csv:3:1: error: time 0.001 s is not after the sample before it, 0.002 s [trace-time]\n"
            "    0.001,1\n    ^\n");
}

TEST(ReadTrace, WarnsOfAnUnknownColumn) {
  EXPECT_EQ(messages_of("t_s,x_cmd_mm,torque\n0,1,9\n0.001,1,9\n"),
            "trace.csv:1:14: warning: column \"torque\" is not known and is left out [trace-column]\n"
            "    t_s,x_cmd_mm,torque\n                 ^\n");
}

TEST(ReadTrace, SplitsAtAGapAndSaysHowMuchIsMissing) {
  EXPECT_EQ(messages_of("t_s,x_cmd_mm\n0,1\n0.001,1\n0.002,1\n0.252,1\n0.253,1\n"),
            "trace.csv:5:1: warning: 0.249 s are missing before 0.252 s (the samples are 0.001 s apart); the parts "
            "before and after are used separately [trace-gap]\n"
            "    0.252,1\n"
            "    ^\n");
}

}  // namespace
}  // namespace camber::calib
