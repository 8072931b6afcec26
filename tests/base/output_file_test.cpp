// Files are whole or not there, however the writing ends.
#include "base/output_file.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <new>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/diagnostics.h"
#include "tests/support/temp_folder.h"

namespace camber {
namespace {

TEST(OutputFile, KeepsTheOldFileUntilTheNewOneIsWhole) {
  const tests::TempFolder folder;
  const std::string path = folder.write("a.txt", "OLD");
  {
    OutputFile file(path);
    file.stream() << "NEW";
    file.stream().flush();
    EXPECT_EQ(tests::file_text(path), "OLD");
  }
  EXPECT_EQ(tests::file_text(path), "OLD");
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  write_file(path, "NEW");
  EXPECT_EQ(tests::file_text(path), "NEW");
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
}

/// A process that has written half a file is ended by `signal`.
void expect_part_removed(int signal) {
  const tests::TempFolder folder;
  const std::string path = folder.write("a.txt", "OLD");
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::signal(signal, SIG_DFL);  // a shell's background jobs ignore SIGINT, and so would we
    remove_parts_on_signals();
    OutputFile file(path);
    file.stream() << "HALF";
    file.stream().flush();
    if (write(ready[1], "x", 1) != 1) _exit(98);
    for (;;) pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_TRUE(std::filesystem::exists(path + ".part"));
  kill(child, signal);
  int status = 0;
  waitpid(child, &status, 0);
  close(ready[0]);
  close(ready[1]);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), signal);
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  EXPECT_EQ(tests::file_text(path), "OLD");
}

TEST(OutputFile, AnInterruptRemovesThePart) { expect_part_removed(SIGINT); }
TEST(OutputFile, ATerminationRemovesThePart) { expect_part_removed(SIGTERM); }

/// Every file of the folder.
std::vector<std::string> names_in(const tests::TempFolder& folder) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) out.push_back(entry.path().filename());
  std::sort(out.begin(), out.end());
  return out;
}

TEST(OutputFile, AFullDiskKeepsTheOldFile) {
  const tests::TempFolder folder;
  const std::string path = folder.write("a.txt", "OLD"), message = folder / "message.txt";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {  // a limit of the file size, as a full disk
    remove_parts_on_signals();
    const rlimit limit{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_file(path, std::string(5000, 'N'));
    } catch (const InputError& e) {
      std::ofstream(message) << e.what();
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(tests::file_text(message),
            path + ": error: could not be written to its end (is the disk full?) [file-unwritable]");
  EXPECT_EQ(tests::file_text(path), "OLD");
  EXPECT_EQ(names_in(folder), (std::vector<std::string>{"a.txt", "message.txt"}));
}

TEST(FirstFailure, ThrowsWhatFailedFirstAfterAllWasDone) {
  FirstFailure failure;
  int done = 0;
  failure.guard([&] { ++done; });
  failure.guard([&] { fail_on_file("a.txt", "cannot be written", "file-unwritable"); });
  failure.guard([&] { throw std::bad_alloc(); });
  failure.guard([&] { ++done; });
  EXPECT_EQ(done, 2);
  EXPECT_THROW(failure.rethrow(), InputError);
}

TEST(OutputFile, FollowsNoLinkThatLiesAtThePart) {
  const tests::TempFolder folder;
  const std::string path = folder / "a.txt", victim = folder.write("victim.txt", "MINE");
  std::filesystem::create_symlink("victim.txt", path + ".part");
  write_file(path, "NEW");
  EXPECT_EQ(tests::file_text(path), "NEW");
  EXPECT_FALSE(std::filesystem::is_symlink(path));
  EXPECT_EQ(tests::file_text(victim), "MINE");
  EXPECT_TRUE(std::filesystem::is_symlink(path + ".part"));
  // A link to nothing makes no file either.
  std::filesystem::remove(victim);
  write_file(path, "AGAIN");
  EXPECT_EQ(tests::file_text(path), "AGAIN");
  EXPECT_EQ(names_in(folder), (std::vector<std::string>{"a.txt", "a.txt.part"}));
}

TEST(OutputFile, LeavesAFileThatIsNamedLikeItsPart) {
  const tests::TempFolder folder;
  const std::string path = folder / "a.txt", other = folder.write("a.txt.part", "MINE");
  write_file(path, "NEW");
  EXPECT_EQ(tests::file_text(path), "NEW");
  EXPECT_EQ(tests::file_text(other), "MINE");
}

TEST(OutputFile, TwoAtOnceDoNotShareAPart) {
  const tests::TempFolder folder;
  const std::string path = folder / "a.txt";
  OutputFile first(path), second(path);
  first.stream() << "FIRST";
  second.stream() << "SECOND";
  first.commit();
  EXPECT_EQ(tests::file_text(path), "FIRST");
  second.commit();
  EXPECT_EQ(tests::file_text(path), "SECOND");
}

TEST(OutputFile, WritesWhatALinkPointsTo) {
  const tests::TempFolder folder;
  const std::string real = folder.write("real.txt", "OLD"), link = folder / "link.txt";
  std::filesystem::create_symlink("real.txt", link);
  write_file(link, "NEW");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(tests::file_text(real), "NEW");
  EXPECT_FALSE(std::filesystem::exists(real + ".part"));
}

TEST(OutputFile, LeavesADeviceADevice) {
  const tests::TempFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  write_file(pipe, "NEW");
  char got[4] = {};
  EXPECT_EQ(read(reader, got, 3), 3);
  close(reader);
  EXPECT_EQ(std::string(got), "NEW");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_FALSE(std::filesystem::exists(pipe + ".part"));
}

TEST(OutputFile, KeepsThePermissionsOfTheOldFile) {
  const tests::TempFolder folder;
  const std::string path = folder.write("a.txt", "OLD");
  std::filesystem::permissions(path, std::filesystem::perms{0640});
  write_file(path, "NEW");
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0640});
}

std::string refusal(const std::string& path) {
  try {
    require_writable(path);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(RequireWritable, SaysWhatStandsInTheWay) {
  const tests::TempFolder folder;
  const std::string path = folder.write("a.txt", "OLD"), inside = folder / "folder";
  std::filesystem::create_directory(inside);
  EXPECT_EQ(refusal(""), "");
  EXPECT_EQ(refusal(path), "");
  EXPECT_EQ(refusal(folder / "new.txt"), "");
  EXPECT_EQ(refusal("/dev/null"), "");
  EXPECT_EQ(refusal(inside),
            inside + ": error: cannot be written: it is a folder; the name of a file was expected [file-unwritable]");
  const std::string far = folder / "nowhere/a.txt";
  EXPECT_EQ(refusal(far),
            far + ": error: cannot be written: there is no folder " + (folder / "nowhere") + " [file-unwritable]");
  std::filesystem::permissions(path, std::filesystem::perms{0444});
  EXPECT_EQ(refusal(path), path + ": error: cannot be written: the file there is write-protected [file-unwritable]");
  EXPECT_EQ(tests::file_text(path), "OLD");
}

}  // namespace
}  // namespace camber
