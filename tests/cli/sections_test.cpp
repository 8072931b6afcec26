// camber predict --sections and camber merge: the same bytes whoever computes which part, and parts that are refused.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "camber/sections.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

namespace fs = std::filesystem;
using tests::CamberRun;
using tests::replaced;
using tests::run_camber;
using tests::TempFolder;

const std::string kMachine =
    "[axis.x]\nacceleration_mm_per_s2 = 3000\n[axis.y]\nacceleration_mm_per_s2 = 3000\n[axis.z]\n"
    "acceleration_mm_per_s2 = 3000\n[spindle]\nmax_rpm = 12000\n";
const std::string kJob =
    "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"ball\"\ndiameter_mm = 4.0\nflutes = 2\n"
    "overhang_mm = 25.0\n[tool.2]\ntype = \"flat\"\ndiameter_mm = 3.0\nflutes = 2\noverhang_mm = 20.0\n[material]\n"
    "ktc_MPa = 800.0\nkrc_MPa = 250.0\nkte_N_per_mm = 5.0\nkre_N_per_mm = 5.0\n[stock]\n"
    "box_mm = [[0, -3, -3], [14, 3, 0]]\nallowance_mm = 0.2\n[simulation]\nvoxel_mm = 0.4\ncoupling = \"rigid\"\n";

/// Rows of a ball, then a slot of a flat end mill: about seven pieces and two tools.
std::string program() {
  std::string out = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X-4 Y-2 Z5\n";
  for (int row = 0; row < 6; ++row) {
    const std::string y = std::to_string(-2 + 0.7 * row);
    out += "G0 X-4 Y" + y + "\nG0 Z-1\nG1 X18 F300\nG0 Z5\n";
  }
  return out + "T2 M6\nS6000 M3\nG0 X-4 Y1 Z5\nG0 Z-1.6\nG1 X18 F300\nG0 Z5\nM30\n";
}

void write_all(const TempFolder& folder, const std::string& job = kJob) {
  folder.write("p.nc", program());
  folder.write("job.toml", job);
  folder.write("machine.toml", kMachine);
}

/// Every result, but for the computing time.
std::map<std::string, std::string> results(const std::string& folder) {
  std::map<std::string, std::string> out;
  for (const char* name :
       {"feed.csv", "forces.csv", "form_error.csv", "form_error.vtp", "form_error.ply", "stock.vdb", "report.html"})
    out[name] = tests::file_text(folder + "/" + name);
  auto json = nlohmann::json::parse(tests::file_text(folder + "/summary.json"));
  json.erase("compute_s");
  out["summary.json"] = json.dump();
  return out;
}

void expect_same(const std::map<std::string, std::string>& a, const std::map<std::string, std::string>& b,
                 const std::string& what) {
  for (const auto& [name, text] : a) {
    EXPECT_FALSE(text.empty()) << name;
    EXPECT_TRUE(text == b.at(name)) << what << ": " << name << " differs";
    if (name == "summary.json" && text != b.at(name))
      ADD_FAILURE() << nlohmann::json::diff(nlohmann::json::parse(text), nlohmann::json::parse(b.at(name))).dump();
  }
}

std::string stage(const std::string& which, int section, int sections, const std::string& more = "") {
  return "-q predict job.toml -o parts --sections " + std::to_string(sections) + " --section " +
         std::to_string(section) + " --stage " + which + more;
}

