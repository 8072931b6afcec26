#include "nc/siemens/siemens_language.h"

#include "nc/emit/text_rules.h"
#include "nc/iso_language.h"

namespace camber::nc::siemens {

LanguageEvidence evidence(std::string_view) { return {}; }

Program read(SourceText source, Diagnostics& diagnostics) { return read_iso_program(std::move(source), diagnostics); }

Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics) {
  return interpret_iso(program, options, diagnostics);
}

std::unique_ptr<TextRules> text_rules(const Program& program) { return iso_text_rules(program); }

}  // namespace camber::nc::siemens
