// Subprograms: M97 M98 M99, G65 G66 G67, and LinuxCNC's subs.
#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "nc/sequencer.h"

namespace camber::nc {
namespace {

/// Local variable of a letter, A to Z; 0: no argument.
constexpr int kVariable[26] = {1, 2, 3, 7,  8,  9,  0,  11, 4,  5,  6,  0,  13,
                               0, 0, 0, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26};

/// Letters to local variables: A to #1, B #2, C #3, I #4, J #5, K #6, D #7, E #8, F #9, H #11, M #13, Q #17 .. Z #26
/// (table I). I, J and K that come again, or out of their order, begin the next set of three: #7 #8 #9, #10 .. (table
/// II, up to ten sets). Where both give a variable a value the later word counts.
/// Source: Fanuc B-64484EN, custom macro, argument specification I and II.
/// Throws MacroError [macro-argument] for more than ten sets.
LocalVariables macro_arguments(std::span<const Word> words) {
  LocalVariables out;
  int set = 0, last = -1;
  for (const Word& w : words) {
    int variable = kVariable[w.letter - 'A'];
    if (variable == 0) continue;
    if (w.letter >= 'I' && w.letter <= 'K') {
      const int place = w.letter - 'I';
      if (place <= last) ++set;
      last = place;
      variable += 3 * set;
      if (set > 9) throw MacroError(w.offset, "macro-argument", "more than ten sets of I, J and K");
    }
    out.numbered[static_cast<std::size_t>(variable)] = w.value;
  }
  return out;
}

}  // namespace

// --- subs of O-words ----------------------------------------------------------------------------------------------

void Sequencer::call_sub(const Statement& s) {
  std::size_t first = 0;
  std::string label;
  if (s.label == Statement::kNoLabel)
    label = fmt::format("{}", std::round(value_of(s, first++).value_or(0)));
  else
    label = at_.file->macro.labels[s.label];
  const auto sub = files_.find_sub(*at_.file, label);
  if (!sub)
    throw MacroError(s.offset, "subprogram",
                     fmt::format("there is no O{0} SUB in the program, and no file {0}.ngc with one beside it", label));
  LocalVariables locals;
  for (std::size_t i = first; i < s.value_count; ++i) locals.numbered[i - first + 1] = value_of(s, i);
  advance();
  enter({{sub->file, sub->block + 1}, 1, std::move(locals), s.offset}, true);
}

void Sequencer::return_from_sub(const Statement& s) {
  if (frames_.empty() || !frames_.back().o_word)
    throw MacroError(s.offset, "statement", "a RETURN or ENDSUB in no sub that was called");
  const Value result = s.value_count > 0 ? value_of(s, 0) : Value();
  system_.set_result(result);
  leave_frame();
}

// --- calls --------------------------------------------------------------------------------------------------------

void Sequencer::enter(Call call, bool o_word) {
  if (call.times == 0) return;
  if (frames_.size() >= static_cast<std::size_t>(dialect_.max_levels))
    throw MacroError(call.offset, "call-depth",
                     fmt::format("calls nested deeper than {} levels; a {} control reads no more", dialect_.max_levels,
                                 dialect_.name));
  const BlockPlace caller{at_.file, at_.block == 0 || at_.part > 0 ? at_.block : at_.block - 1};
  const std::uint32_t from = caller.file == &files_.main() ? caller.block : frames_.back().called_from;
  if (call.locals) {
    variables_.enter_level(*call.locals);
    modal_calls_.emplace_back();
  }
  if (call.times > 1) note_entry(call.offset);
  const BlockPlace start = call.start;
  frames_.push_back({std::move(call), at_, caller, from, o_word, {}});
  system_.set_call_level(frames_.size());
  go(start);
}

void Sequencer::leave_frame() {
  const BlockPlace back = frames_.back().return_to;
  if (frames_.back().call.locals) {
    variables_.leave_level();
    modal_calls_.pop_back();
  }
  frames_.pop_back();
  system_.set_call_level(frames_.size());
  go(back);
}

/// True where a program comes upon the O number of the next one in its file.
bool Sequencer::runs_into_next_program() {
  if (!program_number(*at_.file, at_.block)) return false;
  if (frames_.empty())
    return at_.file->macro.calls && (at_.block != files_.program_starts(*at_.file).front() || (*runs_)[at_.block] > 0);
  return at_.block != frames_.back().call.start.block || at_.file != frames_.back().call.start.file;
}

void Sequencer::end_of_program_text() {
  const std::size_t block = std::min<std::size_t>(at_.block, at_.file->blocks.size() - 1);
  const std::size_t offset = at_.file->blocks[block].offset;
  if (frames_.empty()) {
    if (at_.block < at_.file->blocks.size())
      report_.warning(offset, "program-end", "the program runs into the next one; it is assumed to end here (M30)");
    running_ = false;
    return;
  }
  report_.warning(offset, "program-end", "the subprogram has no end; M99 was expected before");
  return_from_program({}, {});
}

void Sequencer::run_words_and_calls() {
  const auto is_macro_call = [](const Word& w) {
    return w.letter == 'G' && (w.value == 65 || w.value == 66 || w.value == 67);
  };
  const auto macro = std::find_if(words_.begin(), words_.end(), is_macro_call);
  if (macro != words_.end()) return call_macro(static_cast<std::size_t>(macro - words_.begin()), words_);
  take_calls(words_);
}

/// M97, M98 and M99 act behind the rest of their block.
void Sequencer::take_calls(std::vector<Word>& words) {
  const auto is_call = [](const Word& w) { return w.letter == 'M' && (w.value >= 97 && w.value <= 99); };
  const auto found = std::find_if(words.begin(), words.end(), is_call);
  if (found == words.end()) return run_words(words);
  const Word code = *found;
  std::vector<Word> own, rest;
  for (const Word& w : words) {
    if (is_call(w)) continue;
    (w.letter == 'P' || w.letter == 'L' ? own : rest).push_back(w);
  }
  const BlockPlace here = at_;
  const std::size_t frames = frames_.size();
  const bool only_number =
      std::all_of(rest.begin(), rest.end(), [](const Word& w) { return w.letter == 'N' || w.letter == 'O'; });
  if (only_number)
    advance();
  else
    run_words(rest);
  if (!running_) return;
  if (frames_.size() != frames)
    throw MacroError(
        code.offset, "subprogram",
        fmt::format("a move and M{} in one block while G66 is active; two blocks were expected", code.value));
  if (code.value == 99) {
    at_ = here;
    return_from_program(code, own);
  } else {
    call_program(code, own);
  }
}

namespace {

const Word* word_with(std::span<const Word> words, char letter) {
  for (const Word& w : words)
    if (w.letter == letter) return &w;
  return nullptr;
}

std::size_t times_of(std::span<const Word> words) {
  const Word* l = word_with(words, 'L');
  if (!l) return 1;
  if (l->value < 0 || l->value > 1e9)
    throw MacroError(l->offset, "subprogram", fmt::format("{} runs (L) of a subprogram", l->value));
  return static_cast<std::size_t>(std::round(l->value));
}

std::uint32_t number_of(const Word& code, const Word* p) {
  if (!p)
    throw MacroError(code.offset, "subprogram",
                     fmt::format("{}{} without a number; P with the number of the subprogram was expected", code.letter,
                                 code.value));
  if (p->value < 0 || p->value > 99999999)
    throw MacroError(p->offset, "subprogram", fmt::format("P{} is not the number of a subprogram", p->value));
  return static_cast<std::uint32_t>(std::round(p->value));
}

}  // namespace

/// Behind the block: at_ is the next one.
void Sequencer::call_program(const Word& code, std::span<const Word> words) {
  const Word* p = word_with(words, 'P');
  std::uint32_t number = number_of(code, p);
  Call call;
  call.times = times_of(words);
  call.offset = code.offset;
  if (code.value == 97) {
    const auto block = files_.find_block({at_.file, at_.block - 1}, number);
    if (!block)
      throw MacroError(p->offset, "block-number", fmt::format("there is no block N{} in this program to call", number));
    call.start = {at_.file, *block};
    return enter(std::move(call));
  }
  auto place = files_.find_program(*at_.file, number);
  if (!place && dialect_.m98_count_in_p && number > 9999 && !word_with(words, 'L')) {
    call.times = number / 10000;
    number %= 10000;
    place = files_.find_program(*at_.file, number);
  }
  if (!place)
    throw MacroError(
        p->offset, "subprogram",
        fmt::format("there is no program O{:04} in this file, and no file of that name beside it", number));
  call.start = *place;
  enter(std::move(call));
}

void Sequencer::call_macro(std::size_t at, std::vector<Word>& words) {
  const Word code = words[at];
  const std::vector<Word> arguments(words.begin() + static_cast<std::ptrdiff_t>(at) + 1, words.end());
  words.resize(at);
  const bool only_number = std::all_of(words.begin(), words.end(), [](const Word& w) { return w.letter == 'N'; });
  if (code.value == 67) {
    modal_calls_.back().reset();
    words.insert(words.end(), arguments.begin(), arguments.end());
    return take_calls(words);
  }
  if (only_number)
    advance();
  else
    run_words(words);
  if (!running_) return;
  const Word* p = word_with(arguments, 'P');
  const std::uint32_t number = number_of(code, p);
  const auto place = files_.find_program(*at_.file, number);
  if (!place)
    throw MacroError(
        p->offset, "subprogram",
        fmt::format("there is no program O{:04} in this file, and no file of that name beside it", number));
  Call call{*place, times_of(arguments), macro_arguments(arguments), code.offset};
  if (code.value == 66)
    modal_calls_.back() = std::move(call);
  else
    enter(std::move(call));
}

/// at_ is the block of the M99; `code` without a letter: there is none, the text ends.
void Sequencer::return_from_program(const Word& code, std::span<const Word> words) {
  const Word* p = word_with(words, 'P');
  if (frames_.empty()) {
    if (p) return jump_to_number(p->value, code.offset, at_);
    report_.warning(code.offset, "endless-program",
                    "M99 in the main program starts it again without end; it is read once");
    running_ = false;
    return;
  }
  if (p) {
    const BlockPlace caller = frames_.back().caller;
    const auto block = files_.find_block(caller, std::round(p->value));
    if (!block)
      throw MacroError(p->offset, "block-number",
                       fmt::format("there is no block N{} to return to in the program that called", p->value));
    if (*block <= caller.block) note_jump(code.offset);
    leave_frame();
    go({caller.file, *block});
    return;
  }
  Frame& frame = frames_.back();
  if (frame.call.times <= 1) return leave_frame();
  --frame.call.times;
  if (frame.call.locals) {
    variables_.leave_level();
    variables_.enter_level(*frame.call.locals);
  }
  go(frame.call.start);
}

}  // namespace camber::nc
