#include "report/check_summary.h"

#include <cstring>

#include "base/json.h"
#include "base/output_file.h"

namespace camber::report {
namespace {

void pad(std::string& out) { out.append((4 - out.size() % 4) % 4, '\0'); }

/// The machine is little endian, as every one that Camber is built for.
template <class T, class Get>
void add(std::string& out, std::size_t count, Get get) {
  const std::size_t at = out.size();
  out.resize(at + count * sizeof(T));
  for (std::size_t i = 0; i < count; ++i) {
    const T value = static_cast<T>(get(i));
    std::memcpy(out.data() + at + i * sizeof(T), &value, sizeof(T));
  }
  pad(out);
}

/// Whether a block was rewritten makes no difference here.
PathKind kind_of(PathKind kind) {
  if (kind == PathKind::kept_line) return PathKind::line;
  return kind == PathKind::kept_arc ? PathKind::arc : kind;
}

std::string head_of(const PathPicture& picture, const Vec3& origin, bool in_part) {
  Json arrays = Json::array();
  for (const auto& [name, type] : {std::pair{"x", "f4"},
                                   {"y", "f4"},
                                   {"z", "f4"},
                                   {"line", "u4"},
                                   {"feed_mm_per_min", "f4"},
                                   {"tool", "u2"},
                                   {"kind", "u1"}})
    arrays.push_back(Json::array({name, type}));
  Json head{{"camber_path", 1},
            {"points", picture.points.size()},
            {"origin_mm", Json::array({origin.x(), origin.y(), origin.z()})},
            {"chord_mm", picture.chord_mm},
            {"thinned", picture.thinned},
            {"in_part", in_part}};
  head["arrays"] = arrays;
  std::string text = head.dump();
  text.append((4 - (text.size() + 1) % 4) % 4, ' ');
  return text + "\n";
}

}  // namespace

std::string path_arrays(const PathPicture& picture, bool in_part) {
  const std::size_t n = picture.points.size();
  const Vec3 origin = n > 0 ? picture.points.front() : Vec3(Vec3::Zero());
  std::string out = head_of(picture, origin, in_part);
  for (int axis = 0; axis < 3; ++axis)
    add<float>(out, n, [&](std::size_t i) { return picture.points[i][axis] - origin[axis]; });
  add<std::uint32_t>(out, n, [&](std::size_t i) { return picture.block[i] + 1; });
  add<float>(out, n, [&](std::size_t i) { return picture.feed_mm_per_min[i]; });
  add<std::uint16_t>(out, n, [&](std::size_t i) { return picture.tool[i]; });
  add<std::uint8_t>(out, n, [&](std::size_t i) { return kind_of(picture.kind[i]); });
  return out;
}

void write_path_arrays(const std::string& path, const PathPicture& picture, bool in_part) {
  write_file(path, path_arrays(picture, in_part));
}

}  // namespace camber::report
