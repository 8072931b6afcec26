#pragma once
// From the results of a run to what the page and the exports show.
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "compensate/compensate.h"
#include "deflection/predict.h"
#include "report/form_error.h"
#include "report/html_report.h"

namespace camber::report {

std::vector<FormErrorPoint> form_error_points(const deflection::MachinedProgram& program,
                                              const deflection::Prediction& prediction);

/// Commanded and actual feed about every `period_s`.
class FeedCollector {
 public:
  explicit FeedCollector(double period_s = 0.01) : period_s_(period_s) {}
  void add(std::span<const feedmodel::TimedSample> samples);
  std::vector<FeedSample> take() { return std::move(samples_); }

 private:
  double period_s_, next_s_ = 0;
  std::vector<FeedSample> samples_;
};

ReportData predict_report(const std::string& title, const deflection::MachinedProgram& program,
                          const deflection::Prediction& prediction, std::vector<FeedSample> feed,
                          const Diagnostics& diagnostics);
ReportData compensate_report(const std::string& title, const compensate::Compensation& result,
                             std::vector<FeedSample> feed_before, std::vector<FeedSample> feed_after,
                             const Diagnostics& diagnostics);

}  // namespace camber::report
