// libFuzzer target: any bytes are read as a program (tests/fuzz/checked_program.h). The last bytes of the input say
// with which options, which move is edited and how; the others are the program.
#include "tests/fuzz/checked_program.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider bytes(data, size);
  // Integers are taken from the end of the input, so that what stands before them is a program as it is written.
  const auto flags = bytes.ConsumeIntegral<std::uint8_t>();
  std::vector<std::uint8_t> choice;
  for (int i = 0; i < 6; ++i) choice.push_back(bytes.ConsumeIntegral<std::uint8_t>());
  camber::nc::InterpreterOptions options{.inch = (flags & 1) != 0};
  options.skip_slash_blocks = (flags & 2) != 0;
  options.dwell_p_is_ms = (flags & 4) != 0;
  options.absolute_arc_centre = (flags & 8) != 0;
  if ((flags & 16) != 0) options.dialect = camber::nc::dialects()[(flags >> 5) % camber::nc::dialects().size()];
  options.whole_numbers_are_increments = (choice[5] & 3) == 3;
  options.skip_switches = static_cast<std::uint16_t>((choice[5] & 4) != 0 ? 0x3fe : 0);
  options.max_repeated_blocks = camber::fuzz::kMaxRepeatedBlocks;
  options.tool_offsets[1].radius_mm = 1.5;
  const bool rotary = (choice[5] & 8) != 0;
  if (rotary) {
    options.rotary_axes = {{.letter = 'B', .on_table = (choice[5] & 16) == 0, .clamp_m = 10, .unclamp_m = 11},
                           {.letter = 'C', .shortest_way = true}};
    options.tool_offsets[1].length_mm = 80;
    options.work_offsets_mm[54] = camber::Vec3(1, 2, 3);
  }
  camber::fuzz::check_program(bytes.ConsumeRemainingBytesAsString(), options, rotary, choice);
  return 0;
}
