#pragma once
// The table of controls; a new control is a row here, and a row in nc/dialects.h if no dialect there is its own.
// Include machine/control_kind.h instead, unless you check the table.
#include <array>

#include "machine/control_kind.h"

namespace camber::machine {

/// The first row is default_control_kind().
inline constexpr std::array kControlKinds{
    ControlKind{.name = "fanuc", .nc_dialect = "fanuc"},
    ControlKind{.name = "haas", .nc_dialect = "haas"},
    ControlKind{.name = "mazak", .nc_dialect = "mazak", .g61_1_stops = false},
    // Motion: from its traces (docs/feed-model.md). Starting values: its defaults of [TRAJ] ARC_BLEND_KINK_RATIO and
    // ARC_BLEND_OPTIMIZATION_DEPTH; short lines from its traces.
    ControlKind{.name = "linuxcnc",
                .nc_dialect = "linuxcnc",
                .rapid_path = RapidPath::linear,
                .g64_p_merges = true,
                .stops_between_rapid_and_feed = true,
                .waits_in_position = false,
                .g61_stops = false,
                .starts_on_period = true,
                .min_segment_periods = 1.02,  // TP_MIN_SEGMENT_CYCLES of its trajectory planner
                .rotary_feed = RotaryFeed::linear,
                .joint_limits = false,
                .turning_blocks_overlap = true,
                .helix_rise_frees_acceleration = true,
                .default_step_fraction = 0.1,
                .usual_lookahead_blocks = 50,
                .usual_short_line_periods = 4,
                .fits_short_lines = true},
    ControlKind{.name = "heidenhain", .nc_dialect = "heidenhain", .rapid_path = RapidPath::linear},
    ControlKind{.name = "siemens", .nc_dialect = "siemens", .rapid_path = RapidPath::linear},
};

}  // namespace camber::machine
