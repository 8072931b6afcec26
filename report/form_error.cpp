#include "report/form_error.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "base/output_file.h"
#include "report/base64.h"

namespace camber::report {
namespace {

constexpr std::size_t kFlushBytes = 1 << 20;

void flush(fmt::memory_buffer& buffer, OutputFile& file, std::size_t when_above) {
  if (buffer.size() <= when_above) return;
  file.stream().write(buffer.data(), static_cast<std::streamsize>(buffer.size()));
  buffer.clear();
}

/// One array of the file: the byte count, then the bytes, in base64.
std::string data_array(std::string_view attributes, const std::string& bytes) {
  std::string with_size;
  append_little_endian(with_size, static_cast<std::uint64_t>(bytes.size()));
  return fmt::format("<DataArray {} format=\"binary\">{}</DataArray>\n", attributes, base64(with_size + bytes));
}

template <class Value>
std::string floats(std::string_view attributes, std::span<const FormErrorPoint> points, Value value) {
  std::string bytes;
  bytes.reserve(points.size() * sizeof(float));
  for (const auto& p : points) append_little_endian(bytes, static_cast<float>(value(p)));
  return data_array(attributes, bytes);
}

std::string vectors(std::string_view attributes, std::span<const FormErrorPoint> points, Vec3 FormErrorPoint::*of) {
  std::string bytes;
  bytes.reserve(points.size() * 3 * sizeof(float));
  for (const auto& p : points)
    for (int i = 0; i < 3; ++i) append_little_endian(bytes, static_cast<float>((p.*of)[i]));
  return data_array(attributes, bytes);
}

/// Connectivity 0, 1, 2 ... and offsets 1, 2, 3 ...: a vertex cell for each point.
std::string counting(std::string_view attributes, std::size_t count, std::uint32_t first) {
  std::string bytes;
  bytes.reserve(count * sizeof(std::uint32_t));
  for (std::size_t i = 0; i < count; ++i) append_little_endian(bytes, static_cast<std::uint32_t>(first + i));
  return data_array(attributes, bytes);
}

template <class Value>
std::string whole_numbers(std::string_view attributes, std::span<const FormErrorPoint> points, Value value) {
  std::string bytes;
  for (const auto& p : points) append_little_endian(bytes, static_cast<std::uint32_t>(value(p)));
  return data_array(attributes, bytes);
}

}  // namespace

void write_form_error_csv(const std::string& path, std::span<const FormErrorPoint> points) {
  OutputFile file(path);
  fmt::memory_buffer buffer;
  auto out = std::back_inserter(buffer);
  fmt::format_to(out, "x_mm,y_mm,z_mm,nx,ny,nz,error_um,total_error_um,block,tool\n");
  for (const auto& p : points) {
    fmt::format_to(out, "{:.4f},{:.4f},{:.4f},{:.5f},{:.5f},{:.5f},{:.3f},", p.place_mm.x(), p.place_mm.y(),
                   p.place_mm.z(), p.normal.x(), p.normal.y(), p.normal.z(), p.error_um);
    if (std::isfinite(p.total_error_um)) fmt::format_to(out, "{:.3f}", p.total_error_um);
    fmt::format_to(out, ",{},{}\n", p.block, p.tool);
    flush(buffer, file, kFlushBytes);
  }
  flush(buffer, file, 0);
  file.commit();
}

void write_form_error_vtp(const std::string& path, std::span<const FormErrorPoint> points) {
  const bool with_total =
      std::any_of(points.begin(), points.end(), [](const auto& p) { return std::isfinite(p.total_error_um); });
  OutputFile file(path);
  auto& out = file.stream();
  out << "<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n"
      << fmt::format(
             "<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
             "NumberOfPolys=\"0\">\n",
             points.size());
  out << "<PointData Scalars=\"error_um\" Normals=\"normal\">\n";
  out << floats(R"(type="Float32" Name="error_um")", points, [](const auto& p) { return p.error_um; });
  if (with_total)
    out << floats(R"(type="Float32" Name="total_error_um")", points, [](const auto& p) { return p.total_error_um; });
  out << vectors(R"(type="Float32" Name="normal" NumberOfComponents="3")", points, &FormErrorPoint::normal);
  out << whole_numbers(R"(type="Int32" Name="block")", points, [](const auto& p) { return p.block; });
  out << whole_numbers(R"(type="Int32" Name="tool")", points, [](const auto& p) { return p.tool; });
  out << "</PointData>\n<Points>\n";
  out << vectors(R"(type="Float32" NumberOfComponents="3")", points, &FormErrorPoint::place_mm);
  out << "</Points>\n<Verts>\n" << counting(R"(type="Int32" Name="connectivity")", points.size(), 0);
  out << counting(R"(type="Int32" Name="offsets")", points.size(), 1);
  out << "</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n";
  file.commit();
}

}  // namespace camber::report
