// Two programs line by line.
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "ui/bench.h"

namespace camber::ui {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

/// The program after, from the one before and the hunks; empty lines between hunks must be equal.
std::string rebuilt(const std::string& before_text, const std::string& after_text, const std::vector<Hunk>& hunks) {
  const auto before = lines_of(before_text), after = lines_of(after_text);
  std::string out;
  std::size_t b = 0;
  for (const Hunk& h : hunks) {
    for (; b < h.before; ++b) out += before[b] + "\n";
    for (std::size_t i = 0; i < h.after_lines; ++i) out += after[h.after + i] + "\n";
    b += h.before_lines;
  }
  for (; b < before.size(); ++b) out += before[b] + "\n";
  return out;
}

TEST(Difference, FindsReplacedAddedAndRemovedLines) {
  EXPECT_EQ(difference("a\nb\nc\n", "a\nb\nc\n"), std::vector<Hunk>{});
  EXPECT_EQ(difference("a\nb\nc\n", "a\nx\ny\nc\n"), (std::vector<Hunk>{{1, 1, 1, 2}}));
  EXPECT_EQ(difference("a\nb\nc\n", "a\nc\n"), (std::vector<Hunk>{{1, 1, 1, 0}}));
  EXPECT_EQ(difference("", "a\n"), (std::vector<Hunk>{{0, 0, 0, 1}}));
  EXPECT_EQ(difference("a\n", ""), (std::vector<Hunk>{{0, 1, 0, 0}}));
}

TEST(Difference, KeepsLinesThatBothHaveOnceTogether) {
  EXPECT_EQ(difference("%\nG1 X1\nG1 X2\nT2 M6\nG1 X3\n%\n", "%\nG1 X1.1\nG1 X1.6\nG1 X2.1\nT2 M6\nG1 X3.1\n%\n"),
            (std::vector<Hunk>{{1, 2, 1, 3}, {4, 1, 5, 1}}));
}

TEST(Difference, LeadsFromTheOneProgramToTheOther) {
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    std::string before, after;
    for (unsigned n = random() % 40; n > 0; --n) {
      const std::string line = "G1 X" + std::to_string(random() % 12) + "\n";
      if (random() % 8) before += line;
      if (random() % 8) after += line;
    }
    EXPECT_EQ(rebuilt(before, after, difference(before, after)), after) << before << "---\n" << after;
  }
}

}  // namespace
}  // namespace camber::ui
