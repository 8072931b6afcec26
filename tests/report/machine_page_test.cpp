// The page of a machine with rotary axes.
#include "report/machine_page.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "base/units.h"
#include "kinematics/chain.h"
#include "tests/kinematics/machines.h"
#include "tests/support/open_page.h"
#include "tests/support/temp_folder.h"

namespace camber::report {
namespace {

using kinematics::Joints;
using kinematics::PoseSample;

/// A run of all axes; line n + 1 at sample n. B leaves its travel at `tilt_deg` above its limit.
std::vector<PoseSample> run_of(const machine::Machine& machine, double tilt_deg, std::size_t count = 200) {
  const kinematics::Chain chain(machine);
  std::vector<PoseSample> out;
  for (std::size_t i = 0; i < count; ++i) {
    const double u = static_cast<double>(i) / static_cast<double>(count - 1);
    Joints q;
    q.linear_mm = {40 * std::sin(6 * u), 30 * u, -150 + 20 * u};
    q.rotary_rad = {0, rad_from_deg(tilt_deg) * u, 4 * u};
    out.push_back({10 * u, static_cast<int>(i) + 1, chain.pose(q, 80), q});
  }
  return out;
}

TEST(MachinePage, NamesTheFirstLineBeyondTheTravel) {
  const machine::Machine machine = kinematics::tests::sample("table_bc");
  const auto samples = run_of(machine, 120, 121);  // a degree for each line; 110 are allowed
  const TextTable table = axis_table(machine, samples);
  ASSERT_EQ(table.rows.size(), 5U);
  EXPECT_EQ(table.rows[3],
            (std::vector<std::string>{"B", "degrees", "0.000", "120.000", "\u221235.000", "110.000", "112"}));
  EXPECT_EQ(table.rows[4].back(), "none");
  EXPECT_EQ(table.rows[4][4], "unlimited");
}

TEST(MachinePage, KeepsTheExtremesWhereItLeavesSamplesOut) {
  const machine::Machine machine = kinematics::tests::sample("table_bc");
  auto samples = run_of(machine, 30, 1000);
  samples[333].joints.linear_mm.x() = 77.125;
  const std::string page = machine_page(machine, samples, {.title = "p", .max_samples = 50});
  EXPECT_NE(page.find("positions; the extremes of every axis are among them"), std::string::npos);
  EXPECT_NE(page.find(",77.125]"), std::string::npos);  // of X, among the positions shown
  EXPECT_EQ(page, machine_page(machine, samples, {.title = "p", .max_samples = 50}));
  EXPECT_LT(page.size(), machine_page(machine, samples, {.title = "p"}).size());
}

TEST(MachinePage, WithoutPositionsSaysWhatIsMissing) {
  const std::string page = machine_page(kinematics::tests::sample("head_head"), {}, {.title = "p"});
  EXPECT_NE(
      page.find("The positions of the axes are not known: the work offset, or the length of the tool, is missing."),
      std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
}

TEST(MachinePage, FollowsSliderPlotsAndPlayButtonOnEveryMachine) {
  CAMBER_NEEDS_BROWSER();
  const tests::TempFolder folder;
  for (const char* name : {"table_bc", "nutating_head"}) {
    const machine::Machine machine = kinematics::tests::sample(name);
    write_machine_page(folder / "r.html", machine, run_of(machine, 40), {.title = name});
    EXPECT_EQ(tests::open_page("machine", folder / "r.html"), "") << name;
  }
}

}  // namespace
}  // namespace camber::report
