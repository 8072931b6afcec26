// A job's text as a form, and edits of single lines.
#include <gtest/gtest.h>

#include "ui/folder.h"

namespace camber::ui {
namespace {

const std::string kJob =
    "# A job. What is marked CHECK is an assumption.\n"
    "program = \"p.nc\"\n"
    "machine = \"preset:vmc-40\"         # typical values of a class\n"
    "# operations = { tools = [1] }    # only these\n"
    "\n"
    "[tool.1]\n"
    "# Line 4: 3 cutting moves.\n"
    "# CHECK: the program mills with this drill.\n"
    "type = \"flat\"\n"
    "flutes = 2                        # typical: count them\n"
    "note = \"a # in \\\"quotes\\\"\"  # plain\n"
    "assumed = [\"flutes\", \"helix_deg\"] # take out what you have put in\n"
    "\n"
    "[stock]\n"
    "box_mm = [[0, 0, 0],\n"
    "          [1, 2, 3]]\n"
    "# allowance_mm = 0.2              # left by the pass before\n";

const JobField& field(const std::vector<JobField>& fields, std::string_view table, std::string_view key) {
  for (const JobField& f : fields)
    if (f.table == table && f.key == key) return f;
  throw std::out_of_range(std::string(key));
}

TEST(JobForm, ReadsSettingsWithCommentsAndWhatIsGuessed) {
  const auto fields = job_fields(kJob);
  EXPECT_EQ(fields.size(), 8u);
  EXPECT_EQ(field(fields, "", "program").value, "\"p.nc\"");
  EXPECT_FALSE(field(fields, "", "program").guessed);
  EXPECT_TRUE(field(fields, "", "machine").guessed);
  EXPECT_EQ(field(fields, "", "machine").comment, "typical values of a class");
  EXPECT_TRUE(field(fields, "", "operations").is_default);
  const JobField& type = field(fields, "tool.1", "type");
  EXPECT_EQ(type.note, "Line 4: 3 cutting moves.\nCHECK: the program mills with this drill.");
  EXPECT_TRUE(type.guessed);
  EXPECT_EQ(type.line, 9u);
  EXPECT_TRUE(field(fields, "tool.1", "flutes").guessed);
  EXPECT_EQ(field(fields, "tool.1", "note").value, "\"a # in \\\"quotes\\\"\"");
  EXPECT_EQ(field(fields, "stock", "box_mm").value, "[[0, 0, 0],\n[1, 2, 3]]");
  EXPECT_EQ(field(fields, "stock", "allowance_mm").value, "0.2");
  EXPECT_EQ(field_text(fields, "", "machine"), "preset:vmc-40");
  EXPECT_EQ(field_text(fields, "tool.1", "note"), "a # in \"quotes\"");
  EXPECT_EQ(field_text(fields, "stock", "allowance_mm"), "");
}

std::string edited(std::initializer_list<JobEdit> edits, const std::string& text = kJob) {
  return with_edits(text, std::vector<JobEdit>(edits));
}
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}
using Kind = JobEdit::Kind;

TEST(JobForm, ChangesOneLineAndItsMarks) {
  EXPECT_EQ(edited({}), kJob);
  EXPECT_EQ(edited({{Kind::set, "tool.1", "flutes", "4"}}),
            replaced(replaced(kJob, "flutes = 2                        # typical: count them", "flutes = 4"),
                     "[\"flutes\", \"helix_deg\"] #", "[\"helix_deg\"]           #"));
}

TEST(JobForm, SetsADefaultInItsPlaceAndAddsLinesAndTables) {
  EXPECT_EQ(edited({{Kind::set, "stock", "allowance_mm", "0.1"}}),
            replaced(kJob, "# allowance_mm = 0.2  ", "allowance_mm = 0.1    "));
  EXPECT_EQ(edited({{Kind::set, "stock", "mesh", "\"b.stl\""}}),
            replaced(kJob, "[1, 2, 3]]\n", "[1, 2, 3]]\nmesh = \"b.stl\"\n"));
  EXPECT_EQ(edited({{Kind::set, "part", "mesh", "\"p.stl\""}}), kJob + "\n[part]\nmesh = \"p.stl\"\n");
  EXPECT_EQ(edited({{Kind::set, "", "units", "\"mm\""}}),
            replaced(kJob, "# typical values of a class\n", "# typical values of a class\nunits = \"mm\"\n"));
}

TEST(JobForm, RemovesAndConfirms) {
  EXPECT_EQ(edited({{Kind::remove, "stock", "box_mm"}}),
            replaced(kJob, "box_mm = [[0, 0, 0],\n          [1, 2, 3]]\n", ""));
  const auto fields = job_fields(edited({{Kind::confirm, "tool.1", "flutes"}, {Kind::confirm, "tool.1", "type"}}));
  EXPECT_FALSE(field(fields, "tool.1", "flutes").guessed);
  EXPECT_EQ(field(fields, "tool.1", "flutes").value, "2");
  EXPECT_FALSE(field(fields, "tool.1", "type").guessed);
}

TEST(JobForm, DropsAListOfAssumptionsThatIsEmpty) {
  const std::string text = "[material]\npreset = \"C45\"\nassumed = [\"preset\"]\n";
  EXPECT_EQ(edited({{Kind::confirm, "material", "preset"}}, text), "[material]\npreset = \"C45\"\n");
}

TEST(JobForm, MakesTheBestOfTextThatIsNoToml) {
  for (const char* text : {"", "=", "[", "[[", "a = [1,", "a = \"", "# = #", "[x\na=1", "\r\n\r\n"}) {
    job_fields(text);
    EXPECT_NE(edited({{Kind::set, "t", "k", "1"}}, text).find("k = 1"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace camber::ui
