// Examples, completion, installation.
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "cli/rounds_progress.h"
#include "test_paths.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::run_camber;
using tests::TempFolder;

std::vector<std::string> subcommands(const TempFolder& folder) {
  std::istringstream help(run_camber(folder, "--help").out);
  std::vector<std::string> out;
  bool listing = false;
  for (std::string line; std::getline(help, line);) {
    if (line == "Subcommands:") {
      listing = true;
    } else if (listing && line.rfind("  ", 0) == 0 && line[2] != ' ') {
      out.push_back(line.substr(2, line.find(' ', 2) - 2));
    } else if (listing && line.empty()) {
      break;
    }
  }
  return out;
}

/// The lines below "Example:" of a help text.
std::vector<std::string> examples_in(const std::string& help) {
  const std::size_t at = help.find("Example:\n");
  std::vector<std::string> out;
  if (at == std::string::npos) return out;
  std::istringstream lines(help.substr(at + 9));
  for (std::string line; std::getline(lines, line);)
    if (const std::size_t from = line.find("camber "); from != std::string::npos) out.push_back(line.substr(from + 7));
  return out;
}

TEST(Help, IsWhatTheReferenceOfOptionsSays) {
  const TempFolder folder;
  const std::string made = folder / "options.md";
  const std::string command = std::string("python3 '") + CAMBER_SOURCE_DIR "/scripts/make-man-pages' '" +
                              CAMBER_EXECUTABLE + "' --reference '" + made + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_TRUE(tests::file_text(made) == tests::file_text(CAMBER_SOURCE_DIR "/docs/reference/options.md"))
      << "scripts/make-man-pages build/release/camber --reference docs/reference/options.md";
}

TEST(Help, HasAnExampleForEverySubcommandThatRunsInASampleFolder) {
  const TempFolder folder;
  const std::string samples = CAMBER_SOURCE_DIR "/samples/";
  for (const char* sample :
       {"01-finishing", "03-force-fit", "10-raster", "11-feed-by-load", "12-five-axis", "14-copy-milling", "15-plan",
        "16-die-cavity", "17-study", "24-chatter", "23-measured-parts", "machines", "case_base.toml"})
    std::filesystem::copy(samples + sample, folder / sample, std::filesystem::copy_options::recursive);
  // A quarter of the cavity's rows, and the end of its program: the whole takes posture half a minute.
  const std::string cavity = tests::file_text(folder / "16-die-cavity/finish.nc");
  std::size_t quarter = 0;
  for (int line = 0; line < 400; ++line) quarter = cavity.find('\n', quarter) + 1;
  ASSERT_GT(quarter, 0u);
  std::ofstream(folder / "16-die-cavity/finish.nc") << cavity.substr(0, quarter) << cavity.substr(cavity.rfind("G0 Z"));
  const auto names = subcommands(folder);
  EXPECT_GE(names.size(), 11u);
  for (const auto& name : names) {
    const auto help = run_camber(folder, name + " --help");
    EXPECT_EQ(help.status, 0) << name;
    const auto examples = examples_in(help.out);
    EXPECT_FALSE(examples.empty()) << name;
    for (const std::string& example : examples) {
      EXPECT_EQ(example.rfind(name + " ", 0), 0u) << example;
      if (name == "ui") continue;  // serves until it is interrupted: tests/ui
      const bool part = name == "resegment" && example.find("--part") != std::string::npos;
      const std::string from = folder / (name == "fit-force"   ? "03-force-fit"
                                         : name == "fit-parts" ? "23-measured-parts"
                                         : name == "adapt"     ? "11-feed-by-load"
                                         : name == "post"      ? "12-five-axis"
                                         : name == "copy"      ? "14-copy-milling"
                                         : name == "plan"      ? "15-plan"
                                         : name == "posture"   ? "16-die-cavity"
                                         : name == "study"     ? "17-study"
                                         : name == "lobes"     ? "24-chatter"
                                         : name == "fit-modes" ? "24-chatter"
                                         : part                ? "10-raster"
                                                               : "01-finishing");
      const std::string command = "export HOME='" + folder.path() +
                                  "'; mkdir -p ~/.local/share/bash-completion/completions; cd '" + from + "' && '" +
                                  CAMBER_EXECUTABLE "' " + example + " > '" + (folder / "said") + "' 2>&1";
      const int status = WEXITSTATUS(std::system(command.c_str()));
      const std::string said = tests::file_text(folder / "said");
      // predict's example has made one part of several.
      if (name == "merge")
        EXPECT_NE(said.find("[part-missing]"), std::string::npos) << said;
      else
        EXPECT_TRUE(status == 0 || status == 3) << example << "\n" << said;
    }
  }
}

