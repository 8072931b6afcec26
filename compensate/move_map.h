#pragma once
// Which move of the given program a move of the emitted one stands for: nc/move_map.h.
#include "nc/move_map.h"

namespace camber::compensate {

using nc::MoveMap;

}  // namespace camber::compensate
