// Every reader of recordings on inputs that were changed at random: it reads them or says what is wrong.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <random>

#include "calib/column_map.h"
#include "calib/machine_log.h"
#include "calib/stretch.h"
#include "calib/trace.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_program.h"

namespace camber::calib {
namespace {

constexpr int kInputs = 400;

/// Bytes are changed, put in, taken out; pieces are doubled, cut off, exchanged with what numbers must not be.
std::string broken(std::string text, std::mt19937& random) {
  static constexpr const char* kPieces[] = {
      "nan", "inf", "-1", "1e400", ",", "|",    "\n", "\r\n", "\"", "<",
      ">",   "{",   "[",  "]",     "}", "null", "0",  "T",    "  ", "99999999999999999999"};
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % std::max<std::size_t>(1, n); };
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const std::size_t at = below(text.size());
    switch (below(5)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(random());
        break;
      case 1:
        text.insert(at, kPieces[below(std::size(kPieces))]);
        break;
      case 2:
        text.erase(at, below(20));
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), below(60)));
        break;
      default:
        text.resize(at);
    }
  }
  return text;
}

class BrokenRecordings : public ::testing::Test {
 protected:
  void expect_read_or_said(const std::string& text, const std::function<void(const std::string& path)>& read) {
    std::mt19937 random(7);
    const std::string path = folder_ / "recording";
    for (int i = 0; i < kInputs; ++i) {
      const std::string input = i == 0 ? text : broken(text, random);
      std::ofstream(path, std::ios::binary) << input;
      try {
        read(path);
      } catch (const InputError& e) {
        ASSERT_NE(i, 0) << e.diagnostics().front().message;
        ASSERT_FALSE(e.diagnostics().empty()) << input;
        EXPECT_FALSE(e.diagnostics().front().check.empty()) << input;
      }
    }
  }

  void expect_mapped(const std::string& text, const std::string& map_text) {
    const std::string map_path = folder_ / "map.toml";
    std::ofstream(map_path) << map_text;
    Diagnostics diagnostics;
    const ColumnMap map = read_column_map(map_path, diagnostics);
    expect_read_or_said(text, [&](const std::string& path) {
      Diagnostics found;
      read_mapped_trace(path, map, found);
    });
  }

  tests::TempFolder folder_;
};

TEST_F(BrokenRecordings, ServoTrace) {
  expect_read_or_said("t_s,x_cmd_mm,x_act_mm,a_cmd_deg,line\n0,0,0,0,1\n0.001,0.1,0.05,1,1\n0.002,0.2,0.15,2,2\n",
                      [](const std::string& path) {
                        Diagnostics diagnostics;
                        read_trace(path, diagnostics);
                      });
}

TEST_F(BrokenRecordings, TableOfTimes) {
  const nc::Interpretation program =
      tests::TestProgram().line(1, 0, 0, 600).line(2, 0, 0, 600).rapid(0, 0, 0).line(3, 0, 0, 600).program;
  expect_read_or_said("first_line,last_line,time_s\n1,2,0.5\n4,4,0.4\n2,2,0.1\n",
                      [&](const std::string& path) { read_stretch_table(path, program); });
}

TEST_F(BrokenRecordings, MachineLog) {
  expect_read_or_said(
      "2017-02-14T14:56:22.9058750Z|Block_Number|18|Feed_Rate|20.5\n2017-02-14T14:56:23.1Z|Xabs|1.5|Yabs|-2|Zabs|0\n"
      "2017-02-14T14:56:23.3Z|Path_Position|1.6 -2 0\n2017-02-14T14:56:23.5Z|Feed_Override|100\n",
      [](const std::string& path) {
        Diagnostics diagnostics;
        const MachineLog log = read_machine_log(path, diagnostics);
        logged_stretches(log, {});
        if (has_positions(log)) position_trace(log);
      });
}

TEST_F(BrokenRecordings, TableOfNumbers) {
  expect_mapped("# log\nt;x\n0;0\n1;0,5\n2;1\n",
                "separator = \";\"\ndecimal_comma = true\nskip_lines = 1\n[t]\nname = \"t\"\nunit = \"ms\"\n"
                "[x_act]\nname = \"x\"\n");
}

TEST_F(BrokenRecordings, TwinCat) {
  expect_mapped("Name,X\n131900000000000000,1\n131900000000020000,2\n131900000000040000,3\n",
                "[x_act]\nname = \"X\"\n");
}

TEST_F(BrokenRecordings, SinumerikXml) {
  expect_mapped(
      "<traceDisplaySetup><traceData><dataFrame><frameHeader><dataSignal id=\"f1\" name=\"X\"/></frameHeader>"
      "<rec time=\"0\" f1=\"0\"/><rec time=\"0.002\" f1=\"0.5\"/><rec time=\"0.004\" f1=\"1\"/></dataFrame></traceData>"
      "</traceDisplaySetup>",
      "[x_act]\nname = \"X\"\n");
}

TEST_F(BrokenRecordings, SinumerikEdge) {
  expect_mapped(
      "{\"Header\": {\"CycleTimeMs\": 2, \"SignalListHFData\": [{\"Name\": \"CYCLE\", \"Address\": \"CYCLE\"}, "
      "{\"Name\": \"DES_POS|1\", \"Address\": \"DES_POS|1\"}]}, \"Payload\": [{\"HFData\": [[100, 0.5], [101, 0.6]]}, "
      "{\"HFBlockEvent\": {\"HFProbeCounter\": 101, \"GCode\": \"G1 X1\"}}, {\"HFData\": [[102, 0.8], [160, 1.5]]}]}",
      "[x_cmd]\nname = \"DES_POS|1\"\n");
}

/// Rows that are missing leave a gap: the counter tells.
TEST_F(BrokenRecordings, SinumerikEdgeTimesAreThoseOfTheCounter) {
  const std::string path = folder_ / "edge.json", map_path = folder_ / "map.toml";
  std::ofstream(path) << "{\"Header\": {\"CycleTimeMs\": 2, \"SignalListHFData\": [{\"Name\": \"CYCLE\"}, {\"Name\": "
                         "\"ENC_POS|1\"}]}, \"Payload\": [{\"HFData\": [[100, 1], [101, 2], [102, 3], [3962, 9]]}]}";
  std::ofstream(map_path) << "[x_act]\nname = \"ENC_POS|1\"\n";
  Diagnostics diagnostics;
  const ServoTrace trace = read_mapped_trace(path, read_column_map(map_path, diagnostics), diagnostics);
  ASSERT_EQ(trace.size(), 4u);
  EXPECT_NEAR(trace.t_s[3], 7.724, 1e-9);
  EXPECT_EQ(trace.stretches.size(), 2u);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all().front().check, "trace-gap");
}

}  // namespace
}  // namespace camber::calib
