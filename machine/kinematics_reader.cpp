#include "machine/kinematics_reader.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "machine/machine_keys.h"
#include "machine/number_key.h"

namespace camber::machine {
namespace {

/// Two directions of which the sine of the angle between them is less count as parallel.
constexpr double kParallelSine = 1e-6;

bool is_rotary(char letter) { return letter >= 'a' && letter <= 'c'; }

bool is_axis(const std::string& word) {
  return word.size() == 1 && ((word[0] >= 'x' && word[0] <= 'z') || is_rotary(word[0]));
}

bool parallel(const Vec3& a, const Vec3& b) { return a.normalized().cross(b.normalized()).norm() < kParallelSine; }

std::optional<Vec3> read_vector(TomlTable& table, std::string_view key) {
  const auto numbers = table.numbers(key, 3, kAnyNumber, "three numbers [x, y, z]");
  if (!numbers) return std::nullopt;
  return Vec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

std::optional<Vec3> read_direction(TomlTable& table, std::string_view key) {
  auto direction = read_vector(table, key);
  if (!direction || direction->norm() > 1e-9) return direction;
  table.error_at(key, fmt::format("{} is [0, 0, 0]; a direction was expected, such as [0, 0, 1]", key),
                 "axis-direction");
  return std::nullopt;
}

void read_travel(TomlTable& table, RotaryAxis& axis) {
  const auto travel = table.numbers("travel_deg", 2, kAnyNumberOrInf, "[least, greatest]");
  if (!travel) return;
  axis.travel_rad = {rad_from_deg((*travel)[0]), rad_from_deg((*travel)[1])};
  if (!((*travel)[0] < (*travel)[1]))
    table.error_at("travel_deg",
                   fmt::format("travel_deg goes from {} to {}; the second must be greater than the first", (*travel)[0],
                               (*travel)[1]),
                   "value-range");
}

void read_clamp_codes(TomlTable& table, RotaryAxis& axis) {
  const auto codes = table.numbers("clamp_codes", 2, kMCode, "two M codes [clamp, release]");
  if (!codes) return;
  axis.clamp_m = static_cast<int>((*codes)[0]);
  axis.unclamp_m = static_cast<int>((*codes)[1]);
  if (axis.clamp_m == axis.unclamp_m)
    table.error_at(
        "clamp_codes",
        fmt::format("clamp_codes has M{} twice; different M codes [clamp, release] were expected", axis.clamp_m),
        "value-range");
}

void read_rotary_axis(TomlTable table, RotaryAxis& axis) {
  axis.given = true;
  for (const auto& [key, wanted] :
       {std::pair("direction", "a direction [x, y, z]"), std::pair("point_mm", "a point of the axis [x, y, z]")})
    if (!table.has(key)) table.missing(key, wanted);
  axis.direction = read_direction(table, "direction").value_or(axis.direction);
  axis.point_mm = read_vector(table, "point_mm").value_or(axis.point_mm);
  axis.positive = static_cast<PositiveTurn>(table.required_choice("positive", kPositiveTurnWords).value_or(0));
  axis.shortest_way = table.boolean("shortest_way", false);
  read_numbers<RotaryAxis>(table, kRotaryAxisKeys, axis);
  read_travel(table, axis);
  read_clamp_codes(table, axis);
  table.finish();
}

constexpr std::string_view kChainWanted =
    R"(a list from the part to the spindle such as ["part", "c", "a", "bed", "x", "y", "z", "spindle"])";

/// The letters of the chain in their order; errors where the list is not a chain.
std::string chain_of(TomlTable& table, const std::vector<std::string>& words, std::size_t& table_axes) {
  const auto wrong = [&](std::string message, const char* check) {
    table.error_at("chain", std::move(message), check);
    return std::string();
  };
  if (words.size() < 2 || words.front() != "part" || words.back() != "spindle")
    return wrong(R"(the chain must begin with "part" and end with "spindle")", "chain-ends");
  std::string letters;
  bool bed = false;
  for (std::size_t i = 1; i + 1 < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "bed" && bed) return wrong(R"("bed" occurs twice in the chain)", "chain-bed");
    if (word == "bed") {
      bed = true;
      table_axes = letters.size();
      continue;
    }
    if (!is_axis(word))
      return wrong(fmt::format(R"("{}" in the chain is not an axis; x, y, z, a, b, c or "bed" was expected)", word),
                   "chain-axis");
    if (letters.find(word) != std::string::npos)
      return wrong(fmt::format("axis {} occurs twice in the chain", word), "chain-axis");
    letters += word;
  }
  if (!bed)
    return wrong(
        R"("bed" is missing in the chain; it separates the axes that carry the part from those that carry the )"
        "spindle",
        "chain-bed");
  for (const char linear : {'x', 'y', 'z'})
    if (letters.find(linear) == std::string::npos)
      return wrong(fmt::format("axis {} is missing in the chain; x, y and z were expected", linear), "chain-axis");
  return letters;
}

/// The rotary axes must be there, and two neighbours must span the directions of the tool.
void check_rotary_axes(TomlTable& table, const Machine& machine) {
  const Kinematics& k = machine.kinematics;
  const std::string letters = k.rotary_axes();
  const auto axis = [&](char letter) -> const RotaryAxis& {
    return machine.rotary[static_cast<std::size_t>(letter - 'a')];
  };
  for (const char letter : letters)
    if (!axis(letter).given) {
      table.error_at("chain", fmt::format("the chain has axis {0}, but [axis.{0}] is missing", letter), "axis-missing");
      return;
    }
  for (std::size_t i = 1; i < letters.size(); ++i)
    if (parallel(axis(letters[i - 1]).direction, axis(letters[i]).direction))
      table.error_at("chain",
                     fmt::format("axes {} and {} follow each other in the chain and are parallel; they cannot tilt the "
                                 "tool in two directions",
                                 letters[i - 1], letters[i]),
                     "chain-parallel");
  if (letters.size() > 1 && parallel(axis(letters.back()).direction, k.tool_axis))
    table.error_at("chain",
                   fmt::format("axis {} is the last rotary axis before the spindle and parallel to the tool; it cannot "
                               "tilt the tool",
                               letters.back()),
                   "chain-parallel");
}

std::string vector_line(std::string_view key, const Vec3& v) {
  return fmt::format("{} = [{}, {}, {}]\n", key, toml_number(v.x(), kAsIs), toml_number(v.y(), kAsIs),
                     toml_number(v.z(), kAsIs));
}

}  // namespace

std::string Kinematics::rotary_axes() const {
  std::string letters;
  std::ranges::copy_if(chain, std::back_inserter(letters), is_rotary);
  return letters;
}

void read_rotary_axes(TomlTable& axes, Machine& machine) {
  for (std::size_t i = 0; i < kRotaryAxisNames.size(); ++i)
    if (auto axis = axes.table(kRotaryAxisNames[i])) read_rotary_axis(*axis, machine.rotary[i]);
}

void read_kinematics(TomlTable table, Machine& machine) {
  Kinematics& k = machine.kinematics;
  k.gauge_point_mm = read_vector(table, "gauge_point_mm").value_or(k.gauge_point_mm);
  k.tool_axis = read_direction(table, "tool_axis").value_or(k.tool_axis);
  if (!table.has("chain")) table.missing("chain", kChainWanted);
  if (const auto words = table.text_list("chain", kChainWanted)) k.chain = chain_of(table, *words, k.table_axes);
  if (k.given()) check_rotary_axes(table, machine);
  table.finish();
}

void check_kinematics(TomlTable& top, const Machine& machine) {
  const Kinematics& k = machine.kinematics;
  for (std::size_t i = 0; i < kRotaryAxisNames.size(); ++i) {
    const std::string_view name = kRotaryAxisNames[i];
    if (!machine.rotary[i].given || k.chain.find(name) != std::string::npos) continue;
    if (k.given())
      top.error_at("kinematics", fmt::format("[axis.{0}] is given, but the chain does not have {0}", name),
                   "chain-axis");
    else if (!top.has("kinematics"))
      top.error_at("axis",
                   fmt::format("[axis.{}] is given without [kinematics]; its chain from the part to the spindle was "
                               "expected",
                               name),
                   "chain-missing");
  }
  if (machine.index.present && k.chain.find('b') != std::string::npos)
    top.error_at("index", "[index] and [axis.b] both describe B; one of them was expected", "axis-twice");
}

std::string kinematics_text(const Kinematics& k) {
  if (!k.given()) return {};
  std::string out = "\n[kinematics]\nchain = [\"part\"";
  for (std::size_t i = 0; i <= k.chain.size(); ++i) {
    if (i == k.table_axes) out += ", \"bed\"";
    if (i < k.chain.size()) out += fmt::format(", \"{}\"", k.chain[i]);
  }
  return out + ", \"spindle\"]\n" + vector_line("gauge_point_mm", k.gauge_point_mm) +
         vector_line("tool_axis", k.tool_axis);
}

std::string rotary_axis_text(std::string_view name, const RotaryAxis& axis) {
  if (!axis.given) return {};
  std::string out = fmt::format("\n[axis.{}]\n", name);
  out += vector_line("direction", axis.direction) + vector_line("point_mm", axis.point_mm);
  out += toml_line("positive", kPositiveTurnWords[static_cast<std::size_t>(axis.positive)]);
  out += fmt::format("shortest_way = {}\n", axis.shortest_way);
  out += toml_lines<RotaryAxis>(kRotaryAxisKeys, axis);
  if (axis.clamp_m > 0) out += fmt::format("clamp_codes = [{}, {}]\n", axis.clamp_m, axis.unclamp_m);
  return out + fmt::format("travel_deg = [{}, {}]\n", toml_number(axis.travel_rad[0], kDegrees),
                           toml_number(axis.travel_rad[1], kDegrees));
}

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
