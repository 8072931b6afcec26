#include "checks/travel.h"
#include "plausibility/rules.h"

namespace camber::plausibility {

void look_at_travel(const Evidence& e, Diagnostics& diagnostics) {
  checks::check_travel(e.job, e.program, diagnostics);
}

}  // namespace camber::plausibility
