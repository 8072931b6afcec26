#pragma once
// The rules behind the table of plausibility/plausibility.cpp. Internal to this room.
#include "base/diagnostics.h"
#include "plausibility/evidence.h"

namespace camber::plausibility {

// tool_rules.cpp: the tool table against the comments, against itself, and against what the path asks of it.
void look_at_comments(const Evidence& e, Diagnostics& diagnostics);
void look_at_overhang(const Evidence& e, Diagnostics& diagnostics);
void look_at_proportions(const Evidence& e, Diagnostics& diagnostics);
void look_at_path_shape(const Evidence& e, Diagnostics& diagnostics);

// cutting_rules.cpp: feeds, speeds, depths, material, travel.
void look_at_chips(const Evidence& e, Diagnostics& diagnostics);
void look_at_speed(const Evidence& e, Diagnostics& diagnostics);
void look_at_depth(const Evidence& e, Diagnostics& diagnostics);
void look_at_power(const Evidence& e, Diagnostics& diagnostics);
void look_at_material(const Evidence& e, Diagnostics& diagnostics);
void look_at_travel(const Evidence& e, Diagnostics& diagnostics);

// stock_rules.cpp: the stock against path and part.
void look_at_stock_top(const Evidence& e, Diagnostics& diagnostics);
void look_at_stock_place(const Evidence& e, Diagnostics& diagnostics);
void look_at_removal(const Evidence& e, Diagnostics& diagnostics);
void look_at_allowance(const Evidence& e, Diagnostics& diagnostics);

// part_rules.cpp: the part against path and stock.
void look_at_part(const Evidence& e, Diagnostics& diagnostics);
void look_at_part_in_stock(const Evidence& e, Diagnostics& diagnostics);

}  // namespace camber::plausibility
