#include "tests/support/test_data.h"

#include <lzma.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "test_paths.h"

namespace camber::tests {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& why) { throw std::runtime_error("test data: " + why); }

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(path.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string decompressed(std::string_view packed) {
  lzma_stream stream = LZMA_STREAM_INIT;
  if (lzma_stream_decoder(&stream, std::numeric_limits<std::uint64_t>::max(), 0) != LZMA_OK) fail("no memory for xz");
  stream.next_in = reinterpret_cast<const std::uint8_t*>(packed.data());
  stream.avail_in = packed.size();
  std::string out;
  std::vector<std::uint8_t> room(std::size_t{1} << 20);
  lzma_ret status = LZMA_OK;
  while (status == LZMA_OK) {
    stream.next_out = room.data();
    stream.avail_out = room.size();
    status = lzma_code(&stream, LZMA_FINISH);
    out.append(reinterpret_cast<const char*>(room.data()), room.size() - stream.avail_out);
  }
  lzma_end(&stream);
  if (status != LZMA_STREAM_END) fail("an xz file is damaged");
  return out;
}

/// A column of a packed trace. scripts/pack-trace describes the form.
struct PackedColumn {
  std::string name;
  std::size_t decimals = 0, bytes = 0;
  int fixed = 0, order = 0;
  std::vector<std::int64_t> values;

  void read(const unsigned char* planes, std::size_t rows) {
    values.assign(rows, 0);
    for (std::size_t k = 0; k < bytes; ++k)
      for (std::size_t i = 0; i < rows; ++i)
        values[i] |= static_cast<std::int64_t>(static_cast<std::uint64_t>(planes[k * rows + i]) << 8 * k);
    for (std::int64_t& v : values) v = (v >> 1) ^ -(v & 1);
    for (int round = 0; round < order; ++round)
      for (std::size_t i = 1; i < rows; ++i) values[i] += values[i - 1];
  }

  void write(std::size_t row, std::string& out) const {
    const std::int64_t value = values[row];
    char digits[24];
    const auto end = std::to_chars(digits, std::end(digits), value < 0 ? -value : value).ptr;
    auto count = static_cast<std::size_t>(end - digits);
    if (value < 0) out += '-';
    if (count <= decimals) {
      out += "0.";
      out.append(decimals - count, '0');
    } else {
      out.append(digits, count - decimals);
      if (decimals > 0) out += '.';
    }
    out.append(digits + (count - std::min(count, decimals)), std::min(count, decimals));
    if (fixed || decimals == 0) return;
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
  }
};

}  // namespace

std::string data_path(std::string_view name) { return (fs::path(CAMBER_SOURCE_DIR "/tests/data") / name).string(); }

std::vector<std::string> data_files(std::string_view folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(data_path(folder)))
    if (entry.is_regular_file()) files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

std::string unpacked_trace(std::string_view packed) {
  const std::string whole = decompressed(packed);
  const std::size_t end_of_head = whole.find("\n\n");
  if (!whole.starts_with("camber trace 1\n") || end_of_head == std::string::npos) fail("this is no packed trace");
  std::istringstream head(whole.substr(0, end_of_head));
  std::string line, text;
  std::size_t rows = 0;
  std::uint32_t crc32 = 0;
  std::getline(head, line);
  head >> rows >> std::hex >> crc32 >> std::dec;
  std::vector<PackedColumn> columns;
  const auto* planes = reinterpret_cast<const unsigned char*>(whole.data()) + end_of_head + 2;
  std::size_t left = whole.size() - end_of_head - 2;
  for (PackedColumn c; head >> c.name >> c.decimals >> c.fixed >> c.order >> c.bytes;) {
    if (c.bytes > 8 || c.bytes * rows > left) fail("a packed trace is too short");
    c.read(planes, rows);
    planes += c.bytes * rows;
    left -= c.bytes * rows;
    text += (columns.empty() ? "" : ",") + c.name;
    columns.push_back(std::move(c));
  }
  text += '\n';
  for (std::size_t row = 0; row < rows; ++row) {
    for (const PackedColumn& c : columns) {
      c.write(row, text);
      text += ',';
    }
    text.back() = '\n';
  }
  if (lzma_crc32(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), 0) != crc32)
    fail("the text of a packed trace is not the one that was packed");
  return text;
}

std::string unpacked_data(std::string_view name) {
  const fs::path plain = fs::path(CAMBER_BUILD_DIR "/test_data") / name;
  fs::path packed = data_path(name) + ".xz";
  const bool is_trace = !fs::exists(packed);
  if (is_trace) packed = fs::path(data_path(name)).replace_extension(".trace.xz");
  if (!fs::exists(packed)) fail(packed.string() + " is missing");
  if (fs::exists(plain) && fs::last_write_time(plain) >= fs::last_write_time(packed)) return plain.string();
  const std::string bytes = bytes_of(packed);
  const std::string text = is_trace ? unpacked_trace(bytes) : decompressed(bytes);
  // Others may do the same at the same time: whoever is last replaces the same text.
  fs::create_directories(plain.parent_path());
  const fs::path beside = plain.string() + "." + std::to_string(getpid());
  std::ofstream out(beside, std::ios::binary);
  out << text;
  out.close();
  if (!out) fail(beside.string() + " cannot be written");
  fs::rename(beside, plain);
  return plain.string();
}

std::string unshipped_data(std::string_view name) {
  const fs::path path = fs::path(CAMBER_SOURCE_DIR "/../shared/data") / name;
  return fs::exists(path) ? path.string() : std::string();
}

std::string not_shipped(std::string_view name) {
  return std::string(name) + " may not be shipped and is not in ../shared/data";
}

}  // namespace camber::tests
