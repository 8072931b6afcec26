#pragma once
// The page of camber fit-feed: measured against modelled speed, residuals, parameters.
#include <string>

#include "calib/fit_feed_model.h"

namespace camber::report {

/// UTF-8, self-contained, without a script. Of each run the parts with the largest error of speed are drawn: path speed
/// over the fraction of the part's length, measured and modelled. The same result gives the same bytes.
std::string fit_feed_page(const calib::FitFeedResult& result);

/// Speed of one part. Empty where its accuracy keeps no stations.
std::string part_speed_svg(const calib::PartAccuracy& part);

}  // namespace camber::report
