#include "report/packed_arrays.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

namespace camber::report {
namespace {

std::string from_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(letters.find(c));
    count += 6;
    if (count >= 8) out += static_cast<char>(bits >> (count -= 8) & 0xff);
  }
  return out;
}

std::string inflated(const std::string& bytes, std::size_t size) {
  std::string out(size, '\0');
  uLongf length = static_cast<uLongf>(size);
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(out.data()), &length, reinterpret_cast<const Bytef*>(bytes.data()),
                       static_cast<uLong>(bytes.size())),
            Z_OK);
  out.resize(length);
  return out;
}

/// The whole numbers of an array whose bytes stand apart.
std::vector<std::uint32_t> whole(const std::string& bytes, const nlohmann::json& a, std::size_t size) {
  const std::size_t n = a["n"], at = a["at"];
  std::vector<std::uint32_t> out(n, 0);
  for (std::size_t b = 0; b < size; ++b)
    for (std::size_t i = 0; i < n; ++i)
      out[i] |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at + b * n + i))) << (8 * b);
  return out;
}

nlohmann::json read(const Json& written) { return nlohmann::json::parse(written.dump()); }

TEST(PackedArrays, GiveTheValuesBack) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> values{-6.44, nan, 0, 23.456, 1e-3};
  const std::vector<std::uint32_t> lines{7, 7, 8, 1154, 3, 0};
  PackedArrays arrays;
  const auto floats = read(arrays.add_floats(values)), quantised = read(arrays.add_quantised(values)),
             blocks = read(arrays.add_whole(lines));
  const std::string bytes = inflated(from_base64(arrays.text()), 5 * 4 + 5 * 2 + 6 * 4);
  ASSERT_EQ(bytes.size(), 54u);

  const auto f = whole(bytes, floats, 4), q = whole(bytes, quantised, 2), d = whole(bytes, blocks, 4);
  const double from = quantised["from"], step = quantised["step"];
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto back = std::bit_cast<float>(f[i]);
    if (std::isnan(values[i])) {
      EXPECT_TRUE(std::isnan(back));
      EXPECT_EQ(q[i], 65535u);
    } else {
      EXPECT_EQ(back, static_cast<float>(values[i]));
      EXPECT_NEAR(from + step * q[i], values[i], step / 2 * (1 + 1e-9));
    }
  }
  EXPECT_NEAR(from + step * q[0], -6.44, 1e-12);   // the least
  EXPECT_NEAR(from + step * q[3], 23.456, 1e-12);  // and the greatest are exact
  std::uint32_t line = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    line += (d[i] >> 1) ^ (0u - (d[i] & 1));
    EXPECT_EQ(line, lines[i]);
  }
}

TEST(PackedArrays, TakeConstantsAndNothing) {
  PackedArrays arrays;
  const std::vector<double> same{3, 3}, none;
  const auto a = read(arrays.add_quantised(same));
  EXPECT_EQ(a["from"], 3.0);
  EXPECT_EQ(a["step"], 0.0);
  EXPECT_EQ(read(arrays.add_quantised(none))["n"], 0);
  EXPECT_FALSE(PackedArrays().text().empty());
}

TEST(PackedArrays, DeflateWhatRepeats) { EXPECT_LT(deflated(std::string(100000, 'G')).size(), 200u); }

}  // namespace
}  // namespace camber::report
