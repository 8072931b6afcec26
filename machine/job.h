#pragma once
// A job: which program on which machine, with which tools, into which stock. Read from job.toml.
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "machine/machine.h"
#include "machine/material.h"

namespace camber::machine {

enum class ToolType { ball, flat, bull, drill };

struct Tool {
  int number = 0;
  ToolType type = ToolType::ball;
  double diameter_mm = 0;
  double corner_radius_mm = 0;  ///< bull only
  int flutes = 2;
  double helix_rad = 0;
  double overhang_mm = 0;                    ///< holder face to tip
  std::optional<double> flute_length_mm;     ///< not given: the whole overhang is fluted
  double shank_diameter_mm = 0;              ///< 0: as the cutter
  double effective_diameter_ratio = 0.8;     ///< bending diameter of the fluted part / diameter
  double youngs_modulus_MPa = 600000;
  double root_stiffness_N_per_mm = kNoLimit; ///< lateral, holder and spindle
};

struct Box {
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();
};

struct Stock {
  std::optional<Box> box;
  std::string mesh;          ///< STL path; empty: the box
  double allowance_mm = 0;   ///< > 0: the blank was already cut by this program with the cutter shrunk by this much
};

struct Part {
  std::string mesh;     ///< STL; empty: none
  std::string program;  ///< NC program that is the target; empty: the job's own
};

/// Which moves are simulated and compensated; nothing given: all.
struct Operations {
  std::vector<int> tools;
  std::vector<std::array<int, 2>> blocks;  ///< 1-based line ranges, both ends included
};

enum class Coupling { rigid, static_ };

struct Simulation {
  double voxel_mm = 0.1;
  Coupling coupling = Coupling::static_;
  double rotation_step_rad = kPi / 180.0;
  double envelope_step_mm = 0;  ///< of the samples along the profile; 0: the voxel
};

struct Compensation {
  double tolerance_um = 1.0;
  double max_shift_mm = 0.1;
  int max_rounds = 8;
};

struct Job {
  std::string path;
  std::string program;  ///< paths are resolved against the job's folder
  std::string machine_path;
  Machine machine;
  std::optional<bool> inch;   ///< unit of a program without G20/G21: `units = "inch"` or "mm"
  Operations operations;
  std::map<int, Tool> tools;
  Material material;
  Stock stock;
  Part part;
  Simulation simulation;
  Compensation compensation;
};

/// Reads the job and its machine file. Throws InputError with file:line:column.
Job read_job(const std::string& path, Diagnostics& diagnostics);

/// job.toml text with every default filled in; paths as they were resolved.
std::string to_toml(const Job& job);

}  // namespace camber::machine
