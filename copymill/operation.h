#pragma once
// The modes of copy milling: each makes its passes from the part and what stands, and cuts them.
#include "base/triangle_mesh.h"
#include "copymill/approach.h"
#include "copymill/axis_region.h"
#include "copymill/runner.h"
#include "copymill/standing.h"
#include "copymill/tip_field.h"

namespace camber::copymill {

/// Everything that an operation works on.
struct Workplace {
  const TriangleMesh& part;
  const OperationCut& cut;
  const TipField& field;
  const AxisRegion& region;
  Standing& standing;
  Runner& runner;
  PathDepth& depth;
  double safe_z_mm = 0;
  double stock_bottom_mm = 0;
};

/// Roughing and finishing by levels, with loops or rows. Returns false where the tool's axis has no place in the region
/// at any level although material stands there.
bool cut_levels(const Workplace& place);

/// Finishing on the part's surface by rows whose scallops have the height asked for. False as above.
bool cut_scallops(const Workplace& place);

/// Drills the given holes; the part is not considered.
void drill_holes(const OperationCut& cut, Standing& standing, Runner& runner, double safe_z_mm);

}  // namespace camber::copymill
