#pragma once
// How near the cutters of a path come to the part: quick, from places along the path.
#include <cstdint>
#include <optional>
#include <vector>

#include "machine/job_file.h"
#include "removal/form_error.h"
#include "simulate/predict.h"

namespace camber::plausibility {

/// A cutter as spheres within it that touch its envelope where parts touch it: corner, bottom, wall.
struct CutterSpheres {
  explicit CutterSpheres(const machine::Tool& tool);
  struct Sphere {
    Vec3 centre_mm;  ///< in the tool's frame
    double radius_mm;
  };
  std::vector<Sphere> spheres;
  Vec3 middle_mm = Vec3::Zero();  ///< centre of a ball around all of them
  double reach_mm = 0;
};

/// Signed distance between a cutter and the part, negative where the cutter is in the part.
double clearance_mm(const removal::PartMesh& part, const CutterSpheres& cutter, const ToolPose& pose,
                    const Vec3& part_shift_mm = Vec3::Zero());

struct PartFit {
  struct Place {
    std::uint32_t move = 0;
    ToolPose pose;
    int tool = 0;
    double clearance_mm = 0;
  };
  std::vector<Place> places;       ///< evenly along the milling moves
  double gouge_mm = 0;             ///< deepest, positive
  std::uint32_t gouge_move = 0;    ///< where
  double gouging = 0;              ///< fraction of the places that cut into the part by more than kGouge_mm
  double cutting_in = 0;           ///< by more than kCutIn_mm
  double nearest_mm = 0;           ///< clearance that a hundredth of the places stays below
  std::optional<Vec3> shift_mm{};  ///< shift of the part with which path and part fit; where they do not fit without
};

/// A path may cut into the mesh by as much: chords, stock to leave below zero, rounding.
inline constexpr double kGouge_mm = 0.15;
/// Fraction of the places.
inline constexpr double kGouging = 0.02;

/// Less than a gouge, and too much for a path that only a shift makes fit.
inline constexpr double kCutIn_mm = 0.04;
inline constexpr double kCuttingIn = 0.05;

/// Milling moves of the program against the part's mesh.
PartFit fit_part(const machine::Job& job, const simulate::SimulatedProgram& program, const removal::PartMesh& part);

}  // namespace camber::plausibility
