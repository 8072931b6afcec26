#include "calib/column_map.h"

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace camber::calib {
namespace {

// The layouts of the texts below are made up, but for the two containers, which follow ECOSYSTEM.md section C.

struct ReadResult {
  ServoTrace trace;
  std::string messages;
};

ReadResult read(const std::string& map_text, const std::string& trace_text) {
  const tests::TempFolder folder;
  const std::string map_path = folder.write("map.toml", map_text), path = folder.write("trace.txt", trace_text);
  Diagnostics diagnostics;
  ReadResult result;
  try {
    result.trace = read_mapped_trace(path, read_column_map(map_path, diagnostics), diagnostics);
    for (const Diagnostic& d : diagnostics.all()) result.messages += to_string(d) + "\n";
  } catch (const InputError& e) {
    result.messages = e.what();
  }
  result.messages = tests::replaced(result.messages, folder.path() + "/", "");
  return result;
}

TEST(ColumnMap, SemicolonsDecimalCommaUnitsScaleAndOffset) {
  const ReadResult t = read(
      "separator = \";\"\ndecimal_comma = true\nskip_lines = 2\n"
      "[t]\nname = \"Zeit\"\nunit = \"ms\"\n[x_cmd]\nname = \"X soll\"\nunit = \"um\"\nscale = -1\noffset = 500\n"
      "[feed]\nname = \"F\"\nunit = \"m/min\"\n[line]\nindex = 4\n",
      "made up\r\nby nobody\r\nZeit;X soll;F;N\r\n0,0;1500,5;1,2;7\r\n2,0;1600;1,2;8\r\n");
  EXPECT_EQ(t.messages, "");
  ASSERT_EQ(t.trace.size(), 2u);
  EXPECT_DOUBLE_EQ(t.trace.t_s[1], 0.002);
  EXPECT_DOUBLE_EQ(t.trace.command_mm[0].x(), -1.0005);
  EXPECT_DOUBLE_EQ(t.trace.feed_mm_per_s[0], 20);
  EXPECT_EQ(t.trace.line[1], 8u);
  EXPECT_TRUE(t.trace.has_command[0]);
  EXPECT_FALSE(t.trace.has_actual[0]);
}

TEST(ColumnMap, BlanksWithoutHeaderAndAPeriodLeaveOutWordsAndHoldLowerRates) {
  const ReadResult t =
      read("separator = \"blank\"\nheader = false\nperiod_ms = 1\n[x_act]\nindex = 1\n[y_act]\nindex = 2\n",
           "  1.0   5\noverrun\n 1.1  -\n 1.2  7\n");
  EXPECT_EQ(t.messages, "");
  ASSERT_EQ(t.trace.size(), 3u);
  EXPECT_DOUBLE_EQ(t.trace.actual_mm[1].y(), 6);  // between its samples
  EXPECT_DOUBLE_EQ(t.trace.t_s[2], 0.002);
}

TEST(ColumnMap, TwinCatWithATimeForEachChannel) {
  const ReadResult t = read("separator = \";\"\n[x_cmd]\nname = \"Axis 1 SetPos\"\n[x_act]\nname = \"Axis 1 ActPos\"\n",
                            "Scope Project;Made up\nFile;trace\n\nName;Axis 1 SetPos;Name;Axis 1 ActPos\n"
                            "SampleTime;2;SampleTime;4\n0;1.0;0;0.5\n2;1.2;4;0.9\n4;1.4;;\nEOF\n");
  EXPECT_EQ(t.messages, "");
  ASSERT_EQ(t.trace.size(), 3u);
  EXPECT_DOUBLE_EQ(t.trace.period_s, 0.002);
  EXPECT_DOUBLE_EQ(t.trace.actual_mm[1].x(), 0.7);
}

TEST(ColumnMap, TwinCatFullTimestamps) {
  const ReadResult t =
      read("[x_act]\nname = \"X\"\n", "Name,X\n131900000000000000,1\n131900000000020000,2\n131900000000040000,3\n");
  ASSERT_EQ(t.trace.size(), 3u) << t.messages;
  EXPECT_NEAR(t.trace.t_s[2], 0.004, 1e-9);
}

constexpr const char* kSinumerik = R"(<?xml version="1.0" encoding="UTF-8"?>
<traceDisplaySetup_V20>
 <signals><signal key="1" name="s1" description="X1 command"/></signals>
 <traceData dataFrames="1">
  <dataFrame>
   <frameHeader startTime="2020-01-01" stopInc="2"/>
   <dataSignal id="f1" key="k1" name="s1" description="X1 command" interval="0.002"/>
   <dataSignal id="f2" key="k2" name="s2" description="block" interval="0.004"/>
   <rec time="0.000" f1="10.0" f2="3"/>
   <rec time="0.002" f1="10.5"/>
   <rec time="0.004" f1="11.0" f2="4"/>
   <rec time="0.020" f1="12.0"/>
  </dataFrame>
 </traceData>
</traceDisplaySetup_V20>
)";

TEST(ColumnMap, SinumerikRowsWithMissingSamplesAndAHole) {
  const ReadResult t = read("[x_cmd]\nname = \"X1 command\"\n[line]\nname = \"s2\"\n", kSinumerik);
  ASSERT_EQ(t.trace.size(), 4u) << t.messages;
  EXPECT_EQ(t.trace.line[1], 3u);
  EXPECT_DOUBLE_EQ(t.trace.command_mm[1].x(), 10.5);
  EXPECT_EQ(t.messages,
            "trace.txt: warning: 0.014 s are missing before 0.02 s (the samples are 0.002 s apart); the parts before "
            "and after are used separately [trace-gap]\n");
  EXPECT_EQ(t.trace.stretches.size(), 2u);
}

TEST(ColumnMap, ToldErrors) {
  EXPECT_EQ(read("[x_cmd]\nname = \"Y1\"\n", kSinumerik).messages,
            "trace.txt: error: x_cmd is \"Y1\", which the trace does not have; it has \"s1\", \"s2\" [map-column]");
  EXPECT_EQ(
      read("[x_cmd]\nname = \"X\"\n", "<a><b/></a>").messages,
      "trace.txt: error: the XML has no traceData; a Sinumerik trace (traceDisplaySetup) was expected [sinumerik-xml]");
  EXPECT_EQ(read("[t]\nindex = 1\n[x_cmd]\nindex = 2\n", "t,x\n0,1\n0,2\n").messages,
            "trace.txt:3:1: error: time 0 s is not after the sample before it, 0 s [trace-time]\n    0,2\n    ^");
  EXPECT_EQ(read("[t]\nindex = 1\n[x_cmd]\nindex = 2\n", "t,x\nonly words, here\n").messages,
            "trace.txt: error: the trace has 0 samples of all its positions; at least two are needed [trace-empty]");
  EXPECT_EQ(read("[x_cmd]\nindex = 2\n", "t,x\n0,1\n").messages,
            "map.toml: error: the map has neither [t] nor period_ms, and lines of numbers have no times of their own "
            "[map-time]");
}

TEST(ColumnMap, ToldErrorsOfTheMapItself) {
  EXPECT_NE(read("[t]\nindex = 1\n", "").messages.find("the map names no position"), std::string::npos);
  EXPECT_NE(read("period_ms = 1\n[t]\nindex = 1\n[x_act]\nindex = 2\n", "").messages.find("[map-time]"),
            std::string::npos);
  EXPECT_NE(read("[x_act]\nindex = 2\nunit = \"furlong\"\n", "").messages.find("\"mm\""), std::string::npos);
  EXPECT_NE(read("[x_act]\nindex = 2\nname = \"a\"\n", "").messages.find("one of name and index is expected"),
            std::string::npos);
}

TEST(ColumnMap, BrokenXmlIsAnErrorAtItsPlace) {
  const ReadResult t = read("[x_cmd]\nname = \"X\"\n", "<traceDisplaySetup>\n<traceData>\n<rec time=</traceData>");
  EXPECT_NE(t.messages.find("trace.txt:3:"), std::string::npos) << t.messages;
  EXPECT_NE(t.messages.find("[sinumerik-xml]"), std::string::npos);
}

}  // namespace
}  // namespace camber::calib