TEST(Sections, GiveTheSameBytesForAnyNumber) {
  const TempFolder folder;
  write_all(folder);
  const CamberRun one = run_camber(folder, "predict job.toml -o one --sections 1");
  ASSERT_EQ(one.status, 0) << one.err;
  const auto expected = results(folder / "one");
  EXPECT_GE(nlohmann::json::parse(expected.at("summary.json")).at("sections").at("pieces"), 7);
  for (const int sections : {2, 3, 7, 16}) {
    const std::string n = std::to_string(sections);
    const CamberRun run = run_camber(folder, "predict job.toml -o many --sections " + n + " --threads 1");
    ASSERT_EQ(run.status, 0) << run.err;
    expect_same(expected, results(folder / "many"), n + " sections");
    fs::remove_all(folder / "many");
  }
  // Parts alone, in another order.
  for (const char* which : {"sweep", "solve"})
    for (const int section : {3, 1, 4, 2}) ASSERT_EQ(run_camber(folder, stage(which, section, 4)).status, 0);
  const CamberRun merge = run_camber(folder, "merge parts");
  ASSERT_EQ(merge.status, 0) << merge.err;
  expect_same(expected, results(folder / "parts"), "parts");
  // Without sections marks and sums begin elsewhere: figures agree but for rounding.
  ASSERT_EQ(run_camber(folder, "-q predict job.toml -o plain").status, 0);
  EXPECT_EQ(tests::file_text(folder / "plain/feed.csv"), expected.at("feed.csv"));
  const auto plain = nlohmann::json::parse(tests::file_text(folder / "plain/summary.json"));
  const auto joined = nlohmann::json::parse(expected.at("summary.json"));
  for (const char* figure : {"p95", "max", "min", "rms"})
    EXPECT_NEAR(joined.at("form_error_um").at(figure).get<double>(), plain.at("form_error_um").at(figure).get<double>(),
                0.002)
        << figure;
  EXPECT_NEAR(joined.at("removed_mm3").at("stock").get<double>() / plain.at("removed_mm3").at("stock").get<double>(), 1,
              1e-4);
  EXPECT_NEAR(joined.at("force_N").at("max").get<double>() / plain.at("force_N").at("max").get<double>(), 1, 1e-6);
}

/// Form errors by place.
std::map<std::string, double> errors_of(const std::string& csv) {
  std::map<std::string, double> out;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    out[cells.at(0) + " " + cells.at(1) + " " + cells.at(2)] = std::stod(cells.at(6));
  }
  return out;
}

TEST(Sections, SettleStaticCouplingInRounds) {
  const TempFolder folder;
  write_all(folder, replaced(kJob, "\"rigid\"", "\"static\""));
  const std::string first_rows = program().substr(0, program().find("G0 X-4 Y0.1"));
  folder.write("p.nc", first_rows + "M30\n");
  const CamberRun run = run_camber(folder, "predict job.toml -o three --sections 3");
  EXPECT_EQ(run.status, 0) << run.err;
  const auto three = results(folder / "three");
  const auto json = nlohmann::json::parse(three.at("summary.json"));
  const auto& sections = json.at("sections");
  EXPECT_GE(sections.at("rounds"), 2);
  EXPECT_GT(sections.at("solved_again").at(0), 0);
  EXPECT_EQ(sections.at("solved_again").back(), 0);
  EXPECT_EQ(run_camber(folder, "-q predict job.toml -o two --sections 2").status, 0);
  expect_same(three, results(folder / "two"), "2 sections");

  // A tool that is not much stiffer than its chip: what a piece did not know of the teeth before it would go on.
  ASSERT_EQ(run_camber(folder, "-q predict job.toml -o plain").status, 0);
  const auto sections_um = errors_of(three.at("form_error.csv")),
             plain_um = errors_of(tests::file_text(folder / "plain/form_error.csv"));
  ASSERT_EQ(sections_um.size(), plain_um.size());
  ASSERT_GT(plain_um.size(), 100u);
  double difference2 = 0, size2 = 0;
  for (const auto& [place, error] : plain_um) {
    const double difference = sections_um.at(place) - error;
    difference2 += difference * difference;
    size2 += error * error;
    EXPECT_NEAR(difference, 0, 0.3) << place;
  }
  EXPECT_LT(std::sqrt(difference2 / size2), 0.02);
}

