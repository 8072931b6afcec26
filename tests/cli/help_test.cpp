// Examples, completion, installation.
#include <sstream>

#include <gtest/gtest.h>

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

TEST(Help, HasAnExampleForEverySubcommandThatTheCommandLineTakes) {
  const TempFolder folder;
  const auto names = subcommands(folder);
  EXPECT_GE(names.size(), 11u);
  for (const auto& name : names) {
    const auto help = run_camber(folder, name + " --help");
    EXPECT_EQ(help.status, 0) << name;
    const std::string mark = "Example:\n  camber ";
    const std::size_t at = help.out.find(mark);
    ASSERT_NE(at, std::string::npos) << name;
    std::string example = help.out.substr(at + mark.size());
    example = example.substr(0, example.find_first_of("\n>"));
    EXPECT_EQ(example.rfind(name + " ", 0), 0u) << example;
    // The files are missing, and that is what is wrong with it: not an option's name or value.
    EXPECT_NE(run_camber(folder, example).status, 2) << example;
  }
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
  EXPECT_EQ(completed(folder, "camber fit"), "fit-feed fit-force\n");
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
  EXPECT_EQ(offered_by_fish(folder, "camber fit"), "fit-feed fit-force ");
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
  EXPECT_EQ(offered_by_zsh(folder, "camber fit"), "fit-feed fit-force ");
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
