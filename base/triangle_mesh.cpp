#include "base/triangle_mesh.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <unordered_map>

#include <fmt/format.h>

#include "base/diagnostics.h"
#include "base/numbers.h"

namespace camber {
namespace {

struct PointHash {
  std::size_t operator()(const Eigen::Vector3f& p) const {
    std::uint64_t h = 1469598103934665603ull;
    for (int a = 0; a < 3; ++a) h = (h ^ std::bit_cast<std::uint32_t>(p[a])) * 1099511628211ull;
    return static_cast<std::size_t>(h);
  }
};

class MeshBuilder {
 public:
  void add(const std::array<Eigen::Vector3f, 3>& corners) {
    std::array<std::uint32_t, 3> t{};
    for (std::size_t c = 0; c < 3; ++c) {
      // -0 and 0 are one place.
      const Eigen::Vector3f p = corners[c] + Eigen::Vector3f::Zero();
      const auto [it, fresh] = index_.try_emplace(p, static_cast<std::uint32_t>(mesh.points.size()));
      if (fresh) mesh.points.push_back(p);
      t[c] = it->second;
    }
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  TriangleMesh mesh;

 private:
  std::unordered_map<Eigen::Vector3f, std::uint32_t, PointHash> index_;
};

[[noreturn]] void fail_at(const SourceText& source, std::size_t offset, std::string message) {
  throw InputError({source.diagnostic(Severity::error, offset, std::move(message), "stl-format")});
}

TriangleMesh read_binary(const SourceText& source) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  const std::string& bytes = source.text();
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  MeshBuilder builder;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<float, 12> v{};
    std::memcpy(v.data(), bytes.data() + kHeader + i * kTriangle, sizeof v);
    for (const float x : v)
      if (!std::isfinite(x))
        fail_on_file(source.name(), fmt::format("triangle {} has a coordinate that is not a number", i + 1),
                     "stl-format");
    builder.add(
        {Eigen::Vector3f(v[3], v[4], v[5]), Eigen::Vector3f(v[6], v[7], v[8]), Eigen::Vector3f(v[9], v[10], v[11])});
  }
  return std::move(builder.mesh);
}

TriangleMesh read_ascii(const SourceText& source) {
  const std::string& text = source.text();
  MeshBuilder builder;
  std::array<Eigen::Vector3f, 3> corners;
  std::size_t corner = 0, at = 0;
  const auto next = [&]() -> std::string_view {
    while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at]))) ++at;
    const std::size_t from = at;
    while (at < text.size() && !std::isspace(static_cast<unsigned char>(text[at]))) ++at;
    return std::string_view(text).substr(from, at - from);
  };
  for (std::string_view word = next(); !word.empty(); word = next()) {
    if (word != "vertex") continue;
    for (int a = 0; a < 3; ++a) {
      const std::string_view number = next();
      const auto value = parse_number(number);
      if (!value)
        fail_at(source, at - number.size(), fmt::format("'{}' where a vertex's coordinate was expected", number));
      corners[corner][a] = static_cast<float>(*value);
    }
    if (++corner == 3) {
      builder.add(corners);
      corner = 0;
    }
  }
  if (corner != 0) fail_at(source, text.size(), "the last facet has fewer than three vertices");
  return std::move(builder.mesh);
}

bool looks_binary(const std::string& bytes) {
  if (bytes.size() < 84) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  return bytes.size() == 84 + static_cast<std::size_t>(count) * 50;
}

}  // namespace

std::size_t TriangleMesh::open_edges() const {
  // Per edge from its lower to its higher point: triangles one way less triangles the other way.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t from = t[c], to = t[(c + 1) % 3];
      edges[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
    }
  return static_cast<std::size_t>(
      std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 0; }));
}

TriangleMesh read_stl(const std::string& path) {
  const SourceText source = SourceText::read(path);
  if (source.text().empty()) fail_on_file(path, "is empty; an STL file was expected", "stl-empty");
  TriangleMesh mesh;
  if (looks_binary(source.text()))
    mesh = read_binary(source);
  else if (source.text().find("facet") != std::string::npos)
    mesh = read_ascii(source);
  else
    fail_on_file(path, "is not an STL file: neither 84 + 50 n bytes nor the word 'facet'", "stl-format");
  if (mesh.triangles.empty()) fail_on_file(path, "has no triangle", "stl-empty");
  return mesh;
}

TriangleMesh closed_mesh(TriangleMesh mesh, const std::string& path, std::string_view so) {
  if (const std::size_t open = mesh.open_edges(); open > 0)
    fail_on_file(path,
                 fmt::format("the mesh is not closed: {} of its edges {} no second triangle, {}", open,
                             open == 1 ? "has" : "have", so),
                 "stl-open");
  return mesh;
}

std::string stl_text(const TriangleMesh& mesh) {
  std::string out(80, ' ');
  const auto append = [&](const auto& v) { out.append(reinterpret_cast<const char*>(&v), sizeof v); };
  append(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) append(0.0F);
    for (const std::uint32_t corner : t)
      for (int a = 0; a < 3; ++a) append(mesh.points[corner][a]);
    append(std::uint16_t{0});
  }
  return out;
}

bool is_step_file(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos) return false;
  std::string end = path.substr(dot + 1);
  std::ranges::transform(end, end.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return end == "step" || end == "stp";
}

TriangleMesh read_mesh(const std::string& path) { return is_step_file(path) ? read_step(path) : read_stl(path); }

#ifndef CAMBER_OPENCASCADE
TriangleMesh read_step(const std::string& path) {
  fail_on_file(path,
               "this build does not read STEP files; an STL file was expected, or a build configured with "
               "-DCAMBER_OPENCASCADE=ON (scripts/install-packages --step installs Open CASCADE)",
               "step-not-built");
}
#endif

}  // namespace camber