TEST(Sections, SayWhatAFirstRoundLeavesOut) {
  const TempFolder folder;
  write_all(folder, replaced(kJob, "\"rigid\"", "\"static\""));
  const std::string first_rows = program().substr(0, program().find("G0 X-4 Y0.1"));
  folder.write("p.nc", first_rows + "M30\n");
  for (const char* which : {"sweep", "solve"}) ASSERT_EQ(run_camber(folder, stage(which, 1, 1)).status, 0);
  const CamberRun run = run_camber(folder, "merge parts");
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(
      run.err.substr(0, run.err.find('\n')),
      "camber: error: the first round of sections in static coupling begins from what an undeflected cutter leaves; "
      "--stage solve --round 2 of all sections, and then camber merge, was expected");
}

class Parts : public ::testing::Test {
 protected:
  void SetUp() override {
    write_all(folder_);
    for (const char* which : {"sweep", "solve"})
      for (const int section : {1, 2}) ASSERT_EQ(run_camber(folder_, stage(which, section, 2)).status, 0);
  }
  std::string part(const std::string& name) const { return folder_ / ("parts/parts/" + name); }
  std::string again(const std::string& rest) const {
    return "run camber predict job.toml -o parts --sections 2 " + rest;
  }
  /// Nothing is merged.
  void expect_refused(const std::string& message) {
    const CamberRun run = run_camber(folder_, "merge parts");
    EXPECT_EQ(run.status, 1);
    EXPECT_EQ(run.err, message);
    EXPECT_FALSE(fs::exists(folder_ / "parts/summary.json"));
    EXPECT_FALSE(fs::exists(folder_ / "parts/forces.csv"));
  }
  TempFolder folder_;
};

TEST_F(Parts, AreNotComputedTwice) {
  const auto before = fs::last_write_time(part("sweep-001-of-002.part"));
  const CamberRun run = run_camber(folder_, "predict job.toml -o parts --sections 2 --section 1 --stage sweep");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out, "parts/parts/sweep-001-of-002.part: is there already\n");
  EXPECT_EQ(fs::last_write_time(part("sweep-001-of-002.part")), before);
}

TEST_F(Parts, ThatAreMissingAreNamed) {
  fs::remove(part("solve-1-002-of-002.part"));
  expect_refused("parts/parts/solve-1-002-of-002.part: error: is missing; the part of this section was expected: " +
                 again("--section 2 --stage solve [part-missing]\n"));
}

TEST_F(Parts, ThatAreTornAreNamedAndWrittenAgain) {
  const std::string file = part("sweep-002-of-002.part");
  fs::resize_file(file, fs::file_size(file) - 1);
  expect_refused(
      "parts/parts/sweep-002-of-002.part: error: is not whole; a part that was written to its end was expected: " +
      again("--section 2 --stage sweep [part-torn]\n"));
  ASSERT_EQ(run_camber(folder_, stage("sweep", 2, 2)).status, 0);
  EXPECT_EQ(run_camber(folder_, "-q merge parts").status, 0);
}

TEST_F(Parts, WithAFlippedBitAreNamedAndNeverMerged) {
  const std::string file = part("solve-1-001-of-002.part"), whole = tests::file_text(file);
  constexpr std::size_t kPlaces = 12;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    std::string flipped = whole;
    flipped[i * (whole.size() - 1) / (kPlaces - 1)] ^= static_cast<char>(1 << i % 8);
    std::ofstream(file, std::ios::binary) << flipped;
    expect_refused(
        "parts/parts/solve-1-001-of-002.part: error: is not whole; a part that was written to its end was expected: " +
        again("--section 1 --stage solve [part-torn]\n"));
  }
}

/// FNV-1a with an end mark, as the head of a part has it.
std::string hash_of(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : text + '\xff') hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  char out[17];
  std::snprintf(out, sizeof out, "%016llX", static_cast<unsigned long long>(hash));
  return out;
}

TEST_F(Parts, OfAnotherVersionAreNamed) {
  constexpr std::size_t kMagic = 14, kHash = 16;
  std::string text = tests::file_text(part("sweep-001-of-002.part"));
  const std::string version = text.substr(text.find("0.", kMagic + kHash), 5);
  text.replace(text.find(version), 5, "0.1.9");
  text.replace(kMagic, kHash, hash_of(text.substr(kMagic + kHash)));
  folder_.write("parts/parts/sweep-001-of-002.part", text);
  expect_refused("parts/parts/sweep-001-of-002.part: error: was written by camber 0.1.9, this is " + version +
                 "; parts of one version were expected: " + again("--section 1 --stage sweep [part-version]\n"));
}

