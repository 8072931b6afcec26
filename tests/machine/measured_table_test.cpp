#include "machine/measured_table.h"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <map>

#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

namespace camber::machine {
namespace {

using tests::replaced;
using tests::TempFolder;

std::string message_of(const std::function<void(const std::string&)>& read, const std::string& name,
                       const std::string& text) {
  const TempFolder folder;
  const std::string path = folder.write(name, text);
  try {
    read(path);
  } catch (const InputError& problem) {
    return replaced(problem.what(), folder.path() + "/", "");
  }
  return {};
}

std::string csv_message(const std::string& text) {
  return message_of([](const std::string& p) { read_measured_csv(p, {}); }, "m.csv", text);
}
std::string qif_message(const std::string& text) {
  return message_of([](const std::string& p) { read_qif(p); }, "m.qif", text);
}

/// The rows of a file of tests/data/qif/features.csv as text.
std::multimap<std::string, std::string> expected_rows() {
  std::multimap<std::string, std::string> out;
  const SourceText csv = SourceText::read(tests::data_path("qif/features.csv"));
  for (std::size_t i = 2; i <= csv.line_count(); ++i) {
    std::string row(csv.line(i));
    if (!row.empty() && row.back() == '\r') row.pop_back();
    if (!row.empty()) out.emplace(row.substr(0, row.find(',')), row.substr(row.find(',') + 1));
  }
  return out;
}

TEST(Qif, FindsEveryRowOfTheTwoInspections) {
  const auto expected = expected_rows();
  ASSERT_EQ(expected.size(), 36u);
  for (const std::string file : {"plate_01.qif", "plates_13_19.qif"}) {
    const auto values = read_qif(tests::unpacked_data("qif/" + file));
    auto [row, end] = expected.equal_range(file);
    ASSERT_EQ(values.size(), expected.count(file));
    for (const MeasuredValue& v : values) {
      EXPECT_EQ(fmt::format("{},{},{},{},{},{},{},{}", v.part, v.feature, v.kind, *v.nominal_mm, *v.lower_mm,
                            *v.upper_mm, v.value_mm, v.status),
                row->second);
      ++row;
    }
  }
}

TEST(Qif, ByteOrderMarkAndPrefixesAreMet) {
  std::string text = SourceText::read(tests::unpacked_data("qif/plate_01.qif")).text();
  const TempFolder folder;
  const std::string marked = folder.write("m.qif", "\xEF\xBB\xBF" + text);
  EXPECT_EQ(read_qif(marked).size(), 16u);
  text = replaced(replaced(replaced(text, "<", "<q:"), "<q:/", "</q:"), "<q:?xml", "<?xml");
  text = replaced(text, "xmlns=", "xmlns:q=");
  EXPECT_EQ(read_qif(folder.write("p.qif", text)).size(), 16u);
}

TEST(Qif, SizesAreInThePrimaryUnitOfTheFile) {
  const TempFolder folder;
  const std::string text = SourceText::read(tests::unpacked_data("qif/plate_01.qif")).text();
  const auto with_units = [&](const std::string& primary, const std::string& other) {
    std::string out = text;
    const auto unit = [](const std::string& name) {
      return "<LinearUnit><UnitName>" + name + "</UnitName></LinearUnit>";
    };
    out.insert(out.find('>', out.find("<QIFDocument")) + 1, "<FileUnits><PrimaryUnits>" + unit(primary) +
                                                                "</PrimaryUnits><OtherUnits>" + unit(other) +
                                                                "</OtherUnits></FileUnits>");
    return read_qif(folder.write("u.qif", out)).front().value_mm;
  };
  EXPECT_NEAR(with_units("Inch", "mm") / with_units("mm", "inch"), 25.4, 1e-12);
}

TEST(Qif, BadFilesSayWhatWasExpected) {
  EXPECT_EQ(qif_message("<a></b>"),
            "m.qif:1:6: error: not well-formed XML (Start-end tags mismatch); QIF results were expected [qif-results]\n"
            "    <a></b>\n         ^");
  EXPECT_EQ(qif_message("<html/>"), "m.qif: error: begins with <html>; a <QIFDocument> was expected [qif-results]");
  EXPECT_EQ(qif_message("<QIFDocument/>"),
            "m.qif: error: has no <MeasurementResults>; the results of a measurement were expected [qif-results]");
  EXPECT_EQ(
      qif_message("<QIFDocument><MeasurementResults><DiameterCharacteristicActual id=\"4\"><CharacteristicItemId>9"
                  "</CharacteristicItemId><Value>2</Value></DiameterCharacteristicActual></MeasurementResults>"
                  "</QIFDocument>"),
      "m.qif: error: <DiameterCharacteristicActual id=\"4\"> names the item \"9\", which is not there "
      "[qif-results]");
}

TEST(MeasuredCsv, ReadsQuotesCommentsAndRowsWithoutAValue) {
  const TempFolder folder;
  const auto values = read_measured_csv(
      folder.write("m.csv",
                   "# Mitutoyo\r\nfeature,part,value_mm,lower_mm\r\n\"A, top\",1,4.5,4.4\r\nB,1,,\r\nC,2,-1,\r\n"),
      {});
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values[0].feature, "A, top");
  EXPECT_EQ(values[0].value_mm, 4.5);
  EXPECT_EQ(values[0].lower_mm, 4.4);
  EXPECT_EQ(values[1].feature, "C");
  EXPECT_EQ(values[1].part, "2");
}

TEST(MeasuredCsv, ColumnMapNamesColumnsUnitAndSeparator) {
  const TempFolder folder;
  const std::string map = folder.write(
      "map.toml", "feature = \"Merkmal\"\nvalue = \"Ist\"\npart = \"Teil\"\nseparator = \";\"\nunit = \"inch\"\n");
  Diagnostics diagnostics;
  const auto values = read_measured_table(folder.write("m.csv", "Teil;Merkmal;Ist\n3;D1;0.5\n"), map, diagnostics);
  ASSERT_EQ(values.size(), 1u);
  EXPECT_EQ(values[0].feature, "D1");
  EXPECT_EQ(values[0].part, "3");
  EXPECT_NEAR(values[0].value_mm, 12.7, 1e-12);
}

/// As a spreadsheet of a country with decimal commas saves a table.
TEST(MeasuredCsv, ReadsDecimalCommasBetweenSemicolonsAndValuesThatAreNotThere) {
  const TempFolder folder;
  const auto values = read_measured_csv(
      folder.write("m.csv", "feature;part;date;value_mm\r\nA;1;;3,9965\r\nB;1;;---\r\nC;1;;N/A\r\nD;1;;-0.5\r\n"), {});
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values[0].value_mm, 3.9965);
  EXPECT_EQ(values[1].feature, "D");
  EXPECT_EQ(values[1].value_mm, -0.5);
  EXPECT_EQ(read_measured_csv(folder.write("q.csv", "feature,value_mm\nA,\"4,25\"\n"), {}).front().value_mm, 4.25);
}

