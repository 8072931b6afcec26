#include "report/mesh_file.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/output_file.h"
#include "report/base64.h"
#include "simulate/job_stock.h"

namespace camber::report {
namespace {

constexpr std::size_t kFlushBytes = 1 << 20;

/// Bytes of a file, written a megabyte at a time.
class BinaryFile {
 public:
  explicit BinaryFile(const std::string& path) : file_(path) {}
  void text(std::string_view text) { bytes_ += text; }
  template <class Value>
  void put(Value value) {
    append_little_endian(bytes_, value);
    if (bytes_.size() > kFlushBytes) flush();
  }
  void put(const Vec3& v) {
    for (int a = 0; a < 3; ++a) put(static_cast<float>(v[a]));
  }
  void byte(std::uint8_t value) { bytes_ += static_cast<char>(value); }
  void commit() {
    flush();
    file_.commit();
  }

 private:
  void flush() {
    file_.stream().write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }
  OutputFile file_;
  std::string bytes_;
};

using Triangle = std::array<std::uint32_t, 3>;

/// Not of length one; zero where the triangle has no area.
Vec3 normal_of(const SurfaceMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]].place_mm;
  return (mesh.vertices[t[1]].place_mm - a).cross(mesh.vertices[t[2]].place_mm - a);
}

void put_ply_faces(BinaryFile& file, const std::vector<Triangle>& triangles) {
  for (const Triangle& t : triangles) {
    file.byte(3);
    for (const std::uint32_t v : t) file.put(v);
  }
}

std::string ply_head(const std::string& comment, const SurfaceMesh& mesh, const std::string& properties,
                     std::size_t triangles) {
  std::string out = fmt::format("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n", comment,
                                mesh.vertices.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) out += fmt::format("property float {}\n", name);
  return out + properties +
         fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", triangles);
}

void write_stl(const std::string& path, const SurfaceMesh& mesh) {
  constexpr std::size_t kHead = 80;
  const auto triangles = triangles_of(mesh);
  BinaryFile file(path);
  std::string head = "machined part, mm";
  head.resize(kHead, ' ');
  file.text(head);
  file.put(static_cast<std::uint32_t>(triangles.size()));
  for (const Triangle& t : triangles) {
    const Vec3 normal = normal_of(mesh, t);
    file.put(normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3(Vec3::Zero()));
    for (const std::uint32_t v : t) file.put(mesh.vertices[v].place_mm);
    file.byte(0);
    file.byte(0);
  }
  file.commit();
}

/// Surface of a stock, on the finest grid that crosses it no more often than this.
SurfaceMesh stock_mesh(const removal::Stock& stock, std::size_t max_crossings) {
  const removal::StockShape shape = removal::stock_shape(stock, max_crossings);
  const auto& crossings = shape.crossings;
  return surface_mesh({crossings.size(),
                       [&crossings](std::size_t i) {
                         SurfaceSample out;
                         out.place_mm = crossings[i].place_mm;
                         out.normal = crossings[i].outward;
                         return out;
                       }},
                      shape.cell_mm, std::numeric_limits<std::uint32_t>::max());
}

}  // namespace

SurfaceMesh machined_mesh(const removal::Stock& stock) {
  return stock_mesh(stock, std::numeric_limits<std::size_t>::max());
}

TriangleMesh blank_mesh(machine::Job job) {
  constexpr std::size_t kMaxCrossings = 150'000;
  constexpr double kBand = 3, kCells = 150;
  if (!job.stock.mesh.empty()) return read_mesh(job.stock.mesh);
  if (const auto& c = job.stock.cylinder)
    job.simulation.voxel_mm = std::max(c->diameter_mm, c->height_mm) / kCells;
  else if (job.stock.vdb.empty())
    return {};
  const auto ready = [](const Vec3&, const Vec3&) {};
  const SurfaceMesh mesh = stock_mesh(simulate::job_stock(job, kBand, ready), kMaxCrossings);
  TriangleMesh out;
  for (const SurfaceSample& v : mesh.vertices) out.points.push_back(v.place_mm.cast<float>());
  out.triangles = triangles_of(mesh);
  return out;
}

SurfaceMesh error_mesh(const FormErrorPoints& points, double grid_mm) {
  return surface_mesh({points.count,
                       [&points](std::size_t i) {
                         const FormErrorPoint p = points.at(i);
                         return SurfaceSample{.place_mm = p.crossing_mm,
                                              .normal = p.normal,
                                              .error_um = p.error_um,
                                              .contour_um = p.contour_um,
                                              .area_mm2 = p.area_mm2,
                                              .block = p.block};
                       }},
                      grid_mm, std::numeric_limits<std::uint32_t>::max());
}

std::vector<std::array<std::uint32_t, 3>> triangles_of(const SurfaceMesh& mesh) {
  std::vector<Triangle> out;
  out.reserve(2 * mesh.quads.size());
  for (const auto& q : mesh.quads) {
    const bool whole = q[3] != q[0];
    Triangle first{q[0], q[1], q[2]}, second{q[0], q[2], q[3]};
    Vec3 outward = Vec3::Zero(), normal = normal_of(mesh, first);
    for (const std::uint32_t v : q) outward += mesh.vertices[v].normal;
    if (whole) normal += normal_of(mesh, second);
    if (normal.dot(outward) < 0) {
      std::swap(first[1], first[2]);
      std::swap(second[1], second[2]);
    }
    out.push_back(first);
    if (whole) out.push_back(second);
  }
  return out;
}

void write_mesh(const std::string& path, const SurfaceMesh& mesh) {
  if (!path.ends_with(".ply")) return write_stl(path, mesh);
  const auto triangles = triangles_of(mesh);
  BinaryFile file(path);
  file.text(ply_head("machined part, mm", mesh, "", triangles.size()));
  for (const SurfaceSample& v : mesh.vertices) {
    file.put(v.place_mm);
    file.put(v.normal);
  }
  put_ply_faces(file, triangles);
  file.commit();
}

void write_error_mesh(const std::string& path, const SurfaceMesh& mesh, double full_um) {
  const auto triangles = triangles_of(mesh);
  BinaryFile file(path);
  file.text(ply_head(fmt::format("error_um: blue cut too deep, red material left, full colour at {:g}", full_um), mesh,
                     "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float error_um\nproperty "
                     "float deflection_um\nproperty float contour_um\nproperty int block\n",
                     triangles.size()));
  for (const SurfaceSample& v : mesh.vertices) {
    file.put(v.place_mm);
    file.put(v.normal);
    for (const std::uint8_t c : error_colour(full_um > 0 ? v.error_um / full_um : 0)) file.byte(c);
    for (const double value : {v.error_um, v.error_um - v.contour_um, v.contour_um})
      file.put(static_cast<float>(value));
    file.put(v.block);
  }
  put_ply_faces(file, triangles);
  file.commit();
}

}  // namespace camber::report
