// docs/reference/nc-codes.md names every code of the table in modal_codes.cpp, in its group, and no other.
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "nc/modal_codes.h"
#include "test_paths.h"

namespace camber::nc {
namespace {

std::string code_name(char letter, int tenths) {
  return tenths % 10 == 0 ? fmt::format("{}{}", letter, tenths / 10)
                          : fmt::format("{}{}.{}", letter, tenths / 10, tenths % 10);
}

/// Rows of the tables of codes: the code and its group. A code in two rows gets both groups.
std::map<std::string, std::string> documented(char letter) {
  std::ifstream in(CAMBER_SOURCE_DIR "/docs/reference/nc-codes.md");
  EXPECT_TRUE(in.good());
  std::map<std::string, std::string> out;
  for (std::string line; std::getline(in, line);) {
    if (line.size() < 4 || line[0] != '|' || line[2] != letter || line[3] < '0' || line[3] > '9') continue;
    std::stringstream cells(line);
    std::string empty, code, group, text;
    std::getline(cells, empty, '|');
    std::getline(cells, code, '|');
    std::getline(cells, group, '|');
    std::getline(cells, text, '|');
    const auto trimmed = [](const std::string& s) {
      const auto a = s.find_first_not_of(' '), b = s.find_last_not_of(' ');
      return a == std::string::npos ? std::string() : s.substr(a, b + 1 - a);
    };
    EXPECT_FALSE(trimmed(text).empty()) << line;
    out[trimmed(code)] += trimmed(group);
  }
  return out;
}

TEST(LanguageTable, HasEveryGCodeAndNoOther) {
  std::map<std::string, std::string> known;
  for (const int tenths : known_g_codes()) known[code_name('G', tenths)] = group_name(g_code(tenths).group);
  EXPECT_EQ(documented('G'), known);
}

TEST(LanguageTable, HasEveryMCodeAndNoOther) {
  std::map<std::string, std::string> known;
  for (int tenths = 0; tenths < 10000; ++tenths)
    if (m_code(tenths) != MGroup::unknown) known[code_name('M', tenths)] = group_name(m_code(tenths));
  EXPECT_EQ(documented('M'), known);
}

}  // namespace
}  // namespace camber::nc
