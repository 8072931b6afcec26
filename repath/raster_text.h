#pragma once
// A raster as an NC program.
#include <span>
#include <string>
#include <vector>

#include "machine/tool.h"
#include "nc/dialect.h"

namespace camber::repath {

struct RasterProgram {
  nc::Dialect dialect = nc::default_dialect();
  machine::Tool tool{};
  double spindle_rpm = 0, feed_mm_per_min = 0;
  double clearance_mm = 0;     ///< Z of moves from chain to chain
  double lead_in_mm = 0;       ///< feed begins so far above a chain's first point ...
  double lead_in_from_mm = 0;  ///< ... or at this Z, whichever is higher; never above the clearance plane
  int decimals = 3;
};

/// The whole program: header, tool change, length offset, spindle; each chain (of two points at least) led in straight
/// down at a third of the feed and left straight up in rapid; M30. It has an O number if the
/// dialect has program numbers.
std::string raster_text(const RasterProgram& program, std::span<const std::vector<Vec3>> chains);

}  // namespace camber::repath
