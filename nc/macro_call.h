#pragma once
// Arguments of macro calls (G65, G66): letters into local variables.
#include <span>

#include "nc/program_text.h"
#include "nc/variables.h"

namespace camber::nc {

/// Letters to local variables: A to #1, B #2, C #3, I #4, J #5, K #6, D #7, E #8, F #9, H #11, M #13, Q #17 .. Z #26
/// (table I). I, J and K that come again, or out of their order, begin the next set of three: #7 #8 #9, #10 .. (table
/// II, up to ten sets). Where both give a variable a value the later word counts.
/// Source: Fanuc B-64484EN, custom macro, argument specification I and II.
/// Throws MacroError [macro-argument] for more than ten sets.
LocalVariables macro_arguments(std::span<const Word> words);

}  // namespace camber::nc
