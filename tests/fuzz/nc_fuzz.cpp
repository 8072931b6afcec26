// libFuzzer target: any bytes are read as a program, interpreted, summed up and written back.
//
// What has to hold beside "no crash, no hang, no unbounded memory": a program without errors comes out byte for byte;
// with one move edited the text still reads without an error, has the moves that it had, and the edited one ends where
// it should. The last bytes of the input say which move is edited and how; the others are the program.
#include <fuzzer/FuzzedDataProvider.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "nc/emit.h"
#include "nc/interpreter.h"
#include "nc/language.h"
#include "nc/summary.h"

namespace {

using namespace camber;

/// Beyond this a double has fewer digits left than the decimals that are compared.
constexpr double kLargestPlaceMm = 1e6;
constexpr double kPlaceTolerance_mm = 2e-3;  ///< rounding to four decimals, or to five of an inch, and the sums of G91
/// Blocks that loops may run again. A run with the limit of everyday (ten million) would take seconds.
constexpr std::size_t kMaxRepeatedBlocks = 20000;
/// More moves than the blocks of any fuzzed text make without repeats of cycles: not worth emitting in this time.
constexpr std::size_t kMaxMoves = 20000;

struct Read {
  nc::Program program;
  nc::Interpretation moves;
  bool clean = false;  ///< no errors
};

Read read(const std::string& text, const nc::InterpreterOptions& options) {
  Read r;
  Diagnostics diagnostics;
  try {
    r.program = nc::read_program(SourceText("fuzz.nc", text), nc::language_asked_for(options), diagnostics);
    r.moves = nc::interpret(r.program, options, diagnostics);
    r.clean = !diagnostics.has_errors();
  } catch (const InputError& e) {
    if (std::string_view(e.what()).empty()) std::abort();
  }
  return r;
}

[[noreturn]] void fail(const char* what, const std::string& before, const std::string& after) {
  std::fprintf(stderr, "%s\n--- program\n%s\n--- emitted\n%s\n", what, before.c_str(), after.c_str());
  std::abort();
}

bool within_reach(const nc::Interpretation& moves) {
  for (const nc::Move& m : moves.moves)
    if (!(m.end_mm.cwiseAbs().maxCoeff() < kLargestPlaceMm)) return false;
  return true;
}

/// Programs in which an edit may rightly change other moves, or make an error: those that ask where the tool is, set a
/// frame from there, or compute a path beside a contour.
bool edits_stay_where_they_are(const Read& r) {
  if (!r.program.macro.expressions.list.empty()) return false;
  if (r.program.language != nc::LanguageId::iso)
    for (const nc::Block& block : r.program.blocks)
      if (block.flow) return false;
  for (const nc::ModalState& s : r.moves.states)
    if (s.cutter_radius) return false;
  return r.moves.frames.size() == 1;
}

/// The way to the intermediate point of G28 or G30, of which the next move goes on to the reference point.
bool goes_to_intermediate_point(const std::vector<nc::Move>& moves, std::size_t i) {
  return moves[i].reference_axes == 0 && i + 1 < moves.size() && moves[i + 1].reference_axes != 0 &&
         moves[i + 1].block == moves[i].block;
}

/// Without the steps of drilling cycles and the ways to the intermediate points of G28 and G30: those that go nowhere
/// are left out, and which they are depends on where the tool stands before.
std::size_t own_moves(const Read& r) {
  const std::vector<nc::Move>& moves = r.moves.moves;
  std::size_t count = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) count += !moves[i].canned && !goes_to_intermediate_point(moves, i);
  return count;
}

