#include "nc/offsets.h"

namespace camber::nc {

WorkOffsets::WorkOffsets(const std::map<int, Vec3>& given_mm) {
  for (const auto& [number, value_mm] : given_mm) offsets_[number] = {value_mm, 0, true};
}

bool WorkOffsets::known(int number) const {
  const auto it = offsets_.find(number);
  return it != offsets_.end() && it->second.known;
}

double WorkOffsets::rotation_rad(int number) const {
  const auto it = offsets_.find(number);
  return it == offsets_.end() ? 0 : it->second.rotation_rad;
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
