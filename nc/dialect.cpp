#include "nc/dialect.h"

#include <algorithm>
#include <array>

#include "nc/program.h"

namespace camber::nc {
namespace {

/// Fanuc 0i, 16i, 30i with custom macro B. Sources: B-64484EN (custom macro) and the parameters named in dialect.h.
constexpr Dialect kFanuc{.control = ControlKind::fanuc, .name = "fanuc", .m98_count_in_p = true};

/// Haas mill operator's manual, macros: as Fanuc, but O numbers of five digits, so that P is always the whole number,
/// and common variables up to #999 without a gap.
constexpr Dialect kHaas{.control = ControlKind::haas,
                        .name = "haas",
                        .common = {{100, 999}, {10000, 10999}},
                        .rotation_r_adds_in_g91 = true};

/// Mazak EIA/ISO (Mazatrol's custom macro follows Fanuc's), O numbers of eight digits.
constexpr Dialect kMazak{.control = ControlKind::mazak, .name = "mazak", .common = {{100, 199}, {400, 999}}};

/// LinuxCNC 2.9; the facts of expressions were read off rs274 (tests/nc/macro_rs274_test.cpp holds them to it).
constexpr Dialect kLinuxCnc{.control = ControlKind::linuxcnc,
                            .name = "linuxcnc",
                            .dwell_p_is_ms = false,
                            .local = {1, 30},
                            .common = {{31, 5000}, {5429, 5601}},
                            .has_null = false,
                            .system_4000 = false,
                            .logic_is_bitwise = false,
                            .and_binds_as_product = false,
                            .fix_to_zero = false,
                            .mod_is_whole = false,
                            .atan_is_positive = false,
                            .round_to_increment = false,
                            .equal_within = 1e-4,
                            .g52_is_g92 = true,
                            .g10_adds_in_g91 = false,
                            .g10_p0_is_external = false,
                            .g10_l20_is_g54_1 = false,
                            .g41_1_has_diameter = true,
                            .radius_corner_lines = false,
                            .radius_entry_square = false,
                            .radius_exit_waits = false,
                            .radius_look_ahead = 1'000'000,
                            .max_levels = 10};

constexpr std::array kDialects{&kFanuc, &kHaas, &kMazak, &kLinuxCnc};

}  // namespace

const Dialect& dialect_of(ControlKind control) {
  return **std::find_if(kDialects.begin(), kDialects.end(), [&](const Dialect* d) { return d->control == control; });
}

std::optional<ControlKind> control_named(std::string_view name) {
  for (const Dialect* d : kDialects)
    if (d->name == name) return d->control;
  return std::nullopt;
}

std::optional<ControlKind> control_shown_by(const Program& program) {
  if (!program.macro.expressions.names.empty()) return ControlKind::linuxcnc;
  for (const Statement& s : program.macro.statements)
    if (s.o_word) return ControlKind::linuxcnc;
  if (program.macro.local_calls) return ControlKind::haas;
  return std::nullopt;
}

}  // namespace camber::nc