/// One line or arc of the program with a new end.
std::optional<nc::MoveEdit> edit_from(FuzzedDataProvider& bytes, const Read& r) {
  const std::size_t count = r.moves.moves.size();
  if (count == 0) return std::nullopt;
  const auto index = static_cast<std::uint32_t>(bytes.ConsumeIntegral<std::uint16_t>() % count);
  const nc::Move& move = r.moves.moves[index];
  Vec3 shift;
  for (int axis = 0; axis < 3; ++axis) shift[axis] = bytes.ConsumeIntegral<std::int8_t>() / 256.0;
  nc::MoveEdit edit{.move = index, .end_mm = move.end_mm + shift};
  if (move.arc != nc::Move::kNoArc)
    edit.center_mm = r.moves.arcs[move.arc].center_mm + shift;
  else if (move.kind == nc::MoveKind::linear && bytes.ConsumeBool())
    edit.via = {{0.5 * (move.start_mm + move.end_mm) + shift}};
  return edit;
}

void emit_and_read(const Read& r, const nc::InterpreterOptions& options, FuzzedDataProvider& bytes) {
  const std::string& text = r.program.source.text();
  if (const std::string same = nc::emit(r.program, r.moves, {}, {}); same != text)
    fail("an untouched program does not come out byte for byte", text, same);
  if (!within_reach(r.moves) || !edits_stay_where_they_are(r)) return;
  const auto edit = edit_from(bytes, r);
  if (!edit) return;
  const std::string changed = nc::emit(r.program, r.moves, std::span(&*edit, 1), {});
  const Read again = read(changed, options);
  if (!again.clean) fail("the emitted program does not read", text, changed);
  const bool split = !edit->via.empty();
  if (!split && own_moves(again) != own_moves(r)) fail("moves are lost or added", text, changed);
  if (split && own_moves(again) < own_moves(r)) fail("moves are lost", text, changed);
  const nc::Move& before = r.moves.moves[edit->move];
  if (split || before.kind != nc::MoveKind::linear || before.canned) return;
  const Vec3 end = again.moves.moves[edit->move].end_mm;
  if ((end - *edit->end_mm).cwiseAbs().maxCoeff() > kPlaceTolerance_mm &&
      (end - before.end_mm).cwiseAbs().maxCoeff() > kPlaceTolerance_mm)
    fail("the edited move ends neither at its new place nor at its old one", text, changed);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider bytes(data, size);
  // Integers are taken from the end of the input, so that what stands before them is a program as it is written.
  const auto flags = bytes.ConsumeIntegral<std::uint8_t>();
  std::vector<std::uint8_t> choice;
  for (int i = 0; i < 6; ++i) choice.push_back(bytes.ConsumeIntegral<std::uint8_t>());
  nc::InterpreterOptions options{.inch = (flags & 1) != 0};
  options.skip_slash_blocks = (flags & 2) != 0;
  options.dwell_p_is_ms = (flags & 4) != 0;
  options.absolute_arc_centre = (flags & 8) != 0;
  if ((flags & 16) != 0) options.dialect = nc::dialects()[(flags >> 5) % nc::dialects().size()];
  options.whole_numbers_are_increments = (choice[5] & 3) == 3;
  options.skip_switches = static_cast<std::uint16_t>((choice[5] & 4) != 0 ? 0x3fe : 0);
  options.max_repeated_blocks = kMaxRepeatedBlocks;
  options.tool_offsets[1].radius_mm = 1.5;
  const bool rotary = (choice[5] & 8) != 0;
  if (rotary) {
    options.rotary_axes = {{.letter = 'B', .on_table = (choice[5] & 16) == 0, .clamp_m = 10, .unclamp_m = 11},
                           {.letter = 'C', .shortest_way = true}};
    options.tool_offsets[1].length_mm = 80;
    options.work_offsets_mm[54] = Vec3(1, 2, 3);
  }
  const Read r = read(bytes.ConsumeRemainingBytesAsString(), options);
  if (!r.clean) return 0;
  nc::summarize(r.program, r.moves);
  if (r.moves.moves.size() > kMaxMoves) return 0;
  if (rotary) {  // programs with rotary axes are not edited
    if (nc::emit(r.program, r.moves, {}, {}) != r.program.source.text())
      fail("an untouched program does not come out byte for byte", r.program.source.text(), {});
    return 0;
  }
  FuzzedDataProvider edit_bytes(choice.data(), choice.size());
  emit_and_read(r, options, edit_bytes);
  return 0;
}
