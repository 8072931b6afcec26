#include "nc/sequencer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/cancel.h"

namespace camber::nc {
namespace {

bool is_motion(const Move& m) { return m.kind != MoveKind::dwell; }

/// Words whose expressions leave the place of a move as the text says it.
bool leaves_place(char letter) { return std::string_view("NOMTSHD").find(letter) != std::string_view::npos; }

bool is_axis(char letter) { return std::string_view("XYZUVWIJKRQABC").find(letter) != std::string_view::npos; }

}  // namespace

Sequencer::Sequencer(ProgramFiles& files, const InterpreterOptions& options, Reporter& report, Interpretation& out)
    : files_(files),
      options_(options),
      dialect_(options.dialect_or_default()),
      report_(report),
      out_(out),
      interpreter_(files.main(), options, report, out),
      system_(dialect_, interpreter_, report, out),
      variables_(dialect_, system_),
      at_{&files.main(), 0} {}

void Sequencer::run() {
  out_.moves.reserve(at_.file->blocks.size());
  if (divides_lines(*at_.file) && !options_.dialect)
    report_.warning(at_.file->parts.front().offset - 1, "block-end",
                    "the words behind `;` are read as a further block, as a Fanuc or a Haas control does; --dialect "
                    "linuxcnc reads a comment");
  if (dialect_.strict) refuse_what_is_read_elsewhere();
  if (at_.file->macro.flow() || divides_lines(*at_.file))
    run_blocks();
  else
    run_plain();
  if (!failed_ && !report_.has_errors()) warn_of_blocks_behind_the_end();
  report_.set_source(files_.main().source);
  interpreter_.finish();
}

void Sequencer::run_plain() {
  const Program& program = *at_.file;
  const std::size_t blocks = program.blocks.size();
  for (; at_.block < blocks && !report_.full(); ++at_.block) {
    cancellation_point();
    if (program.blocks[at_.block].word_count == 0 || is_skipped(program.blocks[at_.block])) continue;
    if (!interpreter_.run(at_.block)) return;
  }
}

void Sequencer::run_blocks() {
  go(at_);
  while (running_ && !report_.full()) {
    cancellation_point();
    try {
      step();
    } catch (const MacroError& e) {
      report_.error(e.offset, e.check, e.what());
      running_ = false;
      failed_ = true;
    }
  }
  mark_repeated_moves();
}

bool Sequencer::is_skipped(const Block& block) const {
  if (block.skip == 0) return false;
  return options_.skip_slash_blocks || (options_.skip_switches >> block.skip & 1) != 0;
}

std::uint32_t Sequencer::called_from() const {
  return at_.file == &files_.main() ? at_.block : frames_.back().called_from;
}

void Sequencer::go(BlockPlace place) {
  const bool same = runs_ != nullptr && place.file == at_.file;
  at_ = place;
  if (same) return;
  report_.set_source(at_.file->source);
  if (at_.file->macro.broken) failed_ = true, running_ = false;
  runs_ = &files_.runs(*at_.file);
}

void Sequencer::count_run() {
  std::uint8_t& runs = (*runs_)[at_.block];
  if (runs > 0 && ++repeated_ > options_.max_repeated_blocks) fail_as_endless();
  if (runs < 255) ++runs;
}

void Sequencer::step() {
  if (at_.block >= at_.file->blocks.size()) return end_of_program_text();
  const Block& block = at_.file->blocks[at_.block];
  if (is_skipped(block)) {
    at_ = {at_.file, at_.block + 1};
    return;
  }
  const auto words = words_here();
  if (words.empty() && !block.flow) return advance();
  if (runs_into_next_program()) return end_of_program_text();
  if (at_.part == 0) count_run();
  if (block.flow) return run_flow_block(block);
  editable_ = !is_divided(block);
  run_words(words);
}

/// Constructs that a strict control refuses and others read.
void Sequencer::refuse_what_is_read_elsewhere() {
  const Program& file = *at_.file;
  if (file.nested_comment != Program::kNowhere)
    report_.error(
        file.nested_comment, "comment-nested",
        fmt::format("a comment in a comment; a {} control refuses it, `)` was expected first", dialect_.title));
  if (const auto at = file.macro.expressions.abbreviation)
    report_.error(*at, "expression",
                  fmt::format("an abbreviated word; a {} control knows it by its full name only", dialect_.title));
}

// --- lines of several blocks

bool Sequencer::divides_lines(const Program& file) const {
  return !file.parts.empty() && dialect_.semicolon_ends_block;
}

bool Sequencer::is_divided(const Block& block) const { return block.divided && dialect_.semicolon_ends_block; }

/// Returns the parts of a divided block behind the first `;`.
std::span<const BlockPart> Sequencer::parts_of(std::uint32_t block) const {
  const auto& parts = at_.file->parts;
  const auto first = std::ranges::lower_bound(parts, block, {}, &BlockPart::block);
  const auto end = std::ranges::upper_bound(parts, block, {}, &BlockPart::block);
  return {first, end};
}

std::span<const Word> Sequencer::words_here() const {
  if (at_.part == 0) return at_.file->words_of(at_.block);
  const BlockPart& part = parts_of(at_.block)[at_.part - 1];
  return {at_.file->words.data() + part.first_word, part.word_count};
}

/// Advances to the next block, which may be in the same line.
void Sequencer::advance() {
  const Block& block = at_.file->blocks[at_.block];
  if (is_divided(block) && at_.part < parts_of(at_.block).size()) {
    ++at_.part;
  } else {
    ++at_.block;
    at_.part = 0;
  }
}

/// The part of a line that an offset lies in.
std::uint32_t Sequencer::part_of(std::uint32_t block, std::uint32_t offset) const {
  if (!at_.file->blocks[block].divided) return 0;
  const auto parts = parts_of(block);
  const auto behind = std::ranges::upper_bound(parts, offset, {}, &BlockPart::offset);
  return static_cast<std::uint32_t>(behind - parts.begin());
}

/// The next block behind a statement.
BlockPlace Sequencer::behind(const Statement& s) {
  const BlockPlace here = at_;
  at_ = {at_.file, s.block, part_of(s.block, s.offset)};
  advance();
  return std::exchange(at_, here);
}

/// Runs plain words of the block and goes on to the next block, or to the macro that G66 has called behind each move.
void Sequencer::run_words(std::span<const Word> words) {
  const std::size_t before = out_.moves.size();
  const bool in_main = at_.file == &files_.main();
  const bool go_on = interpreter_.run({*at_.file, at_.block, words, called_from(), editable_ && in_main});
  const std::size_t made = out_.moves.size() - before;
  if ((*runs_)[at_.block] > 1) repeated_ += made;
  advance();
  running_ = go_on;
  const auto& modal = modal_calls_.back();
  if (!go_on || !modal || made == 0 || !is_motion(out_.moves.back())) return;
  enter(*modal);
}

// --- flow control -------------------------------------------------------------------------------------------------

Value Sequencer::value_of(const Statement& s, std::size_t which, double round_step) {
  const MacroTables& macro = at_.file->macro;
  return evaluate(macro.expressions, macro.values[s.first_value + which], variables_, dialect_, round_step);
}

bool Sequencer::holds(const Statement& s) { return value_of(s, 0).value_or(0) != 0; }

void Sequencer::run_flow_block(const Block&) {
  system_.tick();
  system_.set_block(*at_.file, at_.block);
  const auto& statements = at_.file->macro.statements;
  const auto first = std::lower_bound(statements.begin(), statements.end(), at_.block,
                                      [](const Statement& s, std::uint32_t block) { return s.block < block; });
  const auto here = [&](const Statement& s) { return part_of(at_.block, s.offset) == at_.part; };
  auto begin = first;
  while (begin != statements.end() && begin->block == at_.block && !here(*begin)) ++begin;
  auto end = begin;
  while (end != statements.end() && end->block == at_.block && here(*end)) ++end;
  if (run_statements(static_cast<std::size_t>(begin - statements.begin()),
                     static_cast<std::size_t>(end - statements.begin())))
    run_words_and_calls();
}

/// Returns true when the words of the block are to be run as well. All values of a block are worked out before the
/// first variable is set.
bool Sequencer::run_statements(std::size_t first, std::size_t end) {
  const auto& statements = at_.file->macro.statements;
  for (std::size_t i = first; i < end && statements[i].kind == StatementKind::condition; ++i) {
    if (holds(statements[i])) continue;
    advance();
    return false;
  }
  evaluate_words();
  struct Setting {
    const Statement* statement;
    double number;
    Value value;
  };
  std::vector<Setting> settings;
  const Statement* jump = nullptr;
  for (std::size_t i = first; i < end; ++i) {
    const Statement& s = statements[i];
    if (s.kind == StatementKind::assign_number)
      settings.push_back({&s, value_of(s, 0).value_or(0), value_of(s, 1)});
    else if (s.kind == StatementKind::assign_name)
      settings.push_back({&s, 0, value_of(s, 0)});
    else if (s.kind == StatementKind::go_to)
      jump = &s;
    else if (s.kind != StatementKind::condition)
      return run_flow_statement(static_cast<std::uint32_t>(i)), false;
  }
  for (const Setting& s : settings) {
    if (s.statement->kind == StatementKind::assign_number)
      variables_.set(s.number, s.value, s.statement->offset);
    else
      variables_.set(at_.file->macro.expressions.names[s.statement->label], s.value, s.statement->offset);
  }
  if (!jump) return true;
  jump_to_number(value_of(*jump, 0).value_or(0), jump->offset, at_);
  return false;
}

void Sequencer::run_flow_statement(std::uint32_t index) {
  const Statement& s = statement(index);
  switch (s.kind) {
    case StatementKind::branch_if:
    case StatementKind::branch_elseif:
    case StatementKind::branch_else:
      return run_branch(index);
    case StatementKind::loop:
      return run_loop(index);
    case StatementKind::loop_end:
    case StatementKind::loop_until:
    case StatementKind::next_turn:
      return next_turn(s.partner);
    case StatementKind::leave_loop:
      return leave_loop(s.partner);
    case StatementKind::sub:
      at_ = behind(statement(s.partner));
      return;
    case StatementKind::call:
      return call_sub(s);
    case StatementKind::sub_end:
    case StatementKind::sub_return:
      return return_from_sub(s);
    default:
      advance();
  }
}

/// if asks one condition after the other; elseif and else that are come upon from above end the branch before them.
void Sequencer::run_branch(std::uint32_t index) {
  if (statement(index).kind != StatementKind::branch_if) {
    at_ = behind(statement(statement(index).partner));
    return;
  }
  for (std::uint32_t i = index;; i = statement(i).next_branch) {
    const Statement& s = statement(i);
    const bool asks = s.kind == StatementKind::branch_if || s.kind == StatementKind::branch_elseif;
    if (asks && !holds(s)) continue;
    at_ = behind(s);
    return;
  }
}

void Sequencer::leave_loop(std::uint32_t head) {
  const Statement& s = statement(head);
  entered_.erase({at_.file, s.offset});
  at_ = behind(statement(s.partner));
}

void Sequencer::run_loop(std::uint32_t index) {
  const Statement& s = statement(index);
  note_entry(s.offset);
  if (s.repeats) {
    const double times = std::round(value_of(s, 0).value_or(0));
    turns_left()[index] = times;
    if (times < 1) return leave_loop(index);
  } else if (s.value_count > 0 && !holds(s)) {
    return leave_loop(index);
  }
  advance();
}

/// Handles the end of a loop, and continue.
void Sequencer::next_turn(std::uint32_t head) {
  const Statement& s = statement(head);
  const Statement& last = statement(s.partner);
  if (++repeated_ > options_.max_repeated_blocks) fail_as_endless();
  bool again = true;
  if (s.repeats)
    again = --turns_left()[head] >= 1;
  else if (last.kind == StatementKind::loop_until)
    again = holds(last);
  else if (s.value_count > 0)
    again = holds(s);
  if (!again) return leave_loop(head);
  at_ = behind(s);
}

void Sequencer::jump_to_number(double number, std::uint32_t offset, BlockPlace from) {
  const auto block = files_.find_block(from, std::round(number));
  if (!block)
    throw MacroError(offset, "block-number",
                     fmt::format("there is no block N{} in this program to go to", std::round(number)));
  if (*block <= from.block && from.file == at_.file) note_jump(offset);
  go({from.file, *block});
}

void Sequencer::note_jump(std::uint32_t offset) { entered_.try_emplace({at_.file, offset}, repeated_); }

/// The loop that has run for most of the time: of those, the one entered last.
void Sequencer::fail_as_endless() {
  const LoopKey* loop = nullptr;
  std::size_t entered = 0;
  for (const auto& [key, when] : entered_)
    if (repeated_ - when > options_.max_repeated_blocks / 2 && (!loop || when >= entered)) {
      loop = &key;
      entered = when;
    }
  if (loop) report_.set_source(loop->first->source);
  throw MacroError(loop ? loop->second : at_.file->blocks[at_.block].offset, "endless-loop",
                   fmt::format("the loop does not end: {} blocks were run again; the rest is not read",
                               options_.max_repeated_blocks));
}

// --- words ----------------------------------------------------------------------------------------------------------

/// The words of the block with numbers for values; those of vacant variables are left out.
bool Sequencer::evaluate_words() {
  const Program& file = *at_.file;
  editable_ = !is_divided(file.blocks[at_.block]);
  words_.clear();
  const auto here = words_here();
  const auto first_word = static_cast<std::uint32_t>(here.data() - file.words.data());
  auto expression = std::lower_bound(file.macro.words.begin(), file.macro.words.end(), first_word,
                                     [](const ExpressionWord& w, std::uint32_t word) { return w.word < word; });
  const bool inch = interpreter_.facts().state->inch;
  for (std::uint32_t i = first_word; i < first_word + here.size(); ++i) {
    Word word = file.words[i];
    if (expression != file.macro.words.end() && expression->word == i) {
      double step = 1;
      if (dialect_.round_to_increment && is_axis(word.letter))
        step = inch ? dialect_.least_increment_inch : dialect_.least_increment_mm;
      const Value value = evaluate(file.macro.expressions, (expression++)->expression, variables_, dialect_, step);
      editable_ = editable_ && leaves_place(word.letter);
      if (!value) continue;
      if (std::abs(*value) > 1e12)
        throw MacroError(word.offset, "expression", fmt::format("{}{} is too large", word.letter, *value));
      word.value = *value;
    }
    words_.push_back(word);
  }
  return editable_;
}

// --- the end --------------------------------------------------------------------------------------------------------

void Sequencer::mark_repeated_moves() {
  const auto& runs = files_.runs(files_.main());
  for (Move& m : out_.moves)
    if (runs[m.block] > 1) m.editable = false;
}

/// Blocks behind M30 are no mistake where they are subprograms.
void Sequencer::warn_of_blocks_behind_the_end() {
  const Program& program = files_.main();
  const bool flow = program.macro.flow();
  if (!frames_.empty() || at_.file != &program) return;
  for (std::uint32_t b = at_.block + (flow ? 0 : 1); b < program.blocks.size(); ++b) {
    const Block& block = program.blocks[b];
    if (block.word_count == 0 && !block.flow) continue;
    if (flow && ((files_.runs(program)[b] > 0) || block.flow || program_number(program, b))) return;
    report_.warning(program.offset_of(b), "after-end", "the blocks after the end of the program (M2, M30) are not run");
    return;
  }
}

}  // namespace camber::nc
