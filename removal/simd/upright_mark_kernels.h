#pragma once
// Marks of deflected rounded cylinders on the surface (removal/form_error/deflected_envelope.h), in vectors as wide as
// the processor has them. Every lane does the same operations in the same order whatever the width, so results do not
// depend on it.
#include <cstdint>

#include "removal/simd/upright_kernels.h"

namespace camber::removal::upright {

/// Surface points, each beside one deflected stamp.
struct MarkLanes {
  static constexpr int kLanes = 8;
  int count;               ///< a multiple of kLanes
  const float *x, *y, *z;  ///< place of the point from the stamp's tip, mm
  const float *nx, *ny, *nz;
  const float* highest;            ///< mm
  const float* largest;            ///< largest of the stamp's deflections, mm
  const std::int32_t* deflection;  ///< first of the stamp's row, counted in deflections (pairs of values)
  float* height;                   ///< out, mm
};

/// The deflected cutter; `rows.now` is the first row.
struct MarkTool {
  DeflectionRow rows;
  float flat, corner;
  float lag_per_mm, steps_per_rad;
};

/// Undeflected cutters side by side: whole vectors of MarkLanes::kLanes, the last filled up with reach_mm < 0.
struct CutterLanes {
  int count;
  const float *x, *y, *z;  ///< places of the tips from a common origin, mm
  const float* reach;      ///< how near a place must be to count, mm
  float flat, corner;
  bool lateral;  ///< reach is due to deflections across the axis, and to rounding
};

/// Cutters near a place.
struct NearCutters {
  int nearest;           ///< negative: none is within its reach
  int count;             ///< within their reach
  std::int32_t* within;  ///< room for all
};

struct MarkKernels {
  /// Finds the cutters within whose reach a place lies, and the nearest of all.
  void (*find_near)(const CutterLanes& cutters, float x, float y, float z, NearCutters& out);
  /// Keeps those of near.within that another place is within the reach of, and finds the nearest of them. Under a flat
  /// bottom a lateral deflection changes nothing: there a place must lie inside the cutter. The list has room up to a
  /// multiple of MarkLanes::kLanes.
  void (*keep_near)(const CutterLanes& cutters, float x, float y, float z, NearCutters& near);
  /// DeflectedEnvelope::height_mm of each.
  void (*heights)(const MarkLanes& marks, const MarkTool& tool);
};

/// Those of the widest vectors that this processor has.
const MarkKernels& mark_kernels();
extern const MarkKernels kBaseMarkKernels;  ///< on every processor
#if defined(__x86_64__)
extern const MarkKernels kAvx2MarkKernels;
#endif

}  // namespace camber::removal::upright
