// Sections of programs that are too long to be kept: timed again for each section, with the same bytes in its parts.
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "api/merged_sections.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

namespace fs = std::filesystem;
using tests::replaced;
using tests::TempFolder;

const std::string kJob =
    "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"ball\"\ndiameter_mm = 4.0\nflutes = 3\n"
    "overhang_mm = 25.0\n[tool.2]\ntype = \"flat\"\ndiameter_mm = 3.0\nflutes = 2\noverhang_mm = 20.0\n"
    "[tool.3]\ntype = \"drill\"\ndiameter_mm = 3.0\nflutes = 2\noverhang_mm = 30.0\n[material]\n"
    "ktc_MPa = 800.0\nkrc_MPa = 250.0\nkte_N_per_mm = 5.0\nkre_N_per_mm = 5.0\n[stock]\n"
    "box_mm = [[0, -3, -3], [330, 3, 0]]\nallowance_mm = 0.2\n[simulation]\nvoxel_mm = 0.4\ncoupling = \"rigid\"\n";

/// Rows of a ball in three places far from each other, a hole in each, and a slot of a flat end mill through the first
/// rows: what a section reads was cut long before, or far away.
std::string program(double shift_mm = 0) {
  std::string out = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X-4 Y-2 Z5\n";
  for (const int place : {0, 150, 300})
    for (int row = 0; row < 3; ++row) {
      const std::string y = std::to_string(-1 + 0.7 * row + shift_mm);
      out += "G0 X" + std::to_string(place - 4) + " Y" + y + "\nG0 Z-1\nG1 X" + std::to_string(place + 18) +
             " F900\nG0 Z5\n";
    }
  out += "T3 M6\nS3000 M3\nG0 Z5\n";
  for (const int place : {10, 160, 310}) out += "G81 X" + std::to_string(place) + " Y0 Z-2.5 R1 F100\n";
  return out + "G80\nT2 M6\nS6000 M3\nG0 X-4 Y1 Z5\nG0 Z-1.6\nG1 X18 F600\nG0 Z5\nM30\n";
}

void write_all(const TempFolder& folder, const std::string& job) {
  folder.write("p.nc", program());
  folder.write("job.toml", job);
  folder.write("machine.toml",
               "[axis.x]\nacceleration_mm_per_s2 = 3000\n[axis.y]\nacceleration_mm_per_s2 = 3000\n[axis.z]\n"
               "acceleration_mm_per_s2 = 3000\n[spindle]\nmax_rpm = 12000\n");
}

constexpr std::size_t kSections = 3, kShort = 500;

machine::Job read(const TempFolder& folder) {
  Diagnostics diagnostics;
  machine::Job job = machine::read_job(folder / "job.toml", diagnostics);
  EXPECT_FALSE(diagnostics.has_errors());
  return job;
}

/// Every part of a prediction in sections, by name. A run for each part, as processes have it, or one for all.
std::map<std::string, std::string> parts(const TempFolder& folder, const std::string& into, std::size_t longest_path,
                                         int rounds, bool keeps_programs) {
  const machine::Job job = read(folder);
  const distribute::PartKey key = distribute::part_key(job, kSections, 0);
  distribute::PartFiles store(folder / into, key);
  for (int round = 0; round <= rounds; ++round)
    for (std::size_t section = 0; section < kSections; ++section) {
      Diagnostics diagnostics;
      distribute::SectionRun run(job, key, store, {}, diagnostics, longest_path);
      EXPECT_TRUE(round == 0 ? run.sweep(section) : run.solve(section, round));
      EXPECT_FALSE(diagnostics.has_errors());
      EXPECT_EQ(run.take_programs() != nullptr, keeps_programs);
    }
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::directory_iterator(folder / (into + "/parts")))
    out[entry.path().filename().string()] = tests::file_text(entry.path().string());
  return out;
}

void expect_same_parts(const std::string& job, int rounds, std::size_t files) {
  const TempFolder folder;
  write_all(folder, job);
  folder.write("original.nc", program(0.02));
  const auto whole = parts(folder, "whole", distribute::SectionRun::kWholePath, rounds, true),
             thin = parts(folder, "thin", kShort, rounds, false);
  ASSERT_EQ(whole.size(), files);
  ASSERT_EQ(thin.size(), files);
  for (const auto& [name, bytes] : whole) EXPECT_TRUE(bytes == thin.at(name)) << name;
}

TEST(SectionsOfLongPrograms, HaveTheSameBytes) { expect_same_parts(kJob, 1, 3 * kSections); }

TEST(SectionsOfLongPrograms, HaveTheSameBytesAgainstAnotherProgram) {
  expect_same_parts(kJob + "[part]\nprogram = \"original.nc\"\n", 1, 3 * kSections);
}

TEST(SectionsOfLongPrograms, HaveTheSameBytesInRounds) {
  expect_same_parts(replaced(kJob, "\"rigid\"", "\"static\""), 2, 6 * kSections);
}

TEST(SectionsOfLongPrograms, KeepWhatLiesNearTheSection) {
  const TempFolder folder;
  write_all(folder, kJob);
  const machine::Job job = read(folder);
  Diagnostics diagnostics;
  distribute::SectionPrograms programs(job, {.longest_path = 20, .check = {}},
                                       {.program = diagnostics, .original = diagnostics, .target = diagnostics});
  ASSERT_TRUE(programs.thin());
  EXPECT_TRUE(programs.program().text().blocks.empty());
  const std::size_t all = programs.outline()->stamps;
  for (std::size_t section = 0; section < 9; ++section) {
    programs.go_to(section, 9);
    std::size_t kept = 0;
    for (const ListRange& range : *programs.path().kept) kept += range.end - range.from;
    EXPECT_GT(kept, all / 9) << section;
    const bool has_holes = section >= 6;  // a run of its own, all along the stock
    EXPECT_LT(kept, has_holes ? all + 1 : all * 5 / 6) << section;
  }
  distribute::SectionPrograms whole(job, {}, {.program = diagnostics, .original = diagnostics, .target = diagnostics});
  EXPECT_FALSE(whole.thin());
  EXPECT_EQ(whole.path().stamps.size(), all);
}

}  // namespace
}  // namespace camber
