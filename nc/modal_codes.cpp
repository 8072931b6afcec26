#include "nc/modal_codes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace camber::nc {
namespace {

struct Entry {
  int tenths;
  GCode code;
};

constexpr GCode not_read(std::string_view name, bool owns_words = true) { return {GGroup::not_read, name, owns_words}; }

/// In ascending order. Codes of one group that follow each other in tens are listed one by one on purpose: this
/// is the place to look a code up.
constexpr std::array kCodes = {
    Entry{0, {GGroup::motion}},
    Entry{10, {GGroup::motion}},
    Entry{20, {GGroup::motion}},
    Entry{21, {GGroup::motion}},
    Entry{30, {GGroup::motion}},
    Entry{31, {GGroup::motion}},
    Entry{40, {GGroup::one_shot}},
    Entry{50, {GGroup::contouring}},
    Entry{51, {GGroup::contouring}},
    Entry{52, not_read("spline")},
    Entry{53, not_read("spline")},
    Entry{62, not_read("spline")},
    Entry{80, {GGroup::contouring}},
    Entry{90, {GGroup::one_shot}},
    Entry{100, {GGroup::frame}},
    Entry{110, {GGroup::no_effect}},
    Entry{120, not_read("circular pocket")},
    Entry{130, not_read("circular pocket")},
    Entry{150, {GGroup::frame}},
    Entry{160, {GGroup::frame}},
    Entry{170, {GGroup::plane}},
    Entry{180, {GGroup::plane}},
    Entry{190, {GGroup::plane}},
    Entry{200, {GGroup::unit}},
    Entry{210, {GGroup::unit}},
    Entry{280, {GGroup::one_shot}},
    Entry{281, {GGroup::one_shot}},
    Entry{290, {GGroup::one_shot}},
    Entry{300, {GGroup::one_shot}},
    Entry{301, {GGroup::one_shot}},
    Entry{310, not_read("skip function of a probe")},
    Entry{330, not_read("thread cutting, the spindle in step")},
    Entry{331, not_read("rigid tapping")},
    Entry{382, not_read("probing")},
    Entry{383, not_read("probing")},
    Entry{384, not_read("probing")},
    Entry{385, not_read("probing")},
    Entry{400, {GGroup::cutter_radius}},
    Entry{410, {GGroup::cutter_radius}},
    Entry{411, {GGroup::cutter_radius}},
    Entry{420, {GGroup::cutter_radius}},
    Entry{421, {GGroup::cutter_radius}},
    Entry{430, {GGroup::tool_length}},
    Entry{431, {GGroup::tool_length}},
    Entry{434, {GGroup::tool_length}},
    Entry{435, {GGroup::tool_length}},
    Entry{440, {GGroup::tool_length}},
    Entry{490, {GGroup::tool_length}},
    Entry{500, {GGroup::frame}},
    Entry{501, {GGroup::frame}},
    Entry{510, {GGroup::frame}},
    Entry{511, {GGroup::frame}},
    Entry{520, {GGroup::frame}},
    Entry{530, {GGroup::one_shot}},
    Entry{531, {GGroup::frame}},
    Entry{536, not_read("turns the tool along Z of a tilted frame about its tip")},
    Entry{540, {GGroup::work_offset}},
    Entry{541, {GGroup::work_offset}},
    Entry{550, {GGroup::work_offset}},
    Entry{560, {GGroup::work_offset}},
    Entry{570, {GGroup::work_offset}},
    Entry{580, {GGroup::work_offset}},
    Entry{590, {GGroup::work_offset}},
    Entry{591, {GGroup::work_offset}},
    Entry{592, {GGroup::work_offset}},
    Entry{593, {GGroup::work_offset}},
    Entry{600, {GGroup::one_shot}},
    Entry{610, {GGroup::path_control}},
    Entry{611, {GGroup::path_control}},
    Entry{620, {GGroup::path_control}},
    Entry{630, {GGroup::path_control}},
    Entry{640, {GGroup::path_control}},
    Entry{650, {GGroup::macro}},
    Entry{660, {GGroup::macro}},
    Entry{670, {GGroup::macro}},
    Entry{680, {GGroup::frame}},
    Entry{682, {GGroup::frame}},
    Entry{683, not_read("tilted frame from the direction of the tool")},
    Entry{684, not_read("tilted frame on a tilted frame")},
    Entry{690, {GGroup::frame}},
    Entry{730, {GGroup::cycle}},
    Entry{740, {GGroup::cycle}},
    Entry{760, {GGroup::cycle}},
    Entry{800, {GGroup::cycle}},
    Entry{810, {GGroup::cycle}},
    Entry{820, {GGroup::cycle}},
    Entry{830, {GGroup::cycle}},
    Entry{840, {GGroup::cycle}},
    Entry{842, {GGroup::cycle}},
    Entry{843, {GGroup::cycle}},
    Entry{850, {GGroup::cycle}},
    Entry{860, {GGroup::cycle}},
    Entry{870, {GGroup::cycle}},
    Entry{880, {GGroup::cycle}},
    Entry{890, {GGroup::cycle}},
    Entry{900, {GGroup::distance}},
    Entry{901, {GGroup::arc_distance}},
    Entry{910, {GGroup::distance}},
    Entry{911, {GGroup::arc_distance}},
    Entry{920, {GGroup::frame}},
    Entry{921, {GGroup::frame}},
    Entry{922, {GGroup::frame}},
    Entry{923, {GGroup::frame}},
    Entry{930, {GGroup::feed_mode}},
    Entry{940, {GGroup::feed_mode}},
    Entry{950, {GGroup::feed_mode}},
    Entry{960, {GGroup::turning, "constant cutting speed"}},
    Entry{970, {GGroup::no_effect}},
    Entry{980, {GGroup::return_level}},
    Entry{990, {GGroup::return_level}},
    Entry{1030, {GGroup::no_effect}},
    Entry{1120, {GGroup::turning, "polar interpolation"}},
    Entry{1121, {GGroup::turning, "polar interpolation"}},
    Entry{1221, {GGroup::turning, "radius or diameter of X on a mill-turn machine"}},
    Entry{1231, {GGroup::turning, "radius or diameter of X on a mill-turn machine"}},
    Entry{1430, not_read("tool length compensation of five axes")},
    Entry{1540, {GGroup::work_offset}},
    Entry{1870, {GGroup::no_effect}},
    Entry{2340, {GGroup::tool_length}},
    Entry{2540, {GGroup::frame}},
    Entry{2550, {GGroup::frame}},
    Entry{2680, not_read("tilted frame of Haas")},
    Entry{2690, not_read("end of the tilted frame of Haas", false)},
};

static_assert(std::is_sorted(kCodes.begin(), kCodes.end(),
                             [](const Entry& a, const Entry& b) { return a.tenths < b.tenths; }));

}  // namespace

