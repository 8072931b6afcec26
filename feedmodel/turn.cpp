#include "feedmodel/turn.h"

#include "feedmodel/segment.h"

namespace camber::feedmodel {

ProgramPose pose_at(const Segment& segment, double s) {
  const Turn& turn = *segment.turn;
  return {segment.point_at(s) + turn.bend_mm * (s * s), turn.start_rad + turn.rate * s + turn.bend * (s * s)};
}

}  // namespace camber::feedmodel
