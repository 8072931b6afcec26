// The sample of two controls: one part in Klartext and for a Sinumerik, each with a job that runs as it stands.
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "test_paths.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

TEST(Sample25, RunsAsItStandsAndIsOnePartOnBothControls) {
  const tests::TempFolder folder;
  const std::string sample = CAMBER_SOURCE_DIR "/samples/25-controls/";
  std::map<std::string, nlohmann::json> checked;
  for (const auto& [job, machine] : {std::pair{"dome_tnc", "tnc-640"}, std::pair{"dome_840d", "sinumerik-840d"}}) {
    const auto run = tests::run_camber(folder, "check --job " + sample + job + ".toml --json " + (folder / job));
    EXPECT_EQ(run.status, 0) << job;
    EXPECT_EQ(run.err, "") << job;
    checked[job] = nlohmann::json::parse(tests::file_text(folder / job));
    EXPECT_EQ(checked[job]["assumed"][0], std::string("machine preset:") + machine + ", typical values of its class");
  }
  const auto &tnc = checked["dome_tnc"], &sinumerik = checked["dome_840d"];
  for (const char* kind : {"rapid", "linear", "arc"}) EXPECT_EQ(tnc["moves"][kind], sinumerik["moves"][kind]) << kind;
  EXPECT_GT(tnc["moves"]["linear"], 1000);
  EXPECT_EQ(tnc["cutting_length_mm"], sinumerik["cutting_length_mm"]);
  EXPECT_EQ(tnc["cutting_extents_mm"], sinumerik["cutting_extents_mm"]);
}

}  // namespace
}  // namespace camber
