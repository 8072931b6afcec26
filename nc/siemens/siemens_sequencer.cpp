#include "nc/siemens/siemens_sequencer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "base/cancel.h"
#include "nc/durations.h"
#include "nc/siemens/line_parser.h"
#include "nc/siemens/siemens_language.h"

namespace camber::nc::siemens {

constexpr std::size_t kMaxLevels = 16;

Sequencer::Sequencer(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics,
                     Reporter& report, Interpretation& out)
    : main_(program),
      options_(options),
      report_(report),
      out_(out),
      runner_(program, options, report, out),
      evaluator_(runner_),
      files_(program, diagnostics),
      runs_(program.blocks.size(), 0) {}

void Sequencer::run() {
  out_.moves.reserve(main_.blocks.size());
  Frame main;
  main.file = &main_;
  main.part = tree_of(main_).parts.front();
  frames_.push_back(std::move(main));
  evaluator_.use(tree(), frame().level);
  while (running_ && !report_.full()) {
    cancellation_point();
    try {
      step();
    } catch (const RunError& e) {
      report_.error(e.offset, e.check, e.what());
      // A loop whose condition cannot be read would go on to the limit of repeated blocks.
      constexpr int kMaxErrors = 1000;
      if (++run_errors_ >= kMaxErrors) running_ = false;
    }
  }
  report_.set_source(main_.source);
  mark_repeated_moves();
  if (!report_.has_errors()) warn_of_blocks_behind_the_end();
  runner_.finish();
}

bool Sequencer::is_skipped(const Block& block) const {
  return block.skip != 0 && (options_.skip_slash_blocks || (options_.skip_switches >> block.skip & 1) != 0);
}

std::uint32_t Sequencer::called_from() const { return frame().file == &main_ ? block_ : frame().called_from; }

BlockPlace Sequencer::place() const {
  return {frame().file, block_, called_from(), frame().file == &main_ && !block_has_expression_};
}

void Sequencer::count_run() {
  auto& runs = frame().file == &main_ ? runs_ : other_runs_[frame().file];
  if (runs.empty()) runs.resize(frame().file->blocks.size());
  std::uint8_t& count = runs[block_];
  if (count > 0 && ++repeated_ > options_.max_repeated_blocks) {
    report_.error(frame().file->offset_of(block_), "endless",
                  fmt::format("loops and jumps have run {} blocks again; the program is taken to be endless",
                              options_.max_repeated_blocks));
    running_ = false;
  }
  if (count < 255) ++count;
}

void Sequencer::step() {
  Frame& f = frame();
  if (!f.repeats.empty() && f.at == f.repeats.back().end) {
    auto& r = f.repeats.back();
    if (r.times_left > 0) {
      --r.times_left;
      f.at = r.first;
    } else {
      f.at = r.back;
      f.repeats.pop_back();
    }
    if (++repeated_ > options_.max_repeated_blocks) {
      running_ = false;
      report_.error(f.file->offset_of(std::min<std::size_t>(block_, f.file->blocks.size() - 1)), "endless",
                    "a repeated part never ends");
    }
    return;
  }
  if (f.at >= f.part.end) return end_of_part();
  block_ = f.at++;
  const Block& block = f.file->blocks[block_];
  if (is_skipped(block)) return;
  const Statement* statement = tree().statement(block_);
  if (block.word_count == 0 && !statement) return;
  count_run();
  block_has_expression_ = false;
  run_block(statement);
}

void Sequencer::run_block(const Statement* statement) {
  if (!statement) return run_plain_block();
  if (statement->flow != FlowKind::none && run_flow(*statement)) return;
  run_items(*statement);
}

void Sequencer::run_plain_block() {
  runner_.begin(place());
  runner_.add_plain(frame().file->words_of(block_));
  finish_block();
}

/// Carries the words out, and what comes behind: the end, a modal call.
void Sequencer::finish_block() {
  bool ends_subprogram = false;
  const std::size_t before = out_.moves.size();
  const bool go_on = runner_.execute(ends_subprogram);
  if ((frame().file == &main_ ? runs_[block_] : 2) > 1) repeated_ += (out_.moves.size() - before) / 4;
  if (!go_on) {
    if (frames_.size() > 1) return leave_frame();  // M30 in a subprogram ends it
    running_ = false;
    ended_ = true;
    return;
  }
  after_block();
  if (ends_subprogram) {
    if (frames_.size() > 1) return leave_frame();
    running_ = false;
    ended_ = true;
  }
}

/// MCALL: behind each block that has moved.
void Sequencer::after_block() {
  if (!modal_ || !runner_.has_moved() || frame().of_mcall) return;
  if (modal_->cycle) {
    runner_.run_cycle(*modal_->cycle, place());
    return;
  }
  start_subprogram(modal_->tree->names[modal_->item->name], *modal_->item, 1, true);
}

// --- flow control

/// Returns true where the items of the block are not to be run.
bool Sequencer::run_flow(const Statement& s) {
  Frame& f = frame();
  switch (s.flow) {
    case FlowKind::jump:
      run_items(s);
      for (std::size_t i = 0; i < s.jumps.size(); ++i) {
        if (s.constants[i] != kNone && !evaluator_.truth(s.constants[i])) continue;
        jump(s.jumps[i]);
        break;
      }
      return true;
    case FlowKind::select: {
      const Value value = evaluator_.value(s.condition);
      for (std::size_t i = 0; i < s.jumps.size(); ++i) {
        if (s.constants[i] != kNone) {
          const Value other = evaluator_.value(s.constants[i]);
          const bool same = value.text && other.text ? *value.text == *other.text
                                                     : !value.text && !other.text && value.number == other.number;
          if (!same) continue;
        }
        jump(s.jumps[i]);
        break;
      }
      return true;
    }
    case FlowKind::if_block:
      if (evaluator_.truth(s.condition) || s.partner == kNone) return true;
      f.at = s.partner + 1;
      return true;
    case FlowKind::else_branch: {  // come upon from above: the branch before it is done
      const Statement* other = s.partner == kNone ? nullptr : tree().statement(s.partner);
      if (other && other->block > s.block) f.at = other->block + 1;
      return true;
    }
    case FlowKind::end_if:
    case FlowKind::repeat_loop:
    case FlowKind::endless_loop:
    case FlowKind::external:
      return true;
    case FlowKind::for_loop:
      enter_for(s);
      return true;
    case FlowKind::end_for:
    case FlowKind::end_while:
    case FlowKind::end_loop:
      if (s.partner == kNone) return true;
      if (s.flow == FlowKind::end_for) {
        const Statement* head = tree().statement(s.partner);
        const Item& variable = head->items[head->variable];
        double next = 0;
        if (tree().names[variable.name] == "R") {
          double& r =
              evaluator_.parameter(evaluator_.known_number(tree().arguments[variable.first], "FOR"), variable.offset);
          next = r += 1;
        } else if (const auto found = evaluator_.variable(variable.name); found && found->dimensions == 0) {
          next = found->values[0].number += 1;
        }
        if (next > f.last_of[s.partner]) return true;
        f.at = s.partner + 1;
      } else {
        f.at = s.flow == FlowKind::end_while ? s.partner : s.partner + 1;
      }
      return true;
    case FlowKind::while_loop:
    case FlowKind::until:
      if (!evaluator_.truth(s.condition) && s.partner != kNone) f.at = s.partner + 1;
      return true;
    case FlowKind::repeat_part:
      repeat_part(s);
      return true;
    case FlowKind::declaration:
      for (const Declared& d : s.declared) evaluator_.declare(d);
      return true;
    case FlowKind::procedure:  // a call begins behind it
      if (s.declared.empty()) return true;
      report_.error(s.declared.front().offset, "subprogram",
                    "the parameters of this subprogram are given by its call; the program that calls it was expected");
      running_ = false;
      return true;
    default:
      return false;
  }
}

void Sequencer::enter_for(const Statement& s) {
  const Item& variable = s.items[s.variable];
  evaluator_.assign(variable);
  const double last = evaluator_.known_number(s.last, "the last value of FOR");
  double first = 0;
  if (tree().names[variable.name] == "R")
    first = evaluator_.parameter(evaluator_.known_number(tree().arguments[variable.first], "FOR"), variable.offset);
  else if (const auto found = evaluator_.variable(variable.name))
    first = found->values[0].number;
  frame().last_of[s.block] = last;
  if (first > last && s.partner != kNone) frame().at = s.partner + 1;
}

std::optional<std::uint32_t> Sequencer::find_target(const std::string& name, Jump::Search search) const {
  const Part& part = frame().part;
  std::optional<std::uint32_t> before, behind;
  for (const std::uint32_t block : tree().blocks_of(name)) {
    if (block < part.first || block >= part.end) continue;
    if (block > block_ && !behind) behind = block;
    if (block <= block_) before = block;
  }
  switch (search) {
    case Jump::Search::forward:
      return behind;
    case Jump::Search::backward:
      return before;
    default:
      return behind ? behind : before;
  }
}

void Sequencer::jump(const Jump& j) {
  if (j.search == Jump::Search::start) return go_to(frame().part.first);
  std::string name = j.target != kNone ? tree().names[j.target] : std::string();
  std::optional<std::uint32_t> target;
  if (j.target != kNone) {
    target = find_target(name, j.search);
    if (!target)
      if (const auto variable = evaluator_.variable(j.target); variable && variable->values[0].text)
        name = *variable->values[0].text;
  } else {
    name = evaluator_.text(j.value);
  }
  if (!target) {
    for (char& c : name) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
    target = find_target(name, j.search);
  }
  if (!target) {
    if (j.silent) return;
    const bool elsewhere = find_target(name, Jump::Search::both).has_value();
    report_.error(j.offset, "jump",
                  elsewhere ? fmt::format("{} is not {} here, where {} looks for it", name,
                                          j.search == Jump::Search::forward ? "below" : "above",
                                          j.search == Jump::Search::forward ? "GOTOF" : "GOTOB")
                            : fmt::format("no label or block number {} in this program", name));
    running_ = false;
    return;
  }
  go_to(*target);
}

void Sequencer::go_to(std::uint32_t block) {
  auto& repeats = frame().repeats;
  while (!repeats.empty() && (block < repeats.back().first || block >= repeats.back().end)) repeats.pop_back();
  frame().at = block;
}

/// REPEAT label: from the label to here (or to ENDLABEL), again; REPEAT first last; REPEATB: that block alone.
void Sequencer::repeat_part(const Statement& s) {
  const double count = s.last == kNone ? 1 : std::round(evaluator_.known_number(s.last, "P"));
  if (!(count >= 0 && count <= 9999)) {
    report_.error(s.flow_offset, "repeat", fmt::format("P={:g} repeats; 0 to 9999 were expected", count));
    return;
  }
  if (count == 0 || s.labels.empty()) return;
  const std::string& name = tree().names[s.labels[0]];
  auto first = find_target(name, Jump::Search::backward);
  const bool behind = !first;
  if (!first) first = find_target(name, Jump::Search::forward);
  if (!first) {
    report_.error(s.flow_offset, "repeat", fmt::format("no label {} in this program", name));
    running_ = false;
    return;
  }
  std::optional<std::uint32_t> end;
  if (s.named_number) {
    end = *first + 1;
  } else if (s.labels.size() > 1) {
    const std::string& last = tree().names[s.labels[1]];
    for (const std::uint32_t block : tree().blocks_of(last))
      if (block >= *first && block < frame().part.end && !end) end = block + 1;
    if (!end) {
      report_.error(s.flow_offset, "repeat", fmt::format("no label {} below {}", last, name));
      running_ = false;
      return;
    }
  } else {
    for (const std::uint32_t block : tree().blocks_of("ENDLABEL"))
      if (block > *first && block < frame().part.end && !end) end = block;
    if (end && !behind && *end > s.block) end.reset();
    if (!end) end = behind ? frame().part.end : s.block;
  }
  if (frame().repeats.size() > 50) {
    report_.error(s.flow_offset, "repeat", "repeated parts more than 50 deep");
    running_ = false;
    return;
  }
  frame().repeats.push_back({*first, *end, s.block + 1, static_cast<std::size_t>(count) - 1});
  frame().at = *first;
}

// --- items

double Sequencer::word_value(const Item& item, std::string_view what) {
  if (item.constant) return item.number;
  block_has_expression_ = true;
  return evaluator_.known_number(item.value, what);
}

/// SUPA, G53, G153.
bool Sequencer::says_machine_frame(const Item& item) const {
  if (item.kind == ItemKind::command) return item.row->does == Does::supa;
  return item.kind == ItemKind::word && item.constant && tree().names[item.name] == "G" &&
         (item.number == 53 || item.number == 153);
}

void Sequencer::run_items(const Statement& s) {
  // Expressions leave no words of their own to edit: find out before the block begins.
  for (const Item& item : s.items)
    if (item.kind == ItemKind::word && !item.constant && item.value != kNone && !item.row &&
        std::string_view("XYZABCIJKF").find(tree().names[item.name][0]) != std::string_view::npos)
      block_has_expression_ = true;
  in_machine_frame_ = block_has_expression_ &&
                      std::ranges::any_of(s.items, [this](const Item& item) { return says_machine_frame(item); });
  runner_.begin(place());
  const Item* call = nullptr;
  const Item* mcall = nullptr;
  std::size_t times = 1;
  // Values are worked out before anything is assigned.
  for (const Item& item : s.items) {
    const std::string& name = tree().names[item.name];
    switch (item.kind) {
      case ItemKind::word:
        if (name == "P" && call) {
          const double p = word_value(item, "P");
          if (!(p >= 0 && p <= 9999))
            throw RunError(item.offset, "subprogram", fmt::format("P{:g} runs; 1 to 9999 were expected", p));
          times = static_cast<std::size_t>(p);
        } else {
          run_word(item);
        }
        break;
      case ItemKind::command:
        if (item.row->does == Does::modal_call)
          mcall = &item;
        else
          run_command_word(item);
        break;
      case ItemKind::call:
        call = &item;
        break;
      default:
        break;
    }
  }
  for (const Item& item : s.items) {
    if (item.kind != ItemKind::assign) continue;
    const std::string& name = tree().names[item.name];
    if (name[0] != '$') {
      evaluator_.assign(item);
      continue;
    }
    std::vector<double> indexes;
    std::vector<std::string> index_names;
    for (std::uint32_t i = 0; i < item.count; ++i) {
      const std::uint32_t node = tree().arguments[item.first + i];
      const Node& n = tree().nodes[node];
      const bool bare = n.kind == NodeKind::variable && n.count == 0 && !evaluator_.variable(n.name);
      index_names.push_back(bare ? tree().names[n.name] : std::string());
      indexes.push_back(bare ? 0 : evaluator_.number(node));
    }
    runner_.set_frame_variable(name, indexes, index_names, evaluator_.value(item.value), item.offset);
  }
  if (mcall) {
    modal_.reset();
    finish_block();
    if (!call || (call->row && call->row->does == Does::nothing)) return;
    if (call->row && runner_.drills({call->row, {}, 0})) {
      modal_ = ModalCall{&tree(), frame().file, nullptr, cycle_call(*call)};
    } else if (call->row && call->row->does == Does::refused) {
      runner_.set_command(*call->row, call->offset);
    } else if (call->row) {
      report_.error(call->offset, "cycle",
                    fmt::format("{} under MCALL is not supported; a drilling cycle or a subprogram was expected",
                                call->row->name));
    } else {
      if (!files_.find(*frame().file, tree().names[call->name])) {
        report_missing(tree().names[call->name], call->offset);
        return;
      }
      modal_ = ModalCall{&tree(), frame().file, call, std::nullopt};
    }
    return;
  }
  if (call) {
    const std::size_t depth = frames_.size();
    finish_block();
    if (!running_ || frames_.size() != depth) return;
    run_call(*call, times, s);
    return;
  }
  bool returns = false;
  for (const Item& item : s.items) returns |= item.kind == ItemKind::command && item.row->does == Does::end_subprogram;
  const std::size_t depth = frames_.size();
  finish_block();
  if (returns && running_ && frames_.size() == depth) {
    if (depth > 1) return leave_frame();
    running_ = false;
    ended_ = true;
  }
}

void Sequencer::set_extra(const Item& item, Extra extra) {
  const double value = word_value(item, item.row->name);
  runner_.words().set(extra) = {true, !item.constant, item.dimension, value, item.offset};
}

void Sequencer::run_word(const Item& item) {
  const std::string& name = tree().names[item.name];
  if (item.row) return run_command_word(item);
  if (name.size() > 1) {
    const double value = word_value(item, name);
    // G74 X1=0, G75 FP=2 Y1=0: axes of the machine by their names.
    if (name.size() == 2 && name[1] == '1' && name[0] >= 'X' && name[0] <= 'Z' && runner_.goes_to_fixed_point()) {
      runner_.words().set(name[0]) = {true, !item.constant, item.dimension, value, item.offset};
      return;
    }
    report_.error(
        item.offset, "axis",
        fmt::format("{}={:g}: {} is not an axis that Camber knows; X, Y, Z, A, B or C was expected", name, value, name),
        name);
    return;
  }
  const char letter = name[0];
  const double extension =
      item.index == kNone ? runner_.modes().main_spindle() : evaluator_.known_number(item.index, name);
  BlockWords& words = runner_.words();
  switch (letter) {
    case 'N':
      return;
    case 'G':
    case 'M': {
      const double value = word_value(item, name);
      if (letter == 'G' && item.index != kNone) {
        report_.error(item.offset, "not-supported",
                      "a G function by its group (G[n]=) is not supported; its own word was expected");
        return;
      }
      const int number = value >= 0 && value < 1e6 && value == std::floor(value) ? static_cast<int>(value) : -1;
      (letter == 'G' ? words.g : words.m).push_back({number, item.offset, static_cast<int>(extension), value});
      return;
    }
    case 'T': {
      const Value value = evaluator_.value(item.value);
      if (value.text) return runner_.set_tool_name(*value.text, item.offset);
      break;
    }
    case 'S':
      if (static_cast<int>(extension) != runner_.modes().main_spindle()) {
        const double rpm = word_value(item, name);
        return runner_.modes().note_speed(static_cast<int>(extension),
                                          {true, !item.constant, item.dimension, rpm, item.offset});
      }
      break;
    case 'H':
      return;
    default:
      break;
  }
  if (letter == 'L' || letter == 'O' || letter == 'P' || letter == 'R') {
    report_.error(item.offset, "unknown-word",
                  fmt::format("{} is no word here; an axis or a function was expected", letter), name);
    return;
  }
  if (in_machine_frame_ && letter >= 'X' && letter <= 'Z' && !item.constant && evaluator_.is_undeclared(item.value))
    return runner_.leave_for_machine_place(letter, tree().names[tree().nodes[item.value].name], item.offset);
  Slot& slot = words.set(letter);
  if (slot.given)
    report_.error(item.offset, "word-twice", fmt::format("{} twice in one block; once was expected", letter));
  slot = {true, !item.constant, item.dimension, word_value(item, name), item.offset};
}

/// Words of the language: addresses and commands.
void Sequencer::run_command_word(const Item& item) {
  const WordRow& row = *item.row;
  if (row.does == Does::extra)
    return set_extra(item, static_cast<Extra>(std::ranges::find(kExtraNames, row.name) - kExtraNames.begin()));
  switch (row.does) {
    case Does::modal_rounding:
    case Does::contour_tolerance:
    case Does::offset_normal:
    case Does::corner_feed:
    case Does::block_feed:
      return runner_.set_number(row, word_value(item, row.name));
    case Does::spindle_position:
      return runner_.orient_spindle();
    case Does::position_axis: {
      const std::string axis = item.index == kNone ? std::string() : evaluator_.axis_name(item.index);
      if (axis.size() != 1 || std::string_view("XYZABC").find(axis[0]) == std::string_view::npos) {
        report_.error(item.offset, "axis", fmt::format("{}[{}]: X, Y, Z, A, B or C was expected", row.name, axis));
        return;
      }
      return runner_.position_axis(axis[0],
                                   {true, !item.constant, item.dimension, word_value(item, row.name), item.offset});
    }
    case Does::blend_distance_rapid:
      return;
    default:
      return runner_.set_command(row, item.offset);
  }
}

// --- calls

CycleCall Sequencer::cycle_call(const Item& item) {
  CycleCall call;
  call.row = item.row;
  call.offset = item.offset;
  for (std::uint32_t i = 0; i < item.count; ++i) {
    const std::uint32_t node = tree().arguments[item.first + i];
    if (node == kNone) {
      call.values.emplace_back();
      continue;
    }
    call.values.emplace_back(evaluator_.value(node));
    if (!call.values.back()->text && std::isnan(call.values.back()->number))
      evaluator_.known_number(node, item.row->name);
  }
  return call;
}

void Sequencer::run_call(const Item& item, std::size_t times, const Statement&) {
  if (!item.row) return start_subprogram(tree().names[item.name], item, times, false);
  switch (item.row->does) {
    case Does::nothing:
      return;
    case Does::main_spindle:
      runner_.modes().set_main_spindle(
          item.count > 0 && tree().arguments[item.first] != kNone
              ? static_cast<int>(evaluator_.known_number(tree().arguments[item.first], "SETMS"))
              : 1);
      return;
    case Does::alarm: {
      const double number =
          item.count > 0 && tree().arguments[item.first] != kNone ? evaluator_.number(tree().arguments[item.first]) : 0;
      report_.error(
          item.offset, "alarm",
          fmt::format("the program reaches SETAL({:.0f}), an alarm of its own, which stops the machine", number));
      return;
    }
    case Does::call_text: {
      std::string name;
      for (const char c : evaluator_.text(item.value))
        if (c != ' ' && c != '"') name += c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
      for (const char* ending : {".SPF", ".MPF"})
        if (name.ends_with(ending)) name.resize(name.size() - 4);
      return start_subprogram(name, item, times, false);
    }
    case Does::workpiece:
      return runner_.cycles().set_stock(cycle_call(item), called_from());
    case Does::transform_on:
    case Does::transform_off:
      return runner_.set_command(*item.row, item.offset);
    case Does::pattern: {
      if (!modal_) {
        report_.error(
            item.offset, "cycle",
            fmt::format("{} without a modal cycle; MCALL with a drilling cycle was expected before", item.row->name));
        return;
      }
      if (!modal_->cycle) {
        report_.error(item.offset, "not-supported",
                      fmt::format("{} with a subprogram under MCALL is not supported; a drilling cycle was expected",
                                  item.row->name));
        return;
      }
      const BlockPlace here = place();
      return runner_.cycles().run_pattern(cycle_call(item), here, [&] { runner_.run_cycle(*modal_->cycle, here); });
    }
    default:
      break;
  }
  if (item.row->kind == WordKind::cycle && item.row->does != Does::refused)
    return runner_.run_cycle(cycle_call(item), place());
  runner_.set_command(*item.row, item.offset);
}

void Sequencer::report_missing(const std::string& name, std::size_t offset) {
  if (name.starts_with("E_") || name.starts_with("F_"))
    return report_.error(offset, "not-supported",
                         fmt::format("{} is a step of a ShopMill work plan, which is not supported; the program in G "
                                     "code was expected",
                                     name),
                         "ShopMill");
  report_.error(offset, "subprogram",
                fmt::format("no subprogram {0}: neither %_N_{0}_SPF in this file nor {0}.SPF beside it", name), name);
}

void Sequencer::start_subprogram(const std::string& name, const Item& item, std::size_t times, bool of_mcall) {
  if (times == 0) return;
  const Tree& own = of_mcall && modal_ ? *modal_->tree : tree();
  const auto found = files_.find(*frame().file, name);
  if (!found) {
    return report_missing(name, item.offset);
  }
  if (frames_.size() >= kMaxLevels) {
    report_.error(item.offset, "subprogram",
                  fmt::format("{} is called {} levels deep; at most {} were expected", name, kMaxLevels, kMaxLevels));
    running_ = false;
    return;
  }
  Frame next;
  next.file = found->file;
  next.part = found->part;
  next.called_from = called_from();
  next.times_left = times - 1;
  next.start = next.at = found->part.first;
  next.of_mcall = of_mcall || frame().of_mcall;
  const Statement* procedure = nullptr;
  const Tree& called = tree_of(*found->file);
  for (const Statement& s : called.statements)
    if (s.block >= found->part.first && s.block < found->part.end && s.flow == FlowKind::procedure) {
      procedure = &s;
      break;
    }
  if (&own != &tree() && item.count > 0)
    throw RunError(item.offset, "not-supported",
                   fmt::format("{} with values, under MCALL of another file, is not supported", name));
  bind_parameters(next, procedure, item);
  if (procedure) {
    next.start = next.at = procedure->block + 1;
    if (procedure->saves) next.saved = runner_.saved_modes();
  }
  frames_.push_back(std::move(next));
  report_.set_source(frame().file->source);
  evaluator_.use(tree(), frame().level);
}

void Sequencer::bind_parameters(Frame& next, const Statement* procedure, const Item& item) {
  const std::size_t wanted = procedure ? procedure->declared.size() : 0;
  if (item.count > wanted)
    throw RunError(item.offset, "subprogram",
                   fmt::format("{} values for a subprogram with {} parameters", item.count, wanted));
  const Tree& called = tree_of(*next.file);
  next.level.variables.resize(called.names.size());
  for (std::size_t i = 0; i < wanted; ++i) {
    const Declared& d = procedure->declared[i];
    const std::uint32_t node = i < item.count ? tree().arguments[item.first + i] : kNone;
    auto made = std::make_shared<Variable>();
    made->type = d.type;
    if (node != kNone && (d.by_reference || d.dimensions > 0)) {
      if (const auto whole = evaluator_.whole_variable(node)) {
        if (d.by_reference) {
          next.level.variables[d.name] = whole;
          continue;
        }
        *made = *whole;
        next.level.variables[d.name] = made;
        continue;
      }
      if (d.by_reference) next.copied_back.emplace_back(made, node);
    }
    if (d.type == ValueType::text || d.type == ValueType::axis)
      made->values[0].text = std::make_shared<const std::string>();
    if (d.type == ValueType::frame) made->values[0].frame = std::make_shared<const Affine>();
    if (node != kNone)
      made->values[0] = evaluator_.value(node);
    else if (d.value != kNone && called.nodes[d.value].kind == NodeKind::number)
      made->values[0] = {called.nodes[d.value].number, {}, {}};
    else if (d.value != kNone && called.nodes[d.value].kind == NodeKind::text)
      made->values[0].text = std::make_shared<const std::string>(called.texts[called.nodes[d.value].name]);
    if (d.type == ValueType::integer && !made->values[0].text)
      made->values[0].number = std::floor(made->values[0].number + 0.5);
    next.level.variables[d.name] = made;
  }
}

void Sequencer::leave_frame() {
  Frame& f = frame();
  if (f.times_left > 0) {
    --f.times_left;
    f.at = f.start;
    f.repeats.clear();
    return;
  }
  if (f.saved) runner_.restore(*f.saved);
  const auto copied = std::move(f.copied_back);
  frames_.pop_back();
  report_.set_source(frame().file->source);
  evaluator_.use(tree(), frame().level);
  block_ = frame().at > 0 ? frame().at - 1 : 0;
  for (const auto& [variable, node] : copied) evaluator_.set_by_node(node, variable->values[0]);
}

void Sequencer::end_of_part() {
  if (frames_.size() > 1) return leave_frame();
  running_ = false;
}

// --- what is said at the end

/// Moves of blocks that have run more than once have no text of their own.
void Sequencer::mark_repeated_moves() {
  for (Move& move : out_.moves)
    if (move.block < runs_.size() && runs_[move.block] > 1) move.editable = false;
}

void Sequencer::warn_of_blocks_behind_the_end() const {
  if (!ended_) return;
  const Part& part = tree_of(main_).parts.front();
  if (!tree_of(main_).statements.empty() && std::ranges::any_of(tree_of(main_).statements, [](const Statement& s) {
        return s.flow == FlowKind::jump || s.flow == FlowKind::select || s.flow == FlowKind::repeat_part;
      }))
    return;
  for (std::uint32_t b = block_ + 1; b < part.end; ++b)
    if (main_.blocks[b].word_count > 1 ||
        (main_.blocks[b].word_count == 1 && main_.words[main_.blocks[b].first_word].letter != 'N')) {
      report_.warning(main_.offset_of(b), "after-end",
                      "blocks behind the end of the program (M30, M2, M17) do not run");
      return;
    }
}

// --- subprograms

namespace {

std::string in_upper_case(std::string text) {
  for (char& c : text) c = upper(c);
  return text;
}

}  // namespace

std::optional<FoundProgram> ProgramFiles::find(const Program& from, const std::string& called) {
  std::string name = called;
  if (const std::size_t slash = name.find_last_of('/'); slash != std::string::npos) name.erase(0, slash + 1);
  if (name.starts_with("_N_")) name.erase(0, 3);
  for (const char* type : {"_SPF", "_MPF", ".SPF", ".MPF"})
    if (name.size() > 4 && name.ends_with(type)) name.resize(name.size() - 4);
  for (const Program* file : {&from, &main_})
    for (const Part& part : tree_of(*file).parts)
      if (part.name == name && !(part.first == 0 && file == &main_)) return FoundProgram{file, part};
  const auto known = files_.find(name);
  if (known == files_.end()) {
    namespace fs = std::filesystem;
    if (!folder_read_) {
      folder_read_ = true;
      fs::path folder = fs::path(main_.source.name()).parent_path();
      if (folder.empty()) folder = ".";
      std::error_code none;
      if (fs::exists(main_.source.name(), none))
        for (const auto& entry : fs::directory_iterator(folder, none))
          if (entry.is_regular_file(none))
            folder_.try_emplace(in_upper_case(entry.path().filename().string()), entry.path().string());
    }
    auto& file = files_[name];
    for (const char* extension : {".SPF", ".MPF", ".CYC", "_SPF", "_MPF", ""}) {
      auto found = folder_.find(name + extension);
      if (found == folder_.end()) found = folder_.find("_N_" + name + extension);
      std::error_code none;
      if (found == folder_.end() || fs::equivalent(found->second, main_.source.name(), none)) continue;
      file = std::make_unique<Program>(read(SourceText::read(found->second), diagnostics_));
      break;
    }
  }
  const auto& file = files_[name];
  if (!file) return std::nullopt;
  for (const Part& part : tree_of(*file).parts)
    if (part.name == name) return FoundProgram{file.get(), part};
  return FoundProgram{file.get(), tree_of(*file).parts.front()};
}

}  // namespace camber::nc::siemens
