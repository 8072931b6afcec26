#include "calib/machine_log.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/temp_folder.h"
#include "tests/support/test_program.h"

namespace camber::calib {
namespace {

class MachineLogTest : public ::testing::Test {
 protected:
  std::string file(const std::string& text) { return folder_.write("log.txt", text); }
  std::string error_of(const std::string& text) {
    Diagnostics diagnostics;
    try {
      read_machine_log(file(text), diagnostics);
    } catch (const InputError& e) {
      return to_string(e.diagnostics().front()).substr(folder_.path().size() + 1);
    }
    return "no error";
  }
  /// Lines 1 to 3 in 2.5 s, between rapids.
  static std::vector<FeedStretch> stretches() {
    tests::TestProgram p;
    p.line(10, 0, 0, 1000).line(20, 0, 0, 1000).line(30, 0, 0, 1000).rapid(0, 0, 0);
    return feed_stretches(p.program);
  }
  static std::string stamp(double t, const std::string& rest) {
    char text[64];
    std::snprintf(text, sizeof text, "2017-02-14T14:56:%09.6fZ|", t);
    return text + rest + "\n";
  }
  static std::string lines(double hold_s = 0) {
    return stamp(1, "Block_Number|1") + stamp(1.5, "Feed_Rate|16.6") + stamp(2, "Block_Number|2") +
           stamp(2.5, "Feed_Rate|" + std::string(hold_s > 0 ? "0" : "16.5")) + stamp(2.5 + hold_s, "Feed_Rate|16.6") +
           stamp(3 + hold_s, "Block_Number|3") + stamp(3.5 + hold_s, "Block_Number|4");
  }
  std::vector<TimedStretch> timed(const std::string& text) {
    Diagnostics diagnostics;
    return logged_stretches(read_machine_log(file(text), diagnostics), stretches());
  }
  tests::TempFolder folder_;
};

TEST_F(MachineLogTest, TimesAStretchFromItsFirstEventToTheFirstOfAnotherLine) {
  const auto t = timed(lines());
  ASSERT_EQ(t.size(), 1u);
  EXPECT_NEAR(t[0].time_s, 2.5, 1e-6);
}

TEST_F(MachineLogTest, LeavesOutWhatWasHeldOverriddenOrLost) {
  EXPECT_EQ(timed(lines(2.0)).size(), 0u);  // a feed hold of 2 s
  // A constant override is divided out.
  const auto slow = timed(stamp(0, "Feed_Override|80") + lines());
  ASSERT_EQ(slow.size(), 1u);
  EXPECT_DOUBLE_EQ(slow.front().feed_factor, 0.8);
  EXPECT_EQ(timed(stamp(0, "Feed_Override|100") + lines()).size(), 1u);
  EXPECT_EQ(timed(stamp(1, "Block_Number|1") + stamp(2, "Block_Number|2") + stamp(7, "Block_Number|3") +
                  stamp(8, "Block_Number|4"))
                .size(),
            0u);  // 5 s without any event
  EXPECT_EQ(timed(stamp(1, "Block_Number|1") + stamp(2, "Block_Number|2") + stamp(3, "Block_Number|3")).size(), 0u);
}

TEST_F(MachineLogTest, LeavesOutBrokenLinesWithAWarning) {
  Diagnostics diagnostics;
  std::string text = lines() + "2017\n";
  for (int i = 10; i < 40; ++i) text += stamp(i, "Program_Runtime_Seconds|" + std::to_string(i));
  const MachineLog log = read_machine_log(file(text), diagnostics);
  EXPECT_EQ(log.line.size(), 4u);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].message, "this is not timestamp|item|value; the line is left out");
  EXPECT_EQ(diagnostics.all()[0].location.line, 8u);
}

TEST_F(MachineLogTest, SaysWhatIsWrong) {
  EXPECT_EQ(error_of("2017-02-14 14:56|Block_Number|3\n"),
            "log.txt:1:1: error: \"2017-02-14 14:56\" is not a time; one like 2017-02-14T14:56:22.905Z was expected "
            "[log-time]\n"
            "    2017-02-14 14:56|Block_Number|3\n"
            "    ^");
  EXPECT_EQ(error_of("2017-02-14T14:56:22Z|Block_Number|x\n"),
            "log.txt:1:35: error: Block_Number is \"x\"; a number that is not negative was expected [log-number]\n"
            "    2017-02-14T14:56:22Z|Block_Number|x\n                                      ^");
  EXPECT_EQ(error_of("2017-02-14T14:56:22Z|Feed_Rate|1\n"),
            "log.txt: error: the log has no Block_Number and no Xabs, Yabs, Zabs; lines as "
            "2017-02-14T14:56:34.62Z|Block_Number|18 were expected [log-item]");
  EXPECT_EQ(error_of("a,b\nc,d\n"),
            "log.txt: error: 2 of 2 lines are not timestamp|item|value; is this a machine log? [log-fields]");
}

}  // namespace
}  // namespace camber::calib
