#include "report/packed_arrays.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <vector>

#include <zlib.h>

#include "base/json.h"
#include "report/base64.h"

namespace camber::report {
namespace {

constexpr std::uint16_t kNothing = 65535;
constexpr double kSteps = 65534;

}  // namespace

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  const int status =
      compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION);
  if (status == Z_MEM_ERROR) throw std::bad_alloc();
  if (status != Z_OK) throw std::runtime_error("zlib could not deflate the data of the page");
  out.resize(size);
  return out;
}

template <class T>
void PackedArrays::append(std::span<const T> values) {
  for (std::size_t byte = 0; byte < sizeof(T); ++byte)
    for (const T v : values) bytes_ += static_cast<char>((v >> (8 * byte)) & 0xff);
}

Json PackedArrays::describe(std::size_t count, const char* kind) const {
  return {{"at", bytes_.size()}, {"n", count}, {"kind", kind}};
}

Json PackedArrays::add_floats(std::span<const double> values) {
  auto out = describe(values.size(), "f4");
  std::vector<std::uint32_t> bits(values.size());
  std::transform(values.begin(), values.end(), bits.begin(),
                 [](double v) { return std::bit_cast<std::uint32_t>(static_cast<float>(v)); });
  append<std::uint32_t>(bits);
  return out;
}

Json PackedArrays::add_quantised(std::span<const double> values) {
  auto out = describe(values.size(), "q2");
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  if (low > high) low = high = 0;
  const double step = (high - low) / kSteps;
  std::vector<std::uint16_t> q(values.size());
  std::transform(values.begin(), values.end(), q.begin(), [&](double v) {
    if (!std::isfinite(v)) return kNothing;
    return step > 0 ? static_cast<std::uint16_t>(std::lround((v - low) / step)) : std::uint16_t{0};
  });
  append<std::uint16_t>(q);
  out["from"] = low;
  out["step"] = step;
  return out;
}

Json PackedArrays::add_whole(std::span<const std::uint32_t> values) {
  auto out = describe(values.size(), "d4");
  std::vector<std::uint32_t> steps(values.size());
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto step = static_cast<std::int32_t>(values[i] - before);
    steps[i] = (static_cast<std::uint32_t>(step) << 1) ^ static_cast<std::uint32_t>(step >> 31);
    before = values[i];
  }
  append<std::uint32_t>(steps);
  return out;
}

std::string PackedArrays::text() const { return base64(deflated(bytes_)); }

}  // namespace camber::report
