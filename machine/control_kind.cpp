#include "machine/control_kind.h"

#include <algorithm>

#include "machine/control_kinds.h"

namespace camber::machine {

std::span<const ControlKind> control_kinds() { return kControlKinds; }

std::vector<std::string_view> control_kind_names() {
  std::vector<std::string_view> names;
  for (const ControlKind& kind : kControlKinds) names.push_back(kind.name);
  return names;
}

const ControlKind& default_control_kind() { return kControlKinds.front(); }

const ControlKind* control_kind_named(std::string_view name) {
  const auto found = std::ranges::find(kControlKinds, name, &ControlKind::name);
  return found != kControlKinds.end() ? &*found : nullptr;
}

}  // namespace camber::machine
