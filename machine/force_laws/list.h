#pragma once
// The force laws. A new one is a header beside this one and an entry here.
#include "machine/force_laws/kienzle.h"
#include "machine/force_laws/linear.h"

namespace camber::machine {

/// The first is the one that [material] and [force_log] have by default.
using ForceLaws = LawList<LinearLaw, KienzleLaw>;

/// A place in ForceLaws. Code that names a law has its enumerator here; a law needs none.
enum class ForceLaw : unsigned char {
  linear = ForceLaws::index<LinearLaw>,
  kienzle = ForceLaws::index<KienzleLaw>,
};

}  // namespace camber::machine
