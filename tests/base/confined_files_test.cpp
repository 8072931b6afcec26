// What lies in a folder, links resolved. That a confined process keeps to it: tests/cli/events_test.cpp.
#include <filesystem>

#include <gtest/gtest.h>

#include "base/folders.h"
#include "tests/support/temp_folder.h"

namespace camber {
namespace {

namespace fs = std::filesystem;

TEST(ConfinedFiles, KnowWhatLiesInAFolder) {
  const tests::TempFolder folder;
  fs::create_directories(folder / "in/sub");
  fs::create_directories(folder / "in2");
  folder.write("in/a.txt", "a");
  folder.write("out.txt", "b");
  fs::create_symlink(folder / "out.txt", folder / "in/file_link");
  fs::create_symlink("../in2", folder / "in/folder_link");
  fs::create_symlink(folder / "in2/new.txt", folder / "in/dangling");
  fs::create_symlink("dangling", folder / "in/chain");
  fs::create_symlink("a.txt", folder / "in/inner_link");
  fs::create_symlink("loop", folder / "in/loop");
  const auto inside = [&](const std::string& name) { return lies_below(folder / "in", folder / name); };
  for (const char* name : {"in", "in/", "in/a.txt", "in/new.txt", "in/sub/x/y", "in/../in/a.txt", "in/inner_link"})
    EXPECT_TRUE(inside(name)) << name;
  for (const char* name : {"", "in2", "in2/a", "out.txt", "in/../out.txt", "in/file_link", "in/folder_link",
                           "in/folder_link/x", "in/dangling", "in/chain", "in/loop", "in/sub/../../out.txt"})
    EXPECT_FALSE(inside(name)) << name;
  EXPECT_FALSE(lies_below(folder / "nowhere", folder / "nowhere/a"));
}

TEST(ConfinedFiles, AreEverywhereWhereNothingIsConfined) { EXPECT_NO_THROW(require_confined("/etc/hostname")); }

}  // namespace
}  // namespace camber
