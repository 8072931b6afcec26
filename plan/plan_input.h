#pragma once
// PLAN.toml: what there is to plan with.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "machine/machine_model.h"
#include "machine/material.h"
#include "machine/simulation_settings.h"
#include "machine/tool.h"
#include "machine/workpiece.h"
#include "plan/case_base.h"
#include "plan/faces.h"

namespace camber::plan {

enum class ToolUse : unsigned char { end_mill, ball_end_mill, face_mill, center_drill, drill, reamer };
inline constexpr std::array<std::string_view, 6> kToolUses{"end mill",     "ball end mill", "face mill",
                                                           "center drill", "drill",         "reamer"};
inline std::string_view to_string(ToolUse use) { return kToolUses[static_cast<std::size_t>(use)]; }

struct PlanTool {
  machine::Tool tool;
  ToolUse use = ToolUse::end_mill;
  std::string material = "carbide";
  bool coated = false;
};
using PlanTools = std::map<int, PlanTool>;

/// Limits for which conditions are reduced. Not given: no limit.
struct PlanLimits {
  std::optional<double> force_N{};        ///< lateral, greatest over a turn
  std::optional<double> deflection_mm{};  ///< deflection of the tip
  std::optional<double> form_error_mm{};  ///< deflection across the wall, at half the depth of cut
  std::optional<double> power_W{};        ///< besides the spindle's own
};

/// How the part lies on the machine.
struct PartSetup {
  std::string name{};
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< from the files' frame
};

struct PlanInput {
  std::string path, part_path, machine_path;
  machine::StockDescription blank;
  std::vector<std::string> fixture_paths;
  double mm_per_unit = 1;  ///< unit of the meshes and of the blank's box
  machine::Machine machine;
  machine::Material material;
  PlanTools tools;
  CaseBase cases;
  std::string work_material;  ///< as the case base names it
  bool fine = false;          ///< finishing operations after roughing
  bool fast = false;
  double allowance_mm = 0.3;  ///< that roughing leaves where finishing follows
  double scallop_mm = 0.01;   ///< scallop height of free-form faces
  bool coolant = false;       ///< M8 and M9 in the programs
  bool compensate = false;    ///< finishing operations are moved against their predicted form error
  double tool_change_s = 0;
  PlanLimits limits;
  machine::Simulation simulation;
  FaceOptions faces;
  std::vector<PartSetup> setups;  ///< one at least
};

/// True for *.vdb: a part that is what a program leaves.
bool is_stock_file(const std::string& path);

/// Reads the plan, its machine and its case base. Throws InputError with file:line:column.
PlanInput read_plan_input(const std::string& path, Diagnostics& diagnostics);

}  // namespace camber::plan
