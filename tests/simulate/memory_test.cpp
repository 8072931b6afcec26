#include "simulate/memory.h"

#include <gtest/gtest.h>

namespace camber::simulate {
namespace {

machine::Job job_with(machine::ToolType type) {
  machine::Job job;
  job.path = "job.toml";
  machine::Tool tool;
  tool.number = 1;
  tool.type = type;
  tool.diameter_mm = 10;
  tool.overhang_mm = 40;
  job.tools[1] = tool;
  job.simulation.voxel_mm = 0.2;
  return job;
}

/// Rows along X at the given height, 1 mm apart.
removal::StampPath rows(double from_y, double to_y, double length_mm, double z) {
  removal::StampPath path;
  for (double y = from_y; y <= to_y; y += 1)
    for (double x = 0; x <= length_mm; x += 0.5) {
      removal::Stamp s;
      s.pose.tip_mm = {x, y, z};
      path.stamps.push_back(s);
    }
  path.runs = {{1, 0, path.stamps.size(), removal::RunKind::milling}};
  return path;
}

constexpr double kAreaTolerance = 0.1;  // cells of 3.2 mm

TEST(Memory, AreaOfAFacedTopIsThatOfTheTop) {
  const StockSize stock{{0, 0, -20}, {200, 100, 0}, 4};
  const double area = cut_area_mm2(job_with(machine::ToolType::flat), rows(0, 100, 200, -1), stock);
  EXPECT_NEAR(area, 200 * 100, kAreaTolerance * 200 * 100);
}

TEST(Memory, AreaOfASlotHasItsWalls) {
  const StockSize stock{{0, -100, -40}, {400, 100, 0}, 4};
  const double area = cut_area_mm2(job_with(machine::ToolType::flat), rows(0, 0.5, 400, -30), stock);
  const double slot = 400 * (10 + 2 * 30);
  EXPECT_NEAR(area, slot, 2 * kAreaTolerance * slot);
}

TEST(Memory, IsRefusedWithTheVoxelsThatFit) {
  machine::Job job = job_with(machine::ToolType::ball);
  job.simulation.max_memory_GB = 1.0;
  job.voxel_place.location = {"job.toml", 7, 12};
  MemoryFactors factors{.stamps = 1000, .size_mm = {500, 500, 100}, .band_mm = 0.8, .cut_mm2 = 250000};
  Diagnostics diagnostics;
  const MemoryEstimate needed = check_memory(job, factors, diagnostics);
  EXPECT_GT(needed.total(), 1e9);
  ASSERT_EQ(diagnostics.errors(), 1u);
  const Diagnostic& said = diagnostics.all().front();
  EXPECT_EQ(said.check, "voxel-memory");
  EXPECT_EQ(said.location.line, 7u);
  EXPECT_EQ(said.location.column, 12u);
  const std::size_t at = said.message.find("; voxel_mm = ");
  ASSERT_NE(at, std::string::npos) << said.message;
  const double fits_mm = std::stod(said.message.substr(at + 13));
  EXPECT_GT(fits_mm, 0.2);
  EXPECT_LT(estimate_memory(factors, fits_mm).total(), 1e9);
  EXPECT_GT(estimate_memory(factors, fits_mm / 1.4).total(), 0.9e9) << "no coarser than needed: " << said.message;

  job.simulation.voxel_mm = fits_mm;
  Diagnostics none;
  check_memory(job, factors, none);
  EXPECT_TRUE(none.all().empty());
}

TEST(Memory, OfASectionIsThatOfItsRegion) {
  const machine::Job job = job_with(machine::ToolType::flat);
  const StockSize stock{{0, 0, -100}, {500, 500, 0}, 4};
  const removal::StampPath path = rows(0, 500, 500, -1);
  removal::Region quarter;
  quarter.add(Vec3(-50, -50, -20));
  quarter.add(Vec3(250, 250, 1e9));
  const nc::Program text;
  const nc::Interpretation moves;
  const MemoryFactors whole = memory_factors(job, text, moves, path, stock),
                      section = memory_factors(job, text, moves, path, stock, &quarter);
  EXPECT_FALSE(whole.blank_mm2);
  // The top, and two sides down to the region's end.
  EXPECT_DOUBLE_EQ(section.blank_mm2.value(), 250 * 250 + 2 * 250 * 20);
  EXPECT_NEAR(section.cut_mm2, whole.cut_mm2 / 4, kAreaTolerance * whole.cut_mm2 / 4);
  EXPECT_NEAR(static_cast<double>(*section.own_stamps), static_cast<double>(whole.stamps) / 4,
              0.02 * static_cast<double>(whole.stamps));
  EXPECT_EQ(section.stamps, whole.stamps) << "every process has the whole path";
  const MemoryEstimate of_whole = estimate_memory(whole, 0.2), of_section = estimate_memory(section, 0.2);
  EXPECT_LT(of_section.blank, 0.11 * of_whole.blank);
  EXPECT_LT(of_section.total(), 0.4 * of_whole.total());

  // Nothing of the stock in the region: the program alone.
  const removal::Region nothing;
  EXPECT_EQ(memory_factors(job, text, moves, path, stock, &nothing).blank_mm2.value(), 0);
}

TEST(Memory, FlatFacesTakeTheirRoomOnlyWhereTheyAreMadeAndWritten) {
  machine::Job job = job_with(machine::ToolType::flat);
  const StockSize stock{{0, 0, -100}, {500, 500, 0}, 4};
  const removal::StampPath path = rows(0, 500, 500, -1);
  const nc::Program text;
  const nc::Interpretation moves;
  const MemoryEstimate mesh = estimate_memory(memory_factors(job, text, moves, path, stock), 0.2);
  job.stock.box = {{0, 0, -100}, {500, 500, 0}};
  const MemoryEstimate box = estimate_memory(memory_factors(job, text, moves, path, stock), 0.2);
  EXPECT_LT(box.total(), mesh.total() - 0.4e9);
  EXPECT_GT(box.total(), field_bytes(Vec3(500, 500, 100), 0.2, 4));
}

TEST(Memory, OfALongProgramAloneCannotBeMadeSmallerByVoxels) {
  machine::Job job = job_with(machine::ToolType::ball);
  job.simulation.max_memory_GB = 1.0;
  Diagnostics diagnostics;
  check_memory(job, {.stamps = 100000000, .size_mm = {50, 50, 10}, .band_mm = 0.8, .cut_mm2 = 2500}, diagnostics);
  ASSERT_EQ(diagnostics.errors(), 1u);
  EXPECT_NE(diagnostics.all().front().message.find("; a shorter program or more memory was expected"),
            std::string::npos);
}

}  // namespace
}  // namespace camber::simulate
