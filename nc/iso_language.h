#pragma once
// ISO G code as one of the languages (nc/language.h).
#include <memory>

#include "nc/interpreter.h"
#include "nc/program_text.h"

namespace camber::nc {

class TextRules;

Program read_iso_program(SourceText source, Diagnostics& diagnostics);
Interpretation interpret_iso(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics);
std::unique_ptr<TextRules> iso_text_rules(const Program& program);

}  // namespace camber::nc
