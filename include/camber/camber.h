#pragma once
// The whole public interface of the Camber library.
#include "camber/adapt.h"
#include "camber/check.h"
#include "camber/compensate.h"
#include "camber/diagnostics.h"
#include "camber/feed.h"
#include "camber/fit_feed.h"
#include "camber/job.h"
#include "camber/machine.h"
#include "camber/predict.h"
#include "camber/program.h"
#include "camber/run.h"
#include "camber/time.h"