TEST(MeasuredCsv, BadTablesSayWhatWasExpected) {
  EXPECT_EQ(csv_message("feature,value_mm\nA,3,996\n"),
            "m.csv:2:5: error: the row has 3 cells, the header 2; as many were expected (numbers with a decimal comma: "
            "in quotes, or columns separated by ;) [measured-table]\n"
            "    A,3,996\n        ^");
  EXPECT_EQ(csv_message("feature;value_mm\nA;1.234,5\n"),
            "m.csv:2:3: error: value_mm is \"1.234,5\"; a number was expected [measured-table]\n"
            "    A;1.234,5\n      ^");
  EXPECT_EQ(csv_message(""),
            "m.csv:1:1: error: is empty; a header that names the columns was expected [measured-table]");
  EXPECT_EQ(csv_message("name,value\nA,1\n"),
            "m.csv:1:1: error: the header has no column \"feature\"; it has name, value [measured-table]\n"
            "    name,value\n    ^");
  EXPECT_EQ(csv_message("feature,value_mm\nA,four\n"),
            "m.csv:2:3: error: value_mm is \"four\"; a number was expected [measured-table]\n"
            "    A,four\n      ^");
  EXPECT_EQ(csv_message("feature,value_mm\n,4\n"),
            "m.csv:2:1: error: the row has a value and no feature; a name was expected [measured-table]\n"
            "    ,4\n    ^");
}

}  // namespace
}  // namespace camber::machine
