#include "machine/body_reader.h"

#include <filesystem>

#include <fmt/format.h>

#include "machine/number_key.h"

namespace camber::machine {
namespace {

namespace fs = std::filesystem;

/// How many axes of the chain are between the part and what carries a body; nothing where the chain does not have it.
std::optional<std::size_t> axes_to(const std::string& on, const Kinematics& k) {
  constexpr std::size_t kLinearAxes = 3;
  if (on == "part") return 0;
  if (on == "spindle") return k.given() ? k.chain.size() : kLinearAxes;
  if (on == "bed" && k.given()) return k.table_axes;
  const std::size_t at = on.size() == 1 ? k.chain.find(on[0]) : std::string::npos;
  if (at == std::string::npos) return std::nullopt;
  return at < k.table_axes ? at : at + 1;
}

std::string words_of(const Kinematics& k) {
  if (!k.given()) return "part or spindle";
  std::string out = "part";
  for (const char axis : k.chain) out += fmt::format(", {}", axis);
  return out + ", bed or spindle";
}

void read_on(TomlTable& table, const Kinematics& k, Body& body) {
  const std::string wanted = words_of(k);
  if (!table.has("on")) return table.missing("on", fmt::format("what carries the body, {},", wanted));
  body.on = table.text("on", "");
  if (body.on.empty()) return;
  if (const auto axes = axes_to(body.on, k))
    body.axes = *axes;
  else
    table.error_at("on", fmt::format("on is \"{}\"; {} was expected", body.on, wanted), "value-choice");
}

void read_box(TomlTable& table, Body& body) {
  const auto rows =
      table.number_rows("box_mm", 2, 3, kAnyNumber, "[[x, y, z], [x, y, z]], the least and the greatest corner,");
  if (!rows) return;
  body.box_mm.emplace();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double low = (*rows)[0][static_cast<std::size_t>(i)], high = (*rows)[1][static_cast<std::size_t>(i)];
    (*body.box_mm)[0][i] = low, (*body.box_mm)[1][i] = high;
    if (!(low < high))
      table.error_at("box_mm",
                     fmt::format("box_mm goes from {0} = {1} to {0} = {2}; the second must be greater than the first",
                                 "xyz"[i], low, high),
                     "body-box");
  }
}

void read_mesh(TomlTable& table, const fs::path& folder, Body& body) {
  const std::string given = table.text("mesh", "");
  if (given.empty()) return;
  std::error_code ec;
  const fs::path path = fs::absolute((folder / given), ec).lexically_normal();
  body.mesh = path.string();
  if (!fs::exists(path, ec))
    table.error_at("mesh",
                   fmt::format("mesh: no such file: {} (paths are relative to the machine's folder)",
                               (folder / given).lexically_normal().string()),
                   "file-missing");
  else if (fs::is_directory(path, ec))
    table.error_at(
        "mesh", fmt::format("mesh: {} is a folder; a file was expected", (folder / given).lexically_normal().string()),
        "file-unreadable");
}

Body read_body(TomlTable table, std::size_t number, const Machine& machine) {
  Body body;
  body.name = table.text("name", fmt::format("body {}", number));
  read_on(table, machine.kinematics, body);
  read_box(table, body);
  read_mesh(table, fs::path(machine.path).parent_path(), body);
  if (table.has("box_mm") && table.has("mesh"))
    table.error_at_name("mesh", "the body has box_mm and mesh; one of them was expected", "body-shape");
  else if (!table.has("box_mm") && !table.has("mesh"))
    table.missing("box_mm", "box_mm = [[x, y, z], [x, y, z]] or mesh");
  table.finish();
  return body;
}

}  // namespace

void read_bodies(TomlTable& top, Machine& machine) {
  if (top.has("kinematics") && !machine.kinematics.given()) return top.ignore("body");  // the chain is at fault
  std::size_t number = 0;
  for (TomlTable& table : top.tables("body")) machine.bodies.push_back(read_body(std::move(table), ++number, machine));
}

std::string body_text(const Body& body) {
  std::string out = "\n[[body]]\n" + toml_line("name", body.name) + toml_line("on", body.on);
  if (!body.box_mm) return out + toml_line("mesh", body.mesh);
  const auto corner = [](const Vec3& p) {
    return fmt::format("[{}, {}, {}]", toml_number(p.x(), kAsIs), toml_number(p.y(), kAsIs), toml_number(p.z(), kAsIs));
  };
  return out + fmt::format("box_mm = [{}, {}]\n", corner((*body.box_mm)[0]), corner((*body.box_mm)[1]));
}

}  // namespace camber::machine