TEST(CommandLine, NamesTheNearestWordToOneThatItDoesNotKnow) {
  const TempFolder folder;
  const auto said = [&](const std::string& words) {
    const auto run = run_camber(folder, words);
    EXPECT_EQ(run.status, 2) << words;
    return run.err;
  };
  const std::string more = "\nRun with --help for more information.\n";
  EXPECT_EQ(said("predcit job.toml -o out"), "camber: there is no command predcit; did you mean predict?" + more);
  EXPECT_EQ(said("compensate job.toml --reprot r.html -o x.nc"),
            "camber: there is no option --reprot of compensate; did you mean --report?" + more);
  EXPECT_EQ(said("check p.nc extra"), "camber: there is no further word extra" + more);
}

TEST(CommandLine, WritesJsonToStandardOutputAndEverythingElseToStandardError) {
  const TempFolder folder;
  folder.write("p.nc", "G21\nS1000 M3\nG0 X0 Y0 Z0\nG1 X10 F100\nM30\n");
  const auto run = run_camber(folder, "check p.nc --json -");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out.rfind("{\n  \"program\": \"p.nc\"", 0), 0u) << run.out;
  EXPECT_EQ(run.out.substr(run.out.size() - 2), "}\n");
  EXPECT_NE(run.err.find("no warnings"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "-"));
}

TEST(CommandLine, SaysThatItWasInterruptedAndLeavesNoEmptyFolder) {
  const TempFolder folder;
  std::filesystem::copy(CAMBER_SOURCE_DIR "/samples/01-finishing", folder / "sample");
  const std::string command = "cd '" + (folder / "sample") +
                              "' && { '" CAMBER_EXECUTABLE
                              "' predict job.toml -o new/out > ../out 2> ../err & } && p=$! && "
                              "for i in $(seq 600); do [ -d new/out ] && break; sleep 0.05; done && kill -TERM $p; "
                              "wait $p; echo $? > ../status";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(tests::file_text(folder / "status"), "143\n");
  EXPECT_NE(tests::file_text(folder / "err").find("camber: interrupted: nothing was written\n"), std::string::npos)
      << tests::file_text(folder / "err");
  EXPECT_FALSE(std::filesystem::exists(folder / "sample/new"));
}

TEST(Progress, OfACompensationCountsAllRoundsThatAreExpected) {
  cli::RoundsProgress rounds(8, 0);
  EXPECT_EQ(rounds.at("as given", 0.5).share, 0.5 / 4);
  EXPECT_EQ(rounds.at("as given", 1).what, "as given");
  EXPECT_EQ(rounds.at("round 1", 0).what, "round 1 of about 3 (8 at most)");
  EXPECT_EQ(rounds.at("round 1", 0.5).share, 1.5 / 4);
  rounds.at("round 2", 0), rounds.at("round 3", 0);
  const auto fourth = rounds.at("round 4", 0);
  EXPECT_EQ(fourth.what, "round 4 of about 4 (8 at most)");
  EXPECT_EQ(fourth.share, 4.0 / 5);
  cli::RoundsProgress few(1, 2);
  few.at("as given", 1);
  EXPECT_EQ(few.at("round 1", 1).share, 2.0 / 4);
  EXPECT_EQ(few.at("voxel 0.1", 0.5).share, 2.5 / 4);
}

/// What bash offers for the words, the last of them being typed.
std::string completed(const TempFolder& folder, const std::string& words) {
  const std::string command = "cd '" + folder.path() + "' && bash --norc -c '. ./completion; COMP_WORDS=(" + words +
                              "); COMP_CWORD=$((${#COMP_WORDS[@]}-1)); _camber; echo ${COMPREPLY[@]}' > offered 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return tests::file_text(folder / "offered");
}

