#include "kinematics/explain.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "kinematics/chain.h"

namespace camber::kinematics {
namespace {

using machine::PositiveTurn;
using machine::RotaryAxis;

/// Components of a unit vector below this are zero for the words.
constexpr double kZero = 1e-9;

char upper(char letter) { return static_cast<char>(std::toupper(static_cast<unsigned char>(letter))); }

std::string number(double value) { return format_trimmed(std::abs(value) < 5e-4 ? 0 : value, 3); }

std::string vector(const Vec3& v) { return fmt::format("({}, {}, {})", number(v.x()), number(v.y()), number(v.z())); }

/// "+X" and "the right", for a direction along an axis of the machine; else nothing.
struct Side {
  const char* name = nullptr;
  const char* words = nullptr;
};
Side side_of(const Vec3& direction) {
  constexpr std::array<Side, 6> kSides{Side{"+X", "the right"}, {"+Y", "behind"},    {"+Z", "above"},
                                       {"-X", "the left"},      {"-Y", "the front"}, {"-Z", "below"}};
  const Vec3 d = direction.normalized();
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    const Vec3 along = (i < 3 ? 1 : -1) * Vec3::Unit(static_cast<Eigen::Index>(i % 3));
    if ((d - along).norm() < kZero) return kSides.at(i);
  }
  return {};
}

std::string name_of(const Vec3& direction) {
  const Side side = side_of(direction);
  return side.name ? side.name : vector(direction.normalized());
}

const RotaryAxis& rotary(const machine::Machine& machine, char letter) {
  return machine.rotary[static_cast<std::size_t>(letter - 'a')];
}

std::string linear_motion(char letter, bool table) {
  const char name = upper(letter);
  if (table)
    return fmt::format("{0}+ moves the table towards -{0}; the tool moves towards +{0} relative to the part.", name);
  return fmt::format("{0}+ moves the head, and with it the tool, towards +{0}.", name);
}

/// Where the tool points in the part's frame when this axis alone is at +90 degrees.
std::string tool_at_90(const machine::Machine& machine, char letter) {
  Joints q;
  q.rotary_rad[letter - 'a'] = kPi / 2;
  const Vec3 axis = Chain(machine).pose(q, 0).axis;
  const Vec3 upright = machine.kinematics.tool_axis.normalized();
  if ((axis - upright).norm() < kZero) return fmt::format("{} alone does not tilt the tool.", upper(letter));
  return fmt::format("At {}90, the other axes at 0, the tool points along {} of the part, from tip to spindle.",
                     upper(letter), name_of(axis));
}

std::string rotary_motion(const machine::Machine& machine, char letter, bool table) {
  const RotaryAxis& axis = rotary(machine, letter);
  const Side side = side_of(axis.direction);
  const std::string seen = side.name ? fmt::format("seen from {} (from {})", side.name, side.words)
                                     : fmt::format("seen against its direction {}", name_of(axis.direction));
  const bool tool_turns_left = axis.positive == PositiveTurn::tool;
  const char* tool_way = tool_turns_left ? "counter-clockwise" : "clockwise";
  const char* table_way = tool_turns_left ? "clockwise" : "counter-clockwise";
  const std::string turn =
      table ? fmt::format("{}+ turns the table with the part {} {}; the tool turns {} relative to the part.",
                          upper(letter), table_way, seen, tool_way)
            : fmt::format("{}+ turns the head with the tool {} {}.", upper(letter), tool_way, seen);
  return turn + " " + tool_at_90(machine, letter);
}

void add_limit(std::string& out, double value, double scale, const char* name, const char* unit) {
  if (!std::isinf(value)) out += fmt::format("{}{} {} {}", out.empty() ? "" : ", ", name, number(value * scale), unit);
}

void add_travel(std::string& out, const std::array<double, 2>& travel, double scale, const char* unit) {
  const auto end = [&](double v) { return std::isinf(v) ? std::string("unlimited") : number(v * scale); };
  if (std::isinf(travel[0]) && std::isinf(travel[1])) return;
  out += fmt::format("travel {} to {} {}", end(travel[0]), end(travel[1]), unit);
}

std::string linear_limits(const machine::Axis& axis) {
  std::string out;
  add_travel(out, axis.travel_mm, 1, "mm");
  add_limit(out, axis.max_velocity_mm_per_s, 60, "speed", "mm/min");
  add_limit(out, axis.acceleration_mm_per_s2, 1, "acceleration", "mm/s2");
  return out;
}

std::string rotary_limits(const RotaryAxis& axis) {
  const double deg = deg_from_rad(1);
  std::string out;
  add_travel(out, axis.travel_rad, deg, "degrees");
  add_limit(out, axis.max_velocity_rad_per_s, 60 * deg, "speed", "degrees/min");
  add_limit(out, axis.acceleration_rad_per_s2, deg, "acceleration", "degrees/s2");
  // v / Kp (1 - Kf / 100), for 1000 degrees/min
  const double lag_deg = 1000. / 60 / axis.position_gain_per_s * (1 - axis.feed_forward_percent / 100);
  if (lag_deg > 0) out += fmt::format("{}lag {} degrees at 1000 degrees/min", out.empty() ? "" : ", ", number(lag_deg));
  if (axis.shortest_way) out += fmt::format("{}absolute words by the shortest way", out.empty() ? "" : ", ");
  if (axis.clamp_m > 0)
    out += fmt::format("{}clamped by M{}, released by M{}", out.empty() ? "" : ", ", axis.clamp_m, axis.unclamp_m);
  return out;
}

std::string type_of(const machine::Machine& machine) {
  const machine::Kinematics& k = machine.kinematics;
  const std::string letters = k.rotary_axes();
  if (letters.empty()) return "three axes";
  const auto on_table = std::ranges::count_if(k.chain.substr(0, k.table_axes), [](char c) { return c < 'x'; });
  const bool nutating =
      std::ranges::any_of(letters, [&](char c) { return side_of(rotary(machine, c).direction).name == nullptr; });
  const std::string prefix = nutating ? "nutating " : "";
  const auto on_head = static_cast<std::ptrdiff_t>(letters.size()) - on_table;
  if (letters.size() == 1) return prefix + (on_table > 0 ? "rotary table, four axes" : "rotary head, four axes");
  if (letters.size() == 3) return prefix + "six axes";
  return prefix + (on_table == 2 ? "table-table" : on_head == 2 ? "head-head" : "head-table");
}

std::vector<std::string> drawing_of(const machine::Machine& machine) {
  const machine::Kinematics& k = machine.kinematics;
  std::vector<std::string> out{"part"};
  const auto add = [&](const std::string& text) {
    out.push_back(std::string(2 * (out.size() - 1), ' ') + "└ " + text);
  };
  for (std::size_t i = 0; i <= k.chain.size(); ++i) {
    if (i == k.table_axes) add("bed");
    if (i == k.chain.size()) break;
    const char letter = k.chain[i];
    const char* carrier = i < k.table_axes ? "table" : "head";
    if (letter >= 'x')
      add(fmt::format("{}  {}, linear", upper(letter), carrier));
    else
      add(fmt::format("{}  {}, about {} through {} mm", upper(letter), carrier,
                      name_of(rotary(machine, letter).direction), vector(rotary(machine, letter).point_mm)));
  }
  add(fmt::format("spindle, tool along {}", name_of(k.tool_axis)));
  return out;
}

std::vector<std::string> reach_of(const machine::Machine& machine) {
  const Chain chain(machine);
  const std::string& letters = chain.rotary_axes();
  if (letters.size() < 2) return {};
  const char first = upper(letters[0]);
  if (letters.size() == 3)
    return {"Three rotary axes: a direction of the tool has infinitely many solutions; the nearest one is taken."};
  const auto range = chain.tilt_range_rad();
  return {
      fmt::format("Without limits of travel, the tool takes angles of {} to {} degrees with the axis of {}.",
                  number(deg_from_rad(range[0])), number(deg_from_rad(range[1])), first),
      fmt::format("Every direction in between has two solutions. Where the tool is parallel to the axis of {0} (the "
                  "pole), {0} is free.",
                  first)};
}

}  // namespace

