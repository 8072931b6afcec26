// Ctrl-C ends a long prediction at once, in whatever stage it is, and leaves no file.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <random>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/ball_job.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using Clock = std::chrono::steady_clock;
using tests::TempFolder;

constexpr double kToExit_s = 1.0;  // 0.5 s are promised; a machine that runs other tests may be late itself

/// Static coupling over 80 x 80 mm: many seconds of work, of which the last third of a second is not reached.
void write_long_job(const TempFolder& folder) {
  std::string program = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS12000 M3\nG0 X0. Y0. Z5.\nG1 Z0. F3000\n";
  for (int row = 0; row < 160; ++row)
    for (int i = 0; i <= 80; ++i)
      program += fmt::format("X{} Y{:.1f} Z{:.3f}\n", row % 2 != 0 ? 80 - i : i, 0.5 * row, 0.02 * (i % 10));
  folder.write("p.nc", program + "G0 Z5.\nM30\n");
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n[spindle]\nmax_rpm = 12000\n");
  folder.write("job.toml",
               tests::ball_job({.diameter_mm = 10, .box_mm = "[[0, 0, -20], [80, 80, 1]]", .voxel_mm = 0.1}));
}

pid_t start(const TempFolder& folder, const char* command) {
  const pid_t child = fork();
  if (child != 0) return child;
  std::signal(SIGINT, SIG_DFL);
  if (chdir(folder.path().c_str()) != 0) _exit(99);
  const int nothing = open("/dev/null", O_RDWR);
  dup2(nothing, STDOUT_FILENO);
  dup2(nothing, STDERR_FILENO);
  if (std::string_view(command) == "predict")
    execl(CAMBER_EXECUTABLE, CAMBER_EXECUTABLE, command, "job.toml", "-o", "out", nullptr);
  else
    execl(CAMBER_EXECUTABLE, CAMBER_EXECUTABLE, command, "job.toml", "-o", "a.nc", nullptr);
  _exit(99);
}

/// Seconds from the signal to the end.
double time_to_exit_s(pid_t child, int milliseconds, int& status) {
  usleep(static_cast<useconds_t>(1000 * milliseconds));
  const auto at = Clock::now();
  kill(child, SIGINT);
  waitpid(child, &status, 0);
  return std::chrono::duration<double>(Clock::now() - at).count();
}

void expect_prompt_end(const char* command) {
  const TempFolder folder;
  write_long_job(folder);
  std::mt19937 random(7);
  for (int n = 0; n < 5; ++n) {
    const int milliseconds = std::uniform_int_distribution(20, 1300)(random);
    int status = 0;
    EXPECT_LT(time_to_exit_s(start(folder, command), milliseconds, status), kToExit_s) << milliseconds << " ms";
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) << "after " << milliseconds << " ms: " << status;
    EXPECT_FALSE(std::filesystem::exists(folder / "out/summary.json"));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.nc"));
  }
}

TEST(Interrupt, EndsAPredictionAtOnce) { expect_prompt_end("predict"); }
TEST(Interrupt, EndsACompensationAtOnce) { expect_prompt_end("compensate"); }

}  // namespace
}  // namespace camber
