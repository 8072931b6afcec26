#pragma once
// Set-up checks: consistency of stock, part, tools and program before the simulation, and whether anything is cut at
// all.
#include <optional>
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "nc/move.h"
#include "nc/program_text.h"
#include "nc/summary.h"
#include "removal/tool_path.h"

namespace camber::checks {

/// Where the tip goes in the moves that cut.
nc::Extents tip_extents(const nc::Interpretation& moves, const std::vector<bool>& selected,
                        const std::vector<removal::HoleMove>& holes);

/// Where a program's tip goes, and what it meets.
struct Places {
  nc::Extents tip;
  double radius_mm = 0;  ///< of the widest tool
  machine::Box stock;
};

/// Errors at the program's file: [nothing-removed] where tools and stock cannot meet, [stock-units] where the stock
/// would fit the program at 25.4 times its size; a warning [program-units] where the program would fit the stock at
/// 25.4 times its size. A message says where both lie.
void check_places(const std::string& program, const Places& places, Diagnostics& diagnostics);

/// Error [nothing-removed]: the undeflected sweep took nothing.
void report_nothing_removed(const std::string& program, const Places& places, Diagnostics& diagnostics);

machine::Box box_of(const TriangleMesh& mesh);

/// Error [part-units] where the part's mesh would fit the stock at 25.4 times its size, or that much smaller.
void check_part_size(const std::string& part, const machine::Box& mesh, const machine::Box& stock,
                     Diagnostics& diagnostics);

/// Error [allowance-too-large]: the cutter made smaller by the allowance meets nothing, so no cut before left it.
void report_allowance(const machine::Job& job, Diagnostics& diagnostics);

/// The beam's lengths over their diameters, added up: of flutes, neck and shank.
double slenderness(const machine::Tool& tool);
/// A static beam does not describe longer tools.
constexpr double kMaxSlenderness = 15;

/// Of the job's stock; nothing for a .vdb, whose box is known once it is read. Throws InputError.
std::optional<machine::Box> stock_box(const machine::Job& job);

/// What camber check asks of a program before any of it is simulated: [tool-missing] and the like (job_checks.h), and
/// whether program, stock and part lie together.
void check_job(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves,
               Diagnostics& diagnostics);

/// Numbers of the tools that cut, ascending.
std::vector<int> cutting_tools(const nc::Interpretation& moves, const std::vector<bool>& selected,
                               const std::vector<removal::HoleMove>& holes);

}  // namespace camber::checks
