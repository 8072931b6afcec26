#pragma once
// Words of the files of camber plan.
#include <array>
#include <string_view>

namespace camber::plan {

inline constexpr std::array<std::string_view, 2> kFinishWords{"rough", "fine"};
inline constexpr std::array<std::string_view, 2> kMachiningWords{"usual", "fast"};

}  // namespace camber::plan
