#pragma once
// The table of NC dialects; a new dialect is a row here. Include nc/dialect.h instead, unless you check the table.
#include <array>

#include "nc/dialect.h"
#include "nc/five_axis_words.h"

namespace camber::nc {

/// Fanuc 0i, 16i, 30i with custom macro B. Sources: B-64484EN (custom macro) and the parameters named in dialect.h.
inline constexpr Dialect kFanuc{.name = "fanuc",
                                .title = "Fanuc",
                                .whole_numbers_setting = "decimal point input, parameter 3401#0",
                                .m98_count_in_p = true};

/// Haas mill operator's manual, macros: as Fanuc, but O numbers of five digits, so that P is always the whole number,
/// and common variables up to #999 without a gap.
inline constexpr Dialect kHaas{.name = "haas",
                               .title = "Haas",
                               .shown_by_m97 = true,
                               .haas_work_offsets = true,
                               .pecks_by_ijk = true,
                               .whole_numbers_setting = "default to float, setting 162",
                               .whole_feed_mm = 0.001,  // setting 77 at DEFAULT
                               .whole_feed_inch = 0.0001,
                               .whole_feed_per_turn_mm = 0.001,
                               .whole_feed_per_turn_inch = 0.0001,
                               .common = {{100, 999}, {10000, 10999}},
                               .offset_columns = OffsetColumns::haas,
                               .rotation_r_adds_in_g91 = true};

/// Mazak EIA/ISO (Mazatrol's custom macro follows Fanuc's), O numbers of eight digits.
inline constexpr Dialect kMazak{.name = "mazak",
                                .title = "Mazak EIA",
                                .whole_numbers_setting = "decimal point input",
                                .common = {{100, 199}, {400, 999}},
                                .offset_columns = OffsetColumns::mazak};

/// LinuxCNC 2.9; the facts of expressions were read off rs274 (tests/nc/macro_rs274_test.cpp holds them to it).
inline constexpr Dialect kLinuxCnc{.name = "linuxcnc",
                                   .title = "LinuxCNC",
                                   .shown_by_o_words = true,
                                   .has_program_number = false,
                                   .g64_p_is_tolerance = true,
                                   .program_end = "M2",
                                   .file_extension = ".ngc",
                                   .semicolon_ends_block = false,
                                   .strict = true,
                                   .corner_words = false,
                                   .d_is_modal = false,
                                   .dwell_takes_p_alone = true,
                                   .stores_reference_points = true,
                                   .dwell_p_is_ms = false,
                                   .local = {1, 30},
                                   .common = {{31, 5000}, {5429, 5601}},
                                   .has_null = false,
                                   .system_4000 = false,
                                   .offset_columns = OffsetColumns::none,
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
                                   .spiral_radius_fraction = 0.001,  // SPIRAL_RELATIVE_TOLERANCE in interp_internal.hh
                                   .spiral_max_mm = 2.828,           // 100 times CENTER_ARC_RADIUS_TOLERANCE_MM
                                   .tip_control_on_m = 428,  // of its switchable kinematics, as its samples map them
                                   .tip_control_off_m = 429,
                                   .max_levels = 10};

/// TNC 530, 640, TNC7 and their like.
inline constexpr Dialect kHeidenhain{.language = LanguageId::heidenhain,
                                     .name = "heidenhain",
                                     .title = "Heidenhain",
                                     .has_program_number = false,
                                     .program_end = "M30",
                                     .file_extension = ".h"};

/// 840D, 828D, Sinumerik One.
inline constexpr Dialect kSiemens{.language = LanguageId::siemens,
                                  .name = "siemens",
                                  .title = "Siemens",
                                  .has_program_number = false,
                                  .program_end = "M30",
                                  .file_extension = ".mpf",
                                  .semicolon_ends_block = false,
                                  .dwell_p_is_ms = false};

/// The first row is default_dialect().
inline constexpr std::array kDialects{kFanuc, kHaas, kMazak, kLinuxCnc, kHeidenhain, kSiemens};

/// Words of five axes: a row for each of kDialects. LinuxCNC has no tilted frames.
inline constexpr std::array<FiveAxisWords, kDialects.size()> kFiveAxisWords{
    {{},
     {.tip_control = "G234", .one_direction = OneDirection::dynamic, .dynamic_offset = true},
     {},
     {.one_direction = OneDirection::joints, .tilted_frames = false},
     {},
     {}}};

}  // namespace camber::nc
