// Files are whole or not there, however the writing ends.
#include "base/output_file.h"

#include <csignal>
#include <filesystem>

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

TEST(OutputFile, AFullDiskKeepsTheOldFile) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  const tests::TempFolder folder;
  const std::string path = folder.write("a.txt", "OLD");
  std::filesystem::create_symlink("/dev/full", path + ".part");
  try {
    write_file(path, "NEW");
    ADD_FAILURE() << "a full disk was not noticed";
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()),
              path + ": error: could not be written to its end (is the disk full?) [file-unwritable]");
  }
  EXPECT_EQ(tests::file_text(path), "OLD");
  EXPECT_FALSE(std::filesystem::is_symlink(path + ".part"));
}

}  // namespace
}  // namespace camber
