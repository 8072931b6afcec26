#pragma once
// Times and blocks of a planned program.
#include "feedmodel/plan.h"
#include "feedmodel/timed_path.h"

namespace camber::feedmodel {

FeedSummary summary_of(const nc::Interpretation& program, const MotionPlan& plan);

}  // namespace camber::feedmodel