/// The text with the hexadecimal numbers of a part's and of a job's hash taken out; they have to differ.
std::string without_hashes(std::string text) {
  std::vector<std::string> hashes;
  for (std::size_t at = 0; (at = text.find("(hash ", at)) != std::string::npos; at += 6) {
    constexpr std::size_t kHash = 16;
    hashes.push_back(text.substr(at + 6, kHash));
    EXPECT_EQ(hashes.back().find_first_not_of("0123456789ABCDEF"), std::string::npos) << text;
    text.erase(at + 6, kHash);
  }
  EXPECT_TRUE(hashes.size() == 2 && hashes[0] != hashes[1]) << text;
  return text;
}

TEST_F(Parts, OfAnotherJobAreNamed) {
  folder_.write("job.toml", replaced(kJob, "overhang_mm = 25.0", "overhang_mm = 26.0"));
  const std::string message =
      "parts/parts/sweep-001-of-002.part: error: is of another job, program or setting (hash ) than job.toml now (hash "
      "): " +
      again("--section 1 --stage sweep [part-job]\n");
  for (const std::string& command : {std::string("merge parts"), stage("solve", 1, 2)}) {
    const CamberRun run = run_camber(folder_, command);
    EXPECT_EQ(run.status, 1);
    EXPECT_EQ(without_hashes(run.err), message) << command;
    EXPECT_FALSE(fs::exists(folder_ / "parts/summary.json"));
  }
}

TEST_F(Parts, OfAnotherNumberOfSectionsAreNamed) {
  ASSERT_EQ(run_camber(folder_, stage("sweep", 1, 3)).status, 0);
  expect_refused(
      "parts: error: has parts of 2 and of 3 sections; parts of one prediction were expected [part-sections]\n");
}

TEST_F(Parts, ThatASectionKeptForItselfAreNamed) {
  fs::remove(part("solve-1-001-of-002.part"));
  const std::string file = part("own-sweep-001-of-002.part");
  fs::resize_file(file, fs::file_size(file) / 2);
  const CamberRun torn = run_camber(folder_, stage("solve", 1, 2));
  EXPECT_EQ(torn.status, 1);
  EXPECT_EQ(torn.err,
            "parts/parts/own-sweep-001-of-002.part: error: is not whole; a part that was written to its end was "
            "expected: " +
                again("--section 1 --stage sweep [part-torn]\n"));
  // The same commands again do what is missing.
  for (const char* which : {"sweep", "solve"}) ASSERT_EQ(run_camber(folder_, stage(which, 1, 2)).status, 0);
  EXPECT_EQ(run_camber(folder_, "-q merge parts").status, 0);
}

/// Files of no more than so many blocks of 512 bytes.
CamberRun run_on_full_disk(const TempFolder& folder, int blocks, const std::string& arguments) {
  const std::string command = "cd '" + folder.path() + "' && (ulimit -f " + std::to_string(blocks) +
                              "; exec '" CAMBER_EXECUTABLE "' " + arguments + ") 2>&1 | cat > said; true";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return {0, "", tests::file_text(folder / "said")};
}

