// tests/support/test_data: what is packed comes out as it went in.
#include "tests/support/test_data.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "base/diagnostics.h"

namespace camber::tests {
namespace {

std::string text_of(const std::string& path) { return std::string(SourceText::read(path).text()); }

/// unpacked_data compares the sum of the whole text; the form of its first and last lines is that of a trace.
TEST(TestData, UnpacksATrace) {
  const std::string path = unpacked_data("linuxcnc/dense_g64_a.csv");
  const std::string text = text_of(path);
  EXPECT_EQ(text.size(), 761905u);
  EXPECT_TRUE(
      text.starts_with("t_s,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_act_mm,y_act_mm,z_act_mm,line\n0.000,0,0,0,0,0,0,0\n"));
  EXPECT_TRUE(text.ends_with("\n"));
  const auto written = std::filesystem::last_write_time(path);
  EXPECT_EQ(unpacked_data("linuxcnc/dense_g64_a.csv"), path);
  EXPECT_EQ(std::filesystem::last_write_time(path), written);  // once
}

TEST(TestData, UnpacksAText) {
  EXPECT_NE(text_of(unpacked_data("nist/box_op5_hurco02_05of20.txt")).find("|Block_Number|"), std::string::npos);
}

TEST(TestData, RefusesADamagedTrace) {
  const std::string packed = text_of(data_path("linuxcnc/dense_g64_a.trace.xz"));
  EXPECT_EQ(unpacked_trace(packed).size(), 761905u);
  std::string damaged = packed;
  damaged[damaged.size() / 2] ^= 1;
  EXPECT_THROW(unpacked_trace(damaged), std::runtime_error);
  EXPECT_THROW(unpacked_trace(packed.substr(0, packed.size() / 2)), std::runtime_error);
  EXPECT_THROW(unpacked_trace(""), std::runtime_error);
  EXPECT_THROW(unpacked_data("linuxcnc/no_such_trace.csv"), std::runtime_error);
}

TEST(TestData, SaysWhatIsNotThere) {
  EXPECT_EQ(unshipped_data("no/such/file"), "");
  EXPECT_EQ(not_shipped("no/such/file"), "no/such/file may not be shipped and is not in ../shared/data");
}

}  // namespace
}  // namespace camber::tests
