#pragma once
// The verdict on a compensated program in words, the same for terminal, JSON and page.
#include <string>
#include <vector>

#include "compensate/compensate_path.h"
#include "compensate/verify_program.h"
#include "machine/compensation_settings.h"

namespace camber::report {

struct VerdictText {
  bool success = false;              ///< exit status 0
  std::string headline;              ///< "within the tolerance: ..."
  std::vector<std::string> reasons;  ///< causes of a failure: a sentence for each, worst first
};

/// The emitted program is what is judged: not to be relied on, no better than the given one, too deep in the part, or
/// over the tolerance.
VerdictText verdict_text(const compensate::CompensationResult& result, const machine::CompensationSettings& asked);

/// The same of a program that was judged again.
VerdictText verdict_text(const compensate::Verification& verification, const machine::CompensationSettings& asked);

/// "95th percentile as given 37.55 um; shifts are expected to leave 2.31 um".
std::string outlook_sentence(const compensate::Outlook& outlook);

/// Its figures, for the terminal.
std::string verify_text(const compensate::Verification& verification, double compute_s);

/// Root mean square, 95th percentile and largest value of error, deflection, contour and, where there is a mesh, the
/// error against it, before and after; of which area, and what of the surface has no figure.
std::string plain_figures_text(const compensate::CompensationResult& result);

}  // namespace camber::report
