#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/output_file.h"
#include "report/base64.h"
#include "report/form_error_files.h"

namespace camber::report {

std::array<std::uint8_t, 3> error_colour(double fraction) {
  const double s = std::clamp(fraction, -1.0, 1.0), faded = 1 - std::abs(s);
  const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(255 * v)); };
  return s < 0 ? std::array{byte(faded), byte(faded), byte(1)} : std::array{byte(1), byte(faded), byte(faded)};
}

void write_form_error_ply(const std::string& path, const FormErrorPoints& points, double full_um) {
  OutputFile file(path);
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment error_um: blue cut too deep, red material left, full colour at "
      "{:g}\nelement vertex {}\n",
      full_um, points.count);
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) bytes += fmt::format("property float {}\n", name);
  for (const char* name : {"red", "green", "blue"}) bytes += fmt::format("property uchar {}\n", name);
  bytes +=
      "property float error_um\nproperty float deflection_um\nproperty float contour_um\nproperty float "
      "area_mm2\nproperty int block\nproperty int tool\nend_header\n";
  constexpr std::size_t kFlushBytes = 1 << 20;
  const auto flush = [&] {
    file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.clear();
  };
  for (std::size_t i = 0; i < points.count; ++i) {
    if (bytes.size() > kFlushBytes) flush();
    const FormErrorPoint p = points.at(i);
    for (const Vec3& v : {p.place_mm, p.normal})
      for (int a = 0; a < 3; ++a) append_little_endian(bytes, static_cast<float>(v[a]));
    for (const std::uint8_t c : error_colour(full_um > 0 ? p.error_um / full_um : 0)) bytes += static_cast<char>(c);
    for (const double v : {p.error_um, p.deflection_um(), p.contour_um, p.area_mm2})
      append_little_endian(bytes, static_cast<float>(v));
    append_little_endian(bytes, p.block);
    append_little_endian(bytes, static_cast<std::uint32_t>(p.tool));
  }
  flush();
  file.commit();
}

}  // namespace camber::report
