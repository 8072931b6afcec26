#include "checks/rules.h"
#include "simulate/travel.h"

namespace camber::checks {

void look_at_travel(const Evidence& e, Diagnostics& diagnostics) {
  simulate::check_travel(e.job, e.program, diagnostics);
}

}  // namespace camber::checks
