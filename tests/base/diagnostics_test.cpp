#include "base/diagnostics.h"

#include <gtest/gtest.h>

namespace camber {
namespace {

TEST(Diagnostics, ReadLikeACompilersWithACaretBelowTheWord) {
  const SourceText source("part.nc", "G21\nN120 G1 X40. Y12.5 F0\n");
  const auto d = source.diagnostic(Severity::error, 23, "F0 on a cutting move (G1); the feed must be greater than zero",
                                   "feed-zero");
  EXPECT_EQ(to_string(d),
            "part.nc:2:20: error: F0 on a cutting move (G1); the feed must be greater than zero [feed-zero]\n"
            "    N120 G1 X40. Y12.5 F0\n"
            "                       ^");
}

TEST(Diagnostics, CountLinesWithCrLfAndWithoutALastLineEnd) {
  const SourceText source("a", "G0\r\n\r\nX1");
  EXPECT_EQ(source.line_count(), 3u);
  EXPECT_EQ(source.line(1), "G0");
  EXPECT_EQ(source.line(2), "");
  EXPECT_EQ(source.line(3), "X1");
  EXPECT_EQ(source.location(6).line, 3u);
}

TEST(Diagnostics, ControlCharactersDoNotReachTheTerminal) {
  const SourceText source("a\x1b[2J.nc", "\tX\x1b[31m\x07 (\xc3\xa4 \xc2\x9b \x9b) F0\x7f\n");
  EXPECT_EQ(to_string(source.diagnostic(Severity::error, 18, "F\x1b[0m is\nzero", "c")),
            "a?[2J.nc:1:19: error: F?[0m is\nzero [c]\n"
            "    \tX?[31m? (\xc3\xa4 ?? ?) F0?\n"
            "    \t                 ^");
}

TEST(Diagnostics, AFileWithoutAnEndIsRefused) {
  try {
    SourceText::read("/dev/zero");
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "/dev/zero: error: does not end after a gigabyte; a file was expected, or a pipe that ends "
                 "[file-unreadable]");
  }
}

TEST(Diagnostics, StopAtTheTwentiethError) {
  Diagnostics all;
  for (int i = 0; i < 19; ++i) all.add({Severity::error, {"f", 1, 1}, "m", "c", ""});
  EXPECT_THROW(all.add({Severity::error, {"f", 1, 1}, "m", "c", ""}), InputError);
  EXPECT_EQ(all.errors(), 20u);
}

TEST(SourceText, FindsEveryPlaceOfALongText) {
  for (const std::string end : {"", "\n", "\n\n", "\r\n"}) {
    std::string text;
    for (int i = 0; i < 200; ++i) text += std::string(static_cast<std::size_t>(i % 7), 'x') + (i % 3 ? "\n" : "\r\n");
    text += "last" + end;
    const SourceText source("a", text);
    std::size_t line = 1, column = 1;
    std::string of_line;
    for (std::size_t at = 0; at < text.size(); ++at) {
      const SourceLocation found = source.location(at);
      ASSERT_EQ(std::pair(found.line, found.column), std::pair(line, column)) << at;
      if (text[at] != '\n') {
        of_line += text[at];
        ++column;
        continue;
      }
      while (of_line.ends_with('\r')) of_line.pop_back();
      ASSERT_EQ(source.line(line), of_line);
      of_line.clear();
      if (at + 1 < text.size()) ++line;
      column = 1;
    }
    EXPECT_EQ(source.line_count(), line);
    EXPECT_EQ(source.line(line + 1), "");
    EXPECT_EQ(source.location(text.size() + 10).line, line);
  }
}

TEST(SourceText, NamesTheMissingFile) {
  try {
    SourceText::read("/nowhere/p.nc");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "/nowhere/p.nc: error: no such file [file-missing]");
  }
}

}  // namespace
}  // namespace camber
