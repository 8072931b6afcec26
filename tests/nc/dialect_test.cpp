// The table of dialects: properties that every row has.
#include "nc/dialect.h"

#include <set>

#include <fmt/format.h>

#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

TEST(Dialects, AreFoundByUniqueNames) {
  std::set<std::string_view> names, titles;
  for (const Dialect& dialect : dialects()) {
    EXPECT_EQ(dialect_named(dialect.name), &dialect);
    EXPECT_TRUE(names.insert(dialect.name).second) << dialect.name;
    EXPECT_TRUE(titles.insert(dialect.title).second) << dialect.title;
  }
  EXPECT_EQ(dialect_named(""), nullptr);
  EXPECT_EQ(dialect_named("Fanuc"), nullptr);
}

/// Those of RS-274.
std::vector<Dialect> iso_dialects() {
  std::vector<Dialect> out;
  std::ranges::copy_if(dialects(), std::back_inserter(out),
                       [](const Dialect& dialect) { return dialect.language == LanguageId::iso; });
  return out;
}

TEST(Dialects, ReadAPlainProgramAlike) {
  for (const Dialect& dialect : iso_dialects()) {
    SCOPED_TRACE(dialect.name);
    const Read r = read_clean(
        "G21 G17 G90 G94 G40 G49 G80\nG54 S6000 M3\nG0 X0 Y0 Z5.\nG1 Z-1. F100\nG2 X10. I5.\nM30\n", as(dialect.name));
    ASSERT_EQ(r.moves.moves.size(), 3u);
    expect_near_mm(r.moves.moves.back().end_mm, {10, 0, -1});
  }
}

TEST(Dialects, ReadTheProgramNumberAndEndThatTheyWrite) {
  for (const Dialect& dialect : iso_dialects()) {
    SCOPED_TRACE(dialect.name);
    const std::string number = dialect.has_program_number ? "O0001\n" : "";
    const std::string path = dialect.g64_p_is_tolerance ? "G64 P0.01\n" : "";
    const std::string end(dialect.program_end);
    const Read r = read_text("%\n" + number + path + "G0 X0 Y0 Z0\n" + end + "\nX7\n%\n", as(dialect.name));
    const auto line = std::to_string(4 + !number.empty() + !path.empty());
    EXPECT_EQ(r.messages,
              Messages{"p.nc:" + line +
                       ":1: warning: the blocks after the end of the program (M2, M30) are not run [after-end]"});
    EXPECT_EQ(r.moves.moves.size(), 1u);
  }
}

TEST(Dialects, ReadADwellInTheirUnit) {
  for (const Dialect& dialect : iso_dialects())
    EXPECT_EQ(read_clean("G0 X0 Y0 Z0\nG4 P50\n", as(dialect.name)).moves.moves.back().dwell_s,
              dialect.dwell_p_is_ms ? 0.05 : 50)
        << dialect.name;
}

TEST(Dialects, LimitNestedCalls) {
  for (const Dialect& dialect : iso_dialects())
    EXPECT_EQ(read_text("M98 P1\nM30\nO1\nM98 P1\nM99\n", as(dialect.name)).messages,
              Messages{fmt::format(
                  "p.nc:4:1: error: calls nested deeper than {} levels; a {} control reads no more [call-depth]",
                  dialect.max_levels, dialect.name)});
}

TEST(Dialects, AreRecognisedByTheirOwnConstructs) {
  const auto shown = [](const std::string& text) { return dialect_shown_by(read_text(text).program); };
  for (const Dialect& dialect : dialects()) {
    SCOPED_TRACE(dialect.name);
    EXPECT_EQ(shown("o1 if [1]\no1 endif\n") == &dialect, dialect.shown_by_o_words);
    EXPECT_EQ(shown("#<a>=1\n") == &dialect, dialect.shown_by_o_words);
    EXPECT_EQ(shown("M97 P5\nM30\nN5 M99\n") == &dialect, dialect.shown_by_m97);
  }
  EXPECT_EQ(shown("#1=[5 AND 2]\nG0 X#1\n"), nullptr);
  EXPECT_EQ(shown("G28.1\n"), dialect_named("linuxcnc"));
  EXPECT_EQ(dialect_shown_by(read_text("G0 X1\n", units(), "part.NGC").program), dialect_named("linuxcnc"));
}

}  // namespace
}  // namespace camber::nc
