#pragma once
// What is cut: the blank, the part that it becomes, and the elastic body between.
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "machine/number_range.h"
#include "machine/simulation_settings.h"

namespace camber {
struct TriangleMesh;
}

namespace camber::machine {

struct Box {
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();
};

/// Upright.
struct Cylinder {
  Vec3 base_mm = Vec3::Zero();  ///< middle of the lower face
  double diameter_mm = 0, height_mm = 0;
};

/// The part as an elastic body.
struct Workpiece {
  double youngs_modulus_MPa = 0;
  double poisson_ratio = 0.33;
  bool fixed_bottom = true;                      ///< held at the lowest level of the stock
  std::vector<Box> fixed_boxes;                  ///< held inside
  std::string fixed_mesh;                        ///< STL: held inside; empty: none
  double fixture_stiffness_N_per_mm = kNoLimit;  ///< stiffness of all that holds it, in every direction
  double cell_mm = 0;                            ///< cells of its elastic model; 0: chosen (simulate/part_survey.h)
  Diagnostic place;  ///< an error without a message where `fixed` stands, or else [workpiece]
};

/// One of box, cylinder, mesh, vdb.
struct StockDescription {
  std::optional<Box> box;
  std::optional<Cylinder> cylinder;
  std::string mesh;         ///< STL path; empty: none
  std::string vdb;          ///< stock.vdb of another job; empty: none
  double allowance_mm = 0;  ///< > 0: the blank was already cut by this program with the cutter reduced by this much
};

struct PartDescription {
  std::string mesh;                      ///< STL; empty: none
  Vec3 move_mm = Vec3::Zero();           ///< from where the mesh stands in its file to its place in the program
  std::string program;                   ///< NC program that is the target; empty: the job's own
  std::optional<Operations> operations;  ///< operations of the target program; not given: the job's operations
  std::optional<Operations> judged;      ///< moves of the target program whose surface is judged; not given: all
};

/// The mesh of the part at its place in the program. Throws InputError as read_mesh() does.
TriangleMesh part_mesh(const PartDescription& part);

}  // namespace camber::machine
