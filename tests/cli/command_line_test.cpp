// Options, exit status and what is said about a wrong command line.
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

#include "cli/console.h"
#include "cli/progress.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::run_camber;
using tests::TempFolder;

TEST(CommandLine, TellsItsVersion) {
  const TempFolder folder;
  const auto run = run_camber(folder, "--version");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out.substr(0, 7), "camber ");
  EXPECT_EQ(run.err, "");
}

TEST(CommandLine, ListsItsSubcommands) {
  const TempFolder folder;
  const auto run = run_camber(folder, "--help");
  EXPECT_EQ(run.status, 0);
  for (const char* word : {"check", "feed", "fit-feed", "predict", "compensate", "--strict", "--threads",
                           "--effective-config", "Exit status"})
    EXPECT_NE(run.out.find(word), std::string::npos) << word;
}

TEST(CommandLine, ExitsWithTwoWhenItIsWrong) {
  const TempFolder folder;
  EXPECT_EQ(run_camber(folder, "").status, 2);
  EXPECT_EQ(run_camber(folder, "polish part.nc").status, 2);
  EXPECT_EQ(run_camber(folder, "check").status, 2);
  EXPECT_EQ(run_camber(folder, "check part.nc --loud").status, 2);
  EXPECT_EQ(run_camber(folder, "predict job.toml").status, 2);  // no -o
  EXPECT_EQ(run_camber(folder, "check part.nc -q -v").status, 2);
  EXPECT_EQ(run_camber(folder, "check part.nc --threads many").status, 2);
  const auto run =
      run_camber(folder, "fit-feed --program a.nc --program b.nc --trace a.csv --machine m.toml -o f.toml");
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.err,
            "--trace: 2 programs and 1 traces; the same number of both was expected\n"
            "Run with --help for more information.\n");
}

TEST(CommandLine, SaysBeforeTheWorkThatAnOutputCannotBeWritten) {
  const TempFolder folder;
  const auto run = run_camber(folder, "feed part.nc --machine m.toml -o nowhere/feed.csv");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, "nowhere/feed.csv: error: cannot be written: there is no folder nowhere [file-unwritable]\n");
}

TEST(CommandLine, SaysBeforeTheWorkWhatElseStandsInTheWayOfAnOutput) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "folder");
  folder.write("p.nc", "G1\n");
  const auto said = [&](const std::string& arguments) {
    const auto run = run_camber(folder, arguments);
    EXPECT_EQ(run.status, 1);
    return run.err;
  };
  EXPECT_EQ(said("feed p.nc --machine m.toml -o folder"),
            "folder: error: cannot be written: it is a folder; the name of a file was expected [file-unwritable]\n");
  EXPECT_EQ(said("feed p.nc --machine m.toml -o a.csv --json ./a.csv"),
            "./a.csv: error: is given for two outputs; another name was expected [output-twice]\n");
  EXPECT_EQ(said("predict job.toml -o p.nc/out"),
            "p.nc/out: error: cannot be created as a folder: " + (folder / "p.nc") + " is a file [file-unwritable]\n");
  std::filesystem::permissions(folder / "p.nc", std::filesystem::perms{0444});
  EXPECT_EQ(said("feed q.nc --machine m.toml -o p.nc"),
            "p.nc: error: cannot be written: the file there is write-protected [file-unwritable]\n");
  EXPECT_EQ(tests::file_text(folder / "p.nc"), "G1\n");
}

TEST(CommandLine, PrintsTheEffectiveConfigurationAsAFileThatCanBeRead) {
  const TempFolder folder;
  folder.write("m.toml", "[axis.x]\nmax_velocity_mm_per_min = 9000\n");
  const auto run = run_camber(folder, "feed p.nc --machine m.toml --effective-config");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("max_velocity_mm_per_min = 9000\n"), std::string::npos);
  EXPECT_NE(run.out.find("acceleration_mm_per_s2 = inf\n"), std::string::npos);
  folder.write("again.toml", run.out);
  EXPECT_EQ(run_camber(folder, "feed p.nc --machine again.toml --effective-config").status, 0);
}

TEST(CommandLine, CheckFitsEightyColumns) {
  const TempFolder folder;
  folder.write("p.nc",
               "G21 G90 G17 G40 G80 G54\nT124 M6\nS10500 M3\nG0 X-1183.959 Y-1115.38 Z125.4\nG1 Z-164.671 F330.2\n"
               "X1210.78 Y1175.12 F13810.5\nS12000\nG81 X1. Y1. Z-160. R130. F100.\nG80\nG28 Z130.\nM30\n");
  const auto run = run_camber(folder, "check p.nc");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("of them to or from the reference point"), std::string::npos) << run.out;
  std::istringstream lines(run.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
}

TEST(CommandLine, PutsNoColourInAPipe) {
  const TempFolder folder;
  const auto run = run_camber(folder, "check nothing.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, "nothing.nc: error: no such file [file-missing]\n");
}

TEST(CommandLine, ColoursADiagnosticAsCompilersDo) {
  const Diagnostic d{Severity::error, {"p.nc", 2, 4}, "F0; more was expected", "feed-zero", "G1 F0"};
  EXPECT_EQ(cli::diagnostic_text(d, true),
            "\033[1mp.nc:2:4: \033[0m\033[1;31merror:\033[0m F0; more was expected [feed-zero]\n    G1 F0\n       "
            "\033[1;32m^\033[0m");
  EXPECT_EQ(cli::diagnostic_text(d, false), to_string(d));
}

TEST(Progress, TellsShareAndTimeLeft) {
  EXPECT_EQ(cli::progress_text("cutting", 0.02, 10), "  2 % [........................] cutting");
  EXPECT_EQ(cli::progress_text("cutting", 0.25, 10), " 25 % [######..................] cutting, 30 s left");
  EXPECT_EQ(cli::progress_text("round 2", 0.1, 60), " 10 % [##......................] round 2, 9 min left");
  EXPECT_EQ(cli::progress_text("fitting", std::nullopt, 12), "fitting, 12 s so far");
  EXPECT_EQ(cli::progress_text("round 2", 1.2, 60), "100 % [########################] round 2, 0 s left");
}

}  // namespace
}  // namespace camber
