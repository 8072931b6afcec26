#include "base/window_buffer.h"

#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace camber {
namespace {

/// Writes as a library that asks for its place, goes back to fill in a number, and goes on at the end.
void write_to_and_fro(std::ostream& out, std::uint32_t seed, int blocks) {
  std::mt19937 random(seed);
  for (int i = 0; i < blocks; ++i) {
    const std::streampos begin = out.tellp();
    out.write("length??", 8);
    const std::string block(random() % 40000, static_cast<char>('a' + random() % 26));
    out.write(block.data(), static_cast<std::streamsize>(block.size()));
    const std::streampos end = out.tellp();
    // Most numbers are close by, some far back.
    out.seekp(random() % 10 == 0 ? std::streampos(random() % (static_cast<std::uint64_t>(end) - 8)) : begin);
    const std::string number = std::to_string(10000000 + block.size());
    out.write(number.data(), 8);
    out.put('!');
    out.seekp(0, std::ios_base::end);
  }
}

TEST(WindowBuffer, WritesTheFileThatAStringWouldHold) {
  const tests::TempFolder folder;
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    constexpr int kBlocks = 700;  // about 14 MB: several windows
    std::ostringstream expected;
    write_to_and_fro(expected, seed, kBlocks);
    const std::string path = folder / "out";
    {
      std::ofstream file(path, std::ios::binary);
      WindowBuffer window(file);
      std::ostream out(&window);
      write_to_and_fro(out, seed, kBlocks);
      window.finish();
      EXPECT_TRUE(out.good());
      EXPECT_TRUE(file.good());
    }
    EXPECT_TRUE(tests::file_text(path) == expected.str()) << seed;
  }
}

/// A stream buffer that cannot seek, as a pipe's.
class Pipe : public std::streambuf {
 public:
  std::string taken;

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    taken.append(text, static_cast<std::size_t>(count));
    return count;
  }
};

TEST(WindowBuffer, KeepsAllWhereNothingCanSeek) {
  std::ostringstream expected;
  write_to_and_fro(expected, 4, 400);
  Pipe pipe;
  std::ostream through(&pipe);
  WindowBuffer window(through);
  std::ostream out(&window);
  write_to_and_fro(out, 4, 400);
  EXPECT_TRUE(pipe.taken.empty());
  window.finish();
  EXPECT_TRUE(pipe.taken == expected.str());
}

TEST(WindowBuffer, LeavesErrorsToTheStream) {
  std::ofstream full("/dev/full", std::ios::binary);
  WindowBuffer window(full);
  std::ostream out(&window);
  out << std::string(1000, 'x');
  window.finish();
  full.flush();
  EXPECT_TRUE(out.good());
  EXPECT_FALSE(full.good());
}

}  // namespace
}  // namespace camber