GCode g_code(int tenths) {
  if (tenths == std::lround(10 * kCycle832) || tenths == std::lround(10 * kCycle832Off)) return {GGroup::contouring};
  const auto it = std::lower_bound(kCodes.begin(), kCodes.end(), tenths,
                                   [](const Entry& e, int value) { return e.tenths < value; });
  return it != kCodes.end() && it->tenths == tenths ? it->code : GCode{};
}

std::vector<int> known_g_codes() {
  std::vector<int> codes;
  for (const Entry& e : kCodes) codes.push_back(e.tenths);
  return codes;
}

std::string_view group_name(GGroup group) {
  constexpr std::array<std::string_view, 20> kNames{
      // in the order of the enum
      "motion",        "cycle",       "plane",       "distance",     "arc distance", "feed mode", "unit",
      "cutter radius", "tool length", "work offset", "path control", "return level", "one block", "frame",
      "contouring",    "macro",       "no effect",   "not read",     "turning",      "unknown"};
  static_assert(kNames.size() == static_cast<std::size_t>(GGroup::unknown) + 1);
  return kNames[static_cast<std::size_t>(group)];
}

std::string_view group_name(MGroup group) {
  constexpr std::array<std::string_view, 9> kNames{
      // in the order of the enum
      "stop", "end", "spindle", "tool", "coolant", "no effect", "subprogram", "interruption", "unknown"};
  static_assert(kNames.size() == static_cast<std::size_t>(MGroup::unknown) + 1);
  return kNames[static_cast<std::size_t>(group)];
}

MGroup m_code(int tenths) {
  using enum MGroup;
  // Without effect: clamp and unclamp, spindle orientation, the tap that follows is rigid, spindle gear, overrides.
  constexpr std::pair<int, MGroup> kCodes[] = {
      {0, stop},         {10, stop},       {20, end},        {30, spindle},    {40, spindle},       {50, spindle},
      {60, tool},        {70, coolant},    {80, coolant},    {90, coolant},    {100, no_effect},    {110, no_effect},
      {130, spindle},    {140, spindle},   {190, no_effect}, {290, no_effect}, {300, end},          {400, no_effect},
      {410, no_effect},  {420, no_effect}, {430, no_effect}, {480, no_effect}, {490, no_effect},    {500, no_effect},
      {510, no_effect},  {520, no_effect}, {530, no_effect}, {600, stop},      {960, interruption}, {970, subprogram},
      {980, subprogram}, {990, subprogram}};
  for (const auto& [code, group] : kCodes)
    if (code == tenths) return group;
  return unknown;
}

}  // namespace camber::nc
