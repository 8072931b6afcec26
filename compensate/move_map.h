#pragma once
// Maps moves of the emitted program to those of the given one (nc/move_map.h).
#include "nc/move_map.h"

namespace camber::compensate {

using nc::MoveMap;

}  // namespace camber::compensate
