// What compensate does with the coefficients of every force law: their uncertainty and the header of a program.
#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compensate/header.h"
#include "compensate/uncertainty.h"
#include "tests/support/law_material.h"
#include "tests/support/temp_folder.h"

namespace camber::compensate {
namespace {

machine::Job job_of(const machine::ForceLawDescription& law) {
  machine::Job job;
  job.material = tests::material_of(law);
  job.material.kte_N_per_mm = 11, job.material.kre_N_per_mm = 7, job.material.kae_N_per_mm = 3;
  return job;
}

TEST(UncertaintyOfEachLaw, MovesEachCoefficientByItsStandardError) {
  const tests::TempFolder folder;
  for (const auto& law : machine::force_laws())
    for (const auto& moved_one : law.coefficients) {
      SCOPED_TRACE(moved_one.key);
      const machine::Job job = job_of(law);
      const std::string path =
          folder.write("m.toml", fmt::format("# {}: {:.6g} +- 0.25 {}\n[material]\n", moved_one.key,
                                             job.material.*moved_one.field, moved_one.unit));
      const auto groups = read_uncertainty(path);
      ASSERT_EQ(groups.size(), 1u);
      EXPECT_EQ(groups[0].name, moved_one.role == machine::CoefficientRole::edge ? "edge" : "cutting");
      std::vector<std::string> unknown;
      const machine::Job other = moved(job, groups[0], unknown);
      EXPECT_TRUE(unknown.empty());
      for (const auto& c : law.coefficients)
        EXPECT_EQ(other.material.*c.field, job.material.*c.field + (c.key == moved_one.key ? 0.25 : 0)) << c.key;
    }
}

TEST(UncertaintyOfEachLaw, APercentageMovesTheForcesOnly) {
  for (const auto& law : machine::force_laws()) {
    const machine::Job job = job_of(law);
    std::vector<std::string> unknown;
    const machine::Job other = moved(job, read_uncertainty("10 %")[0], unknown);
    for (const auto& c : law.coefficients)
      EXPECT_EQ(other.material.*c.field,
                job.material.*c.field * (c.role == machine::CoefficientRole::shape ? 1 : 1 + 0.1))
          << c.key;
  }
}

TEST(HeaderOfEachLaw, NamesItsCoefficients) {
  for (const auto& law : machine::force_laws()) {
    const machine::Job job = job_of(law);
    const std::string header = header_lines(job, CompensationResult{}, "test");
    const std::string line = header.substr(header.rfind('\n') + 1);
    for (const auto& c : law.coefficients) {
      std::string word = fmt::format("{} {:g}", c.symbol, job.material.*c.field);
      std::ranges::transform(word, word.begin(), [](unsigned char u) { return static_cast<char>(std::toupper(u)); });
      const bool named = std::ranges::find(law.header_keys, c.key) != law.header_keys.end();
      EXPECT_EQ(line.find(word) != std::string::npos, named) << line << " " << word;
    }
  }
}

TEST(HeaderOfEachLaw, ReadsAsItDid) {
  machine::Job job;
  job.material = {2000, 700.5, 0, 15, 12, -1.25};
  const auto last_line = [&] {
    const std::string header = header_lines(job, CompensationResult{}, "test");
    return header.substr(header.rfind('\n') + 1);
  };
  EXPECT_EQ(last_line(), "KTC 2000 KRC 700.5 KAC 0 MPA, KTE 15 KRE 12 KAE -1.25 N/MM");
  job.material.law = machine::ForceLaw::kienzle;
  job.material.kc1_1_MPa = 1409.75, job.material.mc = 0.127829;
  EXPECT_EQ(last_line(), "KC1.1 1409.75 MPA MC 0.127829, KTE 15 KRE 12 N/MM");
}

}  // namespace
}  // namespace camber::compensate