Explanation explain(const machine::Machine& machine) {
  const machine::Kinematics& k = machine.kinematics;
  Explanation out;
  out.type = type_of(machine);
  out.drawing = drawing_of(machine);
  for (std::size_t i = 0; i < k.chain.size(); ++i) {
    const char letter = k.chain[i];
    const bool table = i < k.table_axes, turns = letter < 'x';
    out.axes.push_back({upper(letter), turns, table,
                        turns ? rotary_motion(machine, letter, table) : linear_motion(letter, table),
                        turns ? rotary_limits(rotary(machine, letter))
                              : linear_limits(machine.axis[static_cast<std::size_t>(letter - 'x')])});
  }
  out.reach = reach_of(machine);
  return out;
}

std::string to_text(const Explanation& explanation, const std::string& machine_path) {
  std::string out = fmt::format("{}: {}\n\n", machine_path, explanation.type);
  for (const std::string& line : explanation.drawing) out += "  " + line + "\n";
  out += "\n";
  for (const AxisExplanation& axis : explanation.axes) {
    out += axis.motion + "\n";
    if (!axis.limits.empty()) out += "    " + axis.limits + "\n";
  }
  if (!explanation.reach.empty()) out += "\n";
  for (const std::string& sentence : explanation.reach) out += sentence + "\n";
  return out;
}

}  // namespace camber::kinematics
