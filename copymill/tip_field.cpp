#include "copymill/tip_field.h"

namespace camber::copymill {
namespace {

removal::CutterShape grown(removal::CutterShape shape, double allowance_mm) {
  shape.radius_mm += allowance_mm;
  shape.corner_radius_mm += allowance_mm;
  return shape;
}

}  // namespace

TipField::TipField(const TriangleMesh& part, const removal::CutterShape& shape, double allowance_mm)
    : drop_(part, grown(shape, allowance_mm)), allowance_mm_(allowance_mm) {}

}  // namespace camber::copymill