TEST(Completion, OffersCommandsOptionsAndValues) {
  const TempFolder folder;
  const auto script = run_camber(folder, "completion bash");
  ASSERT_EQ(script.status, 0);
  folder.write("completion", script.out);
  folder.write("finish.nc", "");
  EXPECT_EQ(completed(folder, "camber fit"), "fit-feed fit-parts fit-force fit-modes\n");
  EXPECT_EQ(completed(folder, "camber predict --forces"), "--forces-at\n");
  EXPECT_EQ(completed(folder, "camber -q compensate --rep"), "--report\n");
  EXPECT_EQ(completed(folder, "camber check finish.nc --units \"\""), "mm inch\n");
  EXPECT_EQ(completed(folder, "camber check fin"), "finish.nc\n");
  EXPECT_EQ(completed(folder, "camber completion \"\""), "bash zsh fish\n");
  EXPECT_EQ(completed(folder, "camber check --stri"), "--strict\n");
  EXPECT_EQ(run_camber(folder, "completion tcsh").status, 2);
}

/// What fish offers for a line that is being typed: words without their descriptions.
std::string offered_by_fish(const TempFolder& folder, const std::string& line) {
  const std::string command = "cd '" + folder.path() +
                              "' && HOME=. fish --no-config -c 'source ./completion; complete -C \"" + line +
                              "\"' 2>&1 | cut -f1 | sort | tr '\\n' ' ' > offered";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return tests::file_text(folder / "offered");
}

TEST(Completion, OfFishOffersTheSame) {
  if (std::system("fish --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "fish is not installed";
  const TempFolder folder;
  folder.write("completion", run_camber(folder, "completion fish").out);
  EXPECT_EQ(offered_by_fish(folder, "camber fit"), "fit-feed fit-force fit-modes fit-parts ");
  EXPECT_EQ(offered_by_fish(folder, "camber predict --forces"), "--forces-at ");
  EXPECT_EQ(offered_by_fish(folder, "camber check finish.nc --units "), "inch mm ");
  EXPECT_EQ(offered_by_fish(folder, "camber completion z"), "zsh ");
  EXPECT_EQ(offered_by_fish(folder, "camber check --stri"), "--strict ");
}

/// What zsh offers: its completion runs only in a terminal, so the functions that offer are stand-ins that print.
std::string offered_by_zsh(const TempFolder& folder, const std::string& words) {
  folder.write("ask.zsh",
               "compdef() {}\ncompadd() { shift; print -l -- $@ | grep -- \"^$words[CURRENT]\"; }\n"
               "_describe() { print -l -- ${(P)2%%:*} | grep \"^$words[CURRENT]\"; }\n_files() { print files; }\n"
               ". ./completion\nwords=(" +
                   words + "); CURRENT=${#words}; _camber | tr '\\n' ' '\n");
  EXPECT_EQ(std::system(("cd '" + folder.path() + "' && zsh -f ask.zsh > offered 2>&1").c_str()), 0);
  return tests::file_text(folder / "offered");
}

TEST(Completion, OfZshOffersTheSame) {
  if (std::system("zsh --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "zsh is not installed";
  const TempFolder folder;
  folder.write("completion", run_camber(folder, "completion zsh").out);
  EXPECT_EQ(offered_by_zsh(folder, "camber fit"), "fit-feed fit-parts fit-force fit-modes ");
  EXPECT_EQ(offered_by_zsh(folder, "camber predict --forces"), "--forces-at ");
  EXPECT_EQ(offered_by_zsh(folder, "camber -q compensate --rep"), "--report ");
  EXPECT_EQ(offered_by_zsh(folder, "camber check finish.nc --units \"\""), "mm inch ");
  EXPECT_EQ(offered_by_zsh(folder, "camber check fin"), "files ");
}

TEST(Install, PutsProgramDocumentsSamplesAndCompletionInPlace) {
  const TempFolder folder;
  const std::string command =
      "cmake --install '" CAMBER_BUILD_DIR "' --prefix '" + (folder / "usr") + "' > '" + (folder / "log") + "' 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << tests::file_text(folder / "log");
  for (const char* name :
       {"bin/camber", "share/doc/camber/LICENSE", "share/doc/camber/README.md", "share/doc/camber/docs/report.md",
        "share/camber/samples/01-finishing/job.toml", "share/bash-completion/completions/camber",
        "share/zsh/site-functions/_camber", "share/fish/vendor_completions.d/camber.fish"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder / ("usr/" + std::string(name)))) << name;
  EXPECT_FALSE(std::filesystem::exists(folder / "usr/share/doc/camber/docs/changes"));
  EXPECT_EQ(std::system(("'" + (folder / "usr/bin/camber") + "' --version > /dev/null").c_str()), 0);
}

}  // namespace
}  // namespace camber