TEST_F(Parts, ThatHaveNoRoomAreNamedAndNothingIsLeft) {
  const auto files = [&] {
    std::vector<std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "parts"))
      out.push_back(entry.path().filename().string());
    std::sort(out.begin(), out.end());
    return out;
  };
  for (const char* own : {"", "own-"}) fs::remove(part(std::string(own) + "sweep-001-of-002.part"));
  const auto before = files();
  EXPECT_EQ(run_on_full_disk(folder_, 1, stage("sweep", 1, 2)).err,
            "parts/parts/own-sweep-001-of-002.part: error: could not be written to its end (is the disk full?) "
            "[file-unwritable]\n");
  EXPECT_EQ(files(), before);

  ASSERT_EQ(run_camber(folder_, stage("sweep", 1, 2)).status, 0);
  const auto whole = files();
  std::string expected;
  for (const char* name :
       {"stock.vdb", "form_error.csv", "form_error.vtp", "forces.csv", "form_error.ply", "feed.csv", "report.html"})
    expected += name;
  // Which of the files is named depends on which is written first.
  const std::string said = run_on_full_disk(folder_, 1, "-q merge parts").err;
  EXPECT_NE(said.find(": error: could not be written to its end (is the disk full?) [file-unwritable]\n"),
            std::string::npos)
      << said;
  EXPECT_NE(expected.find(fs::path(said.substr(0, said.find(": error"))).filename().string()), std::string::npos)
      << said;
  EXPECT_EQ(files(), whole);
  ASSERT_EQ(run_camber(folder_, "-q merge parts").status, 0);
}

TEST(SectionsOfTheLibrary, AreThePartsOfTheCommandLine) {
  const TempFolder folder;
  write_all(folder);
  const std::string job = folder / "job.toml", out = folder / "library";
  SectionOptions options{.sections = 2, .section = 1, .solve = true};
  try {
    predict_section(job, out, options);
    FAIL() << "nothing was swept";
  } catch (const InputError& problem) {
    ASSERT_EQ(problem.diagnostics().size(), 1u);
    EXPECT_EQ(problem.diagnostics().front().check, "part-missing");
  }
  for (const bool solve : {false, true})
    for (const std::size_t section : {2, 1}) {
      options.section = section, options.solve = solve;
      const SectionResult part = predict_section(job, out, options);
      EXPECT_TRUE(part.computed);
      EXPECT_GT(part.stamps, 1000);
      EXPECT_EQ(part.solved_again, 0);
      EXPECT_TRUE(fs::exists(part.part)) << part.part;
      const std::string command = stage(solve ? "solve" : "sweep", static_cast<int>(section), 2);
      ASSERT_EQ(run_camber(folder, replaced(command, "job.toml", job)).status, 0);
      const std::string name = fs::path(part.part).filename().string();
      EXPECT_TRUE(tests::file_text(part.part) == tests::file_text(folder / ("parts/parts/" + name))) << name;
      EXPECT_FALSE(predict_section(job, out, options).computed);
    }
  const PredictResult merged = merge(out);
  EXPECT_TRUE(merged.doubts.empty());
  ASSERT_EQ(run_camber(folder, "-q merge parts").status, 0);
  expect_same(results(folder / "parts"), results(out), "library");

  for (const auto& [section, round] : {std::pair(3, 1), std::pair(0, 1), std::pair(1, 13)}) {
    options.section = static_cast<std::size_t>(section), options.round = round;
    EXPECT_THROW(predict_section(job, out, options), std::invalid_argument) << section << " " << round;
  }
}

TEST(SectionOptions, AreRefusedWhereTheyDoNotFit) {
  const TempFolder folder;
  write_all(folder);
  const auto expect = [&](const std::string& options, const std::string& message) {
    const CamberRun run = run_camber(folder, "predict job.toml -o out " + options);
    EXPECT_EQ(run.status, 2) << options;
    EXPECT_EQ(run.err.substr(0, run.err.find('\n')), message);
  };
  expect("--sections 2 --section 1", "--stage is required");
  expect("--sections 2 --stage sweep", "--stage requires --section");
  expect("--section 1 --stage sweep", "--section requires --sections");
  expect("--sections 2 --section 3 --stage sweep", "--section: 3 of 2 sections");
  expect("--sections 2 --section 1 --stage sweep --round 2", "--stage solve is required");
  const CamberRun none = run_camber(folder, "merge .");
  EXPECT_EQ(none.status, 1);
  EXPECT_EQ(none.err,
            ".: error: has no parts of a prediction; camber predict --sections N --section I writes them "
            "[part-missing]\n");
}

}  // namespace
}  // namespace camber
