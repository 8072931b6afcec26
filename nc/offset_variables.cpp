#include "nc/offset_variables.h"

#include <array>
#include <span>

namespace camber::nc {
namespace {

using Kind = OffsetVariable::Kind;

constexpr int kPerOffset = 20;  ///< numbers from one work offset to the next
constexpr int kAxes = 6;

/// Variables above `first`, up to `count` of them, are one column of the memory of tool offsets.
struct Column {
  int first;
  int count;
  Kind kind;
};

constexpr std::array kFanuc{Column{2000, 200, Kind::tool_length_wear},  Column{2200, 200, Kind::tool_length},
                            Column{2400, 200, Kind::tool_radius},       Column{2600, 200, Kind::tool_radius_wear},
                            Column{10000, 999, Kind::tool_length_wear}, Column{11000, 999, Kind::tool_length},
                            Column{12000, 999, Kind::tool_radius_wear}, Column{13000, 999, Kind::tool_radius}};
constexpr std::array kHaas{Column{2000, 200, Kind::tool_length}, Column{2200, 200, Kind::tool_length_wear},
                           Column{2400, 200, Kind::tool_radius}, Column{2600, 200, Kind::tool_radius_wear}};
constexpr std::array kMazak{Column{2000, 200, Kind::tool_length_wear},  Column{2200, 200, Kind::tool_length},
                            Column{2400, 200, Kind::tool_radius},       Column{2600, 200, Kind::tool_radius_wear},
                            Column{10000, 999, Kind::tool_length_wear}, Column{11000, 999, Kind::tool_length},
                            Column{16000, 999, Kind::tool_radius},      Column{17000, 999, Kind::tool_radius_wear}};

std::span<const Column> columns_of(OffsetColumns columns) {
  switch (columns) {
    case OffsetColumns::fanuc:
      return kFanuc;
    case OffsetColumns::haas:
      return kHaas;
    case OffsetColumns::mazak:
      return kMazak;
    case OffsetColumns::none:
      break;
  }
  return {};
}

/// Looks up work offsets whose variables begin behind `first`; `number_of(0)` is the first of them.
template <class NumberOf>
std::optional<OffsetVariable> work_offset(int number, int first, int count, int axes, NumberOf number_of) {
  const int index = (number - first - 1) / kPerOffset, axis = (number - first - 1) % kPerOffset;
  if (number <= first || index >= count || axis >= axes) return std::nullopt;
  return OffsetVariable{Kind::work, number_of(index), axis};
}

}  // namespace

std::optional<OffsetVariable> offset_variable(const Dialect& dialect, int number) {
  const auto basic = [](int index) { return index < 6 ? 54 + index : 591 + index - 6; };
  if (!dialect.system_4000) {
    auto found = work_offset(number, 5220, 9, OffsetVariable::kRotation + 1, basic);
    return found && found->axis >= kAxes && found->axis != OffsetVariable::kRotation ? std::nullopt : found;
  }
  const auto additional = [](int index) { return 540000 + index + 1; };
  if (number > 5200 && number <= 5200 + kAxes) return OffsetVariable{Kind::external, 0, number - 5201};
  if (auto found = work_offset(number, 5220, 6, kAxes, basic)) return found;
  if (auto found = work_offset(number, 7000, 48, kAxes, additional)) return found;
  for (const Column& column : columns_of(dialect.offset_columns))
    if (number > column.first && number <= column.first + column.count)
      return OffsetVariable{column.kind, number - column.first, 0};
  return work_offset(number, 14000, 300, kAxes, additional);
}

}  // namespace camber::nc
