#pragma once
// A program's cutting moves and rapids over a height map of its stock (removal/height_map.h): what each move removes,
// and where the tool meets material that it must not. Upright tools; seconds for programs of any length.
#include <cstdint>
#include <optional>
#include <vector>

#include "base/diagnostics.h"
#include "checks/collisions.h"
#include "machine/job_file.h"
#include "motion/simulated_program.h"
#include "removal/height_map.h"

namespace camber::checks {

/// What a move does to the stock.
struct MoveCut {
  double length_mm = 0;               ///< of the move
  double cutting_mm = 0;              ///< of this length, where it removes material
  double beside_mm = 0;               ///< of this length, where the blank never had material for the cutter
  double approach_mm = 0;             ///< the same of mills that move straight up or down; not in beside_mm
  double volume_mm3 = 0;              ///< removed
  double area_mm2 = 0;                ///< removed, seen from above
  double deepest_mm = 0;              ///< largest height of a removed column
  double above_tip_mm = 0;            ///< highest material removed, above the tip
  Vec3 deepest_place = Vec3::Zero();  ///< of the tip
};

/// A cut above the flutes' end.
struct CutAboveFlutes {
  std::uint32_t move = 0;
  double above_tip_mm = 0;
};

struct HeightSurvey {
  double cell_mm = 0;
  std::vector<MoveCut> moves;                  ///< one per move of the program; zero for those that do not cut
  std::vector<Collision> collisions{};         ///< as find_collisions(); without t_s
  std::vector<CutAboveFlutes> above_flutes{};  ///< the first of every block
  double blank_mm3 = 0, removed_mm3 = 0;
  double allowance_mm3 = 0;         ///< removed before, up to the allowance
  bool starts_in_material = false;  ///< the first milling move begins with its cutter in material
  removal::HeightMap machined;
};

struct SurveyOptions {
  double cell_mm = 0.1;
  double tolerance_mm = 0.1;                         ///< less depth is no collision
  const motion::SimulatedProgram* target = nullptr;  ///< which left the allowance; null: the program
};

/// Cells that cutters pass over in about a second.
inline constexpr double kQuickVisits = 5e8;
/// A cell that is at least `cell_mm` wide and with which a survey of the program visits no more cells than this.
double quick_cell_mm(const machine::Job& job, const motion::SimulatedProgram& program, const machine::Box& stock,
                     double cell_mm, double max_visits = kQuickVisits);

/// The job's blank without its allowance. Empty where a height map does not describe it: a .vdb, a mesh with undercuts.
/// Throws InputError.
std::optional<removal::HeightMap> stock_heights(const machine::Job& job, double cell_mm);

/// Empty where a height map describes neither tools nor stock: rotary motion, or as stock_heights(). Of the program's
/// path nothing is needed. Throws InputError.
std::optional<HeightSurvey> survey_heights(const machine::Job& job, const motion::SimulatedProgram& program,
                                           const SurveyOptions& options);

// Walls that are thin for their height, seen from above.

/// A wall of less than this part of its height bends under a finishing cut by more than a stiff tool does.
constexpr double kThinOfHeight = 0.2;

struct ThinWall {
  double thickness_mm = 0, height_mm = 0;
  Vec2 place_mm = Vec2::Zero();  ///< a point of it
  double slenderness() const { return height_mm / thickness_mm; }
};

/// The most slender wall along X or Y that is thinner than kThinOfHeight of its height; the height is that of the lower
/// one of its sides. Walls of less than two cells are not seen.
std::optional<ThinWall> thinnest_wall(const removal::HeightMap& map);

/// Warning [workpiece-thin] at the job's [stock] where the machined part has such a wall and the job takes the part as
/// rigid.
void suggest_workpiece(const machine::Job& job, const motion::SimulatedProgram& program,
                       const removal::HeightMap& machined, Diagnostics& diagnostics);

}  // namespace camber::checks
