// The pages that predict and compensate write: their numbers are those of the JSON.
#include <gtest/gtest.h>

#include "tests/support/open_page.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::run_camber;
using tests::TempFolder;

void write_job(const TempFolder& folder) {
  std::string program = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\n";
  for (const char* y : {"0.5", "0.8", "1.1"})
    program += std::string("G0 X4. Y") + y + " Z3.\nG1 Z-0.3 F300\nX-1. F900\nG0 Z3.\n";
  folder.write("p.nc", program + "M30\n");
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n[axis.y]\n[axis.z]\n");
  folder.write("material.toml", "# ktc_MPa: 2000 +- 12 MPa\n[material]\nktc_MPa = 2000.0\nkrc_MPa = 700.0\n");
  folder.write("job.toml", R"(program = "p.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 30.0
[material]
file = "material.toml"
[stock]
box_mm = [[0, 0, -1], [3, 2, 0]]
[simulation]
voxel_mm = 0.2
[compensation]
max_rounds = 1
)");
}

TEST(ReportNumbers, OfPredictAreThoseOfItsSummary) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  write_job(folder);
  ASSERT_EQ(run_camber(folder, "predict job.toml -o result").status, 0);
  EXPECT_EQ(tests::open_page("numbers", folder / "result/report.html", folder / "result/summary.json"), "");
}

TEST(ReportNumbers, OfCompensateAreThoseOfItsJson) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "compensate job.toml -o out.nc --report report.html --json figures.json");
  ASSERT_NE(run.status, 1) << run.err;  // one round need not reach the tolerance
  EXPECT_EQ(tests::open_page("numbers", folder / "report.html", folder / "figures.json"), "");
}

TEST(ReportText, NamesInputsModelAndStandardErrors) {
  const TempFolder folder;
  write_job(folder);
  ASSERT_EQ(run_camber(folder, "predict job.toml -o result").status, 0);
  const std::string page = tests::file_text(folder / "result/report.html");
  for (const char* text :
       {"<tr><td>ktc_MPa</td><td>2000</td><td>± 12</td><td>MPa</td></tr>",
        "<tr><td>krc_MPa</td><td>700</td><td>not known</td><td>MPa</td></tr>", "<td>material.toml</td>",
        "<tr><td>diameter, mm</td><td>6</td></tr>", "<tr><td>acceleration</td><td>500</td><td>no limit</td>",
        "<tr><td>computed by</td><td>camber "})
    EXPECT_NE(page.find(text), std::string::npos) << text;
}

}  // namespace
}  // namespace camber
