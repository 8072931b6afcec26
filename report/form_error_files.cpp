#include "report/form_error_files.h"

#include <cmath>
#include <ostream>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/output_file.h"
#include "report/base64.h"

namespace camber::report {
namespace {

constexpr std::size_t kFlushBytes = 1 << 20;

/// One array of the file: the byte count, then the bytes, in base64. `append(bytes, i)` adds those of the i-th of
/// `count`, `each` bytes.
template <class Append>
void write_array(std::ostream& out, std::string_view attributes, std::size_t count, std::size_t each, Append append) {
  out << "<DataArray " << attributes << " format=\"binary\">";
  Base64Stream text(out);
  append_little_endian(text.bytes(), static_cast<std::uint64_t>(count * each));
  for (std::size_t i = 0; i < count; ++i) append(text.bytes(), i);
  text.finish();
  out << "</DataArray>\n";
}

template <class Value>
void write_floats(std::ostream& out, std::string_view attributes, const FormErrorPoints& points, Value value) {
  write_array(out, attributes, points.count, sizeof(float), [&](std::string& bytes, std::size_t i) {
    append_little_endian(bytes, static_cast<float>(value(points.at(i))));
  });
}

void write_vectors(std::ostream& out, std::string_view attributes, const FormErrorPoints& points,
                   Vec3 FormErrorPoint::*of) {
  write_array(out, attributes, points.count, 3 * sizeof(float), [&](std::string& bytes, std::size_t i) {
    const FormErrorPoint p = points.at(i);
    for (int a = 0; a < 3; ++a) append_little_endian(bytes, static_cast<float>((p.*of)[a]));
  });
}

template <class Value>
void write_whole_numbers(std::ostream& out, std::string_view attributes, std::size_t count, Value value) {
  write_array(out, attributes, count, sizeof(std::uint32_t), [&](std::string& bytes, std::size_t i) {
    append_little_endian(bytes, static_cast<std::uint32_t>(value(i)));
  });
}

}  // namespace

void write_form_error_csv(const std::string& path, const FormErrorPoints& points) {
  OutputFile file(path);
  const bool traced = points.count > 0 && std::isfinite(points.at(0).model_error_um);
  std::string text =
      "x_mm,y_mm,z_mm,nx,ny,nz,error_um,deflection_um,contour_um,total_error_um,area_mm2,block,tool,valid";
  const bool yields = points.count > 0 && points.at(0).part_yields();
  if (traced) text += ",model_error_um,difference_um";
  text += yields ? ",tool_deflection_um,part_deflection_um\n" : "\n";
  for (std::size_t i = 0; i < points.count; ++i) {
    const FormErrorPoint p = points.at(i);
    append_cells(text, 4, {p.place_mm.x(), p.place_mm.y(), p.place_mm.z()});
    append_cells(text, 5, {p.normal.x(), p.normal.y(), p.normal.z()});
    append_cells(text, 3, {p.error_um, p.deflection_um(), p.contour_um});
    if (std::isfinite(p.total_error_um))
      append_cells(text, 3, {p.total_error_um});
    else
      text += ',';
    append_cells(text, 6, {p.area_mm2});
    append_cells(text, 0, {static_cast<double>(p.block), static_cast<double>(p.tool), p.valid ? 1.0 : 0.0});
    if (traced) append_cells(text, 3, {p.model_error_um, p.error_um - p.model_error_um});
    if (yields) append_cells(text, 3, {p.tool_um(), p.part_um});
    text.back() = '\n';
    if (text.size() < kFlushBytes) continue;
    file.stream() << text;
    text.clear();
  }
  file.stream() << text;
  file.commit();
}

void write_form_error_vtp(const std::string& path, const FormErrorPoints& points) {
  bool with_total = false;
  for (std::size_t i = 0; i < points.count && !with_total; ++i) with_total = std::isfinite(points.at(i).total_error_um);
  OutputFile file(path);
  auto& out = file.stream();
  out << "<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n"
      << fmt::format(
             "<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
             "NumberOfPolys=\"0\">\n",
             points.count);
  out << "<PointData Scalars=\"error_um\" Normals=\"normal\">\n";
  write_floats(out, R"(type="Float32" Name="error_um")", points, [](const auto& p) { return p.error_um; });
  write_floats(out, R"(type="Float32" Name="deflection_um")", points, [](const auto& p) { return p.deflection_um(); });
  write_floats(out, R"(type="Float32" Name="contour_um")", points, [](const auto& p) { return p.contour_um; });
  write_floats(out, R"(type="Float32" Name="area_mm2")", points, [](const auto& p) { return p.area_mm2; });
  if (with_total)
    write_floats(out, R"(type="Float32" Name="total_error_um")", points,
                 [](const auto& p) { return p.total_error_um; });
  if (points.count > 0 && std::isfinite(points.at(0).model_error_um)) {
    write_floats(out, R"(type="Float32" Name="model_error_um")", points,
                 [](const auto& p) { return p.model_error_um; });
    write_floats(out, R"(type="Float32" Name="difference_um")", points,
                 [](const auto& p) { return p.error_um - p.model_error_um; });
  }
  if (points.count > 0 && points.at(0).part_yields()) {
    write_floats(out, R"(type="Float32" Name="tool_deflection_um")", points, [](const auto& p) { return p.tool_um(); });
    write_floats(out, R"(type="Float32" Name="part_deflection_um")", points, [](const auto& p) { return p.part_um; });
  }
  write_vectors(out, R"(type="Float32" Name="normal" NumberOfComponents="3")", points, &FormErrorPoint::normal);
  write_whole_numbers(out, R"(type="Int32" Name="block")", points.count,
                      [&](std::size_t i) { return points.at(i).block; });
  write_whole_numbers(out, R"(type="Int32" Name="tool")", points.count,
                      [&](std::size_t i) { return points.at(i).tool; });
  write_whole_numbers(out, R"(type="Int32" Name="valid")", points.count,
                      [&](std::size_t i) { return points.at(i).valid ? 1 : 0; });
  out << "</PointData>\n<Points>\n";
  write_vectors(out, R"(type="Float32" NumberOfComponents="3")", points, &FormErrorPoint::place_mm);
  // A vertex cell for each point.
  out << "</Points>\n<Verts>\n";
  write_whole_numbers(out, R"(type="Int32" Name="connectivity")", points.count, [](std::size_t i) { return i; });
  write_whole_numbers(out, R"(type="Int32" Name="offsets")", points.count, [](std::size_t i) { return i + 1; });
  out << "</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n";
  file.commit();
}

}  // namespace camber::report
