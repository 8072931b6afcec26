#pragma once
// The figures of camber plan: JSON, text for a terminal, and the page.
#include <string>
#include <vector>

#include "plan/setup_plan.h"

namespace camber::report {

std::string plan_json(const plan::PlanInput& input, const plan::PlanResult& result, double compute_s);

/// The same for a terminal, within 100 columns.
std::string plan_text(const plan::PlanInput& input, const plan::PlanResult& result, double compute_s);

/// Sentences about volume that no operation machines; empty: there is none.
std::vector<std::string> plan_failures(const plan::PlanResult& result);

/// Leave-one-out errors of a case base, for a terminal.
std::string cases_error_text(const plan::CaseBase& base);

/// The page's text, UTF-8, self-contained. The same data give the same bytes. Does not throw.
std::string plan_page(const plan::PlanInput& input, const plan::PlanResult& result,
                      const std::vector<std::string>& warnings);

}  // namespace camber::report
