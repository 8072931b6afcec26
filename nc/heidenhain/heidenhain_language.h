#pragma once
// Heidenhain Klartext as one of the languages (nc/language.h).
#include <memory>
#include <string_view>

#include "nc/language.h"

namespace camber::nc::heidenhain {

LanguageEvidence evidence(std::string_view text);
Program read(SourceText source, Diagnostics& diagnostics);
Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics);
std::unique_ptr<TextRules> text_rules(const Program& program);
std::unique_ptr<ProgramWriter> writer(const Dialect& dialect, WriterFormat format);
std::unique_ptr<FiveAxisText> five_axis_text(const Program& program, const Dialect& dialect);

}  // namespace camber::nc::heidenhain
