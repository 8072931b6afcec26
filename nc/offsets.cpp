#include "nc/offsets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/numbers.h"
#include "nc/modal_codes.h"

namespace camber::nc {

std::optional<int> work_offset_number(std::string_view name) {
  for (const std::string_view prefix : {"G54.1P", "G154P"}) {
    if (!name.starts_with(prefix)) continue;
    const auto p = parse_number(name.substr(prefix.size()));
    return p && *p >= 1 && *p <= 999 && *p == std::floor(*p) ? std::optional(540000 + static_cast<int>(*p))
                                                             : std::nullopt;
  }
  if (name.size() == 4 && name.front() == 'G')
    if (const auto g = parse_number(name.substr(1)); g && *g == std::floor(*g))
      if (const int additional = haas_work_offset_of(static_cast<int>(*g) * 10)) return 540000 + additional;
  constexpr std::array<std::pair<std::string_view, int>, 9> kNames{{{"G54", 54},
                                                                    {"G55", 55},
                                                                    {"G56", 56},
                                                                    {"G57", 57},
                                                                    {"G58", 58},
                                                                    {"G59", 59},
                                                                    {"G59.1", 591},
                                                                    {"G59.2", 592},
                                                                    {"G59.3", 593}}};
  const auto at = std::ranges::find(kNames, name, &std::pair<std::string_view, int>::first);
  return at == kNames.end() ? std::nullopt : std::optional(at->second);
}

WorkOffsets::WorkOffsets(const std::map<int, Vec3>& given_mm) {
  for (const auto& [number, value_mm] : given_mm) offsets_[number] = {.value_mm = value_mm, .known = true};
}

bool WorkOffsets::known(int number) const {
  const auto it = offsets_.find(number);
  return it != offsets_.end() && it->second.known;
}

double WorkOffsets::rotation_rad(int number) const {
  const auto it = offsets_.find(number);
  return it == offsets_.end() ? 0 : it->second.rotation_rad;
}

Vec3 WorkOffsets::rotary_rad(int number) const {
  const auto it = offsets_.find(number);
  return it == offsets_.end() ? Vec3(Vec3::Zero()) : it->second.rotary_rad;
}

Vec3 WorkOffsets::origin_mm(int number, bool first) {
  const WorkOffset& offset = offsets_[number];
  const Vec3 value = offset.value_mm + external_mm;
  if (first) anchor_known_ = anchor_unknown_ = std::nullopt;
  auto& anchor = offset.known ? anchor_known_ : anchor_unknown_;
  if (!anchor) anchor = value;
  return value - *anchor;
}

std::optional<Vec3> WorkOffsets::machine_origin_mm(int number) const {
  if (!known(number) || !anchor_known_) return std::nullopt;
  return Vec3(-*anchor_known_);
}

}  // namespace camber::nc
