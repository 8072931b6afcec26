#pragma once
// Why something is not read, in words that a machinist understands.
#include <string>

#include "base/diagnostics.h"

namespace camber::nc {

/// Sentence for a G code (ten times its number) that is not read.
std::string why_g_is_refused(int tenths);

/// Throws InputError [dialect] with one error where the text is plainly of another language: Siemens 840D
/// (CYCLE..., DEF, MSG, assignments) or Heidenhain (BEGIN PGM).
void refuse_other_languages(const SourceText& source);

}  // namespace camber::nc
