// libFuzzer target: programs made by a grammar, in ISO code, Klartext and Siemens. Bytes choose among productions, so
// that nearly every input is a program that reads, and the fuzzer's time goes into meaning instead of spelling. What
// has to hold stands in tests/fuzz/checked_program.h.
#include <fmt/format.h>

#include <array>

#include "tests/fuzz/checked_program.h"

namespace camber::fuzz {
namespace {

class Writer {
 public:
  Writer(FuzzedDataProvider& bytes, nc::LanguageId language) : bytes_(bytes), language_(language) {}

  std::string program() {
    const bool klartext = language_ == nc::LanguageId::heidenhain;
    text_ = klartext ? "BEGIN PGM A MM\nTOOL CALL 1 Z S3000\nL Z+5 R0 FMAX M3\n"
                     : "G21 G90 G17 G54\nT1 M6\nS3000 M3\nG0 X0 Y0 Z5\n";
    for (int i = 0; i < 40 && bytes_.remaining_bytes() > 0; ++i) text_ += block() + "\n";
    return text_ + close() + (klartext ? "END PGM A MM\n" : "M30\n");
  }

 private:
  int pick(int count) { return bytes_.ConsumeIntegralInRange(0, count - 1); }
  bool often() { return bytes_.ConsumeIntegral<std::uint8_t>() > 60; }

  std::string number() {
    switch (pick(6)) {
      case 0:
        return fmt::format("{}.", pick(40) - 20);
      case 1:
        return fmt::format("{:.3f}", (pick(4000) - 2000) / 100.0);
      case 2:
        return fmt::format("{:.4f}", (pick(20000) - 10000) / 10000.0);
      case 3:
        return "0";
      case 4:
        return fmt::format("-.{}", 1 + pick(99));
      default:
        return fmt::format("{}", pick(60) - 30.5);
    }
  }

  /// A coordinate of the language at hand.
  std::string word(char axis) {
    const std::string value = number();
    if (language_ != nc::LanguageId::heidenhain) return fmt::format(" {}{}", axis, value);
    const bool incremental = pick(5) == 0;
    return fmt::format(" {}{}{}{}", incremental ? "I" : "", axis, value[0] == '-' ? "" : "+", value);
  }

  std::string words(std::string_view axes) {
    std::string out;
    for (const char axis : axes)
      if (often()) out += word(axis);
    return out;
  }

  std::string feed() { return pick(3) == 0 ? fmt::format(" F{}", 100 + pick(3000)) : ""; }

  std::string block() {
    if (language_ == nc::LanguageId::heidenhain) return klartext();
    if (pick(3) > 0) return motion();
    return language_ == nc::LanguageId::siemens ? siemens() : iso();
  }

  std::string motion() {
    static constexpr std::array kPlanes{"G17", "G18", "G19"};
    switch (pick(9)) {
      case 0:
        return "G0" + words("XYZ");
      case 1:
      case 2:
        return "G1" + words("XYZ") + feed();
      case 3:
        return words("XYZ") + feed();
      case 4:
        return fmt::format("G{}{} I{} J{}{}", 2 + pick(2), words("XY"), number(), number(), feed());
      case 5:
        return kPlanes[static_cast<std::size_t>(pick(3))];
      case 6:
        return pick(2) == 0 ? "G90" : "G91";
      case 7:
        return pick(2) == 0 ? "G41 D1" + words("XY") : "G40" + words("XY");
      default:
        return fmt::format("G{}{} K{} I{}{}", 2 + pick(2), words("XZ"), number(), number(), feed());
    }
  }

  std::string iso() {
    switch (pick(13)) {
      case 0:
        return fmt::format("G{} {} Z{} R{} F200", 81 + pick(9), words("XY"), number(), number());
      case 1:
        return "G80";
      case 2:
        return fmt::format("G{}", 54 + pick(6));
      case 3:
        return fmt::format("G{} G91{}", 28 + 2 * pick(2), words("XYZ"));
      case 4:
        return "G92" + words("XYZ");
      case 5:
        return fmt::format("G52{}", words("XYZ"));
      case 6:
        return fmt::format("G68 X0 Y0 R{}", pick(90));
      case 7:
        return "G69";
      case 8:
        return fmt::format("#{}={}", 100 + pick(4), number());
      case 9:
        return fmt::format("G1 X#{} Y[#{}*2+1]", 100 + pick(4), 100 + pick(4));
      case 10:
        return fmt::format("G{}{} R{}", 2 + pick(2), words("XY"), number());
      case 11:
        return fmt::format("G43 H1 Z{}", number());
      default:
        return fmt::format("G4 P{}", pick(1000));
    }
  }

  std::string siemens() {
    switch (pick(13)) {
      case 0:
        return fmt::format("R{}={}", pick(5), number());
      case 1:
        return fmt::format("G1 X=R{} Y=R{}*2+1", pick(5), pick(5));
      case 2:
        return fmt::format("G{}{} CR={}", 2 + pick(2), words("XY"), number());
      case 3:
        return fmt::format("CYCLE81({},0,1,{})", 5 + pick(9), number());
      case 4:
        return fmt::format("MCALL CYCLE81({},0,1,{})", 5 + pick(9), number());
      case 5:
        return "MCALL";
      case 6:
        return fmt::format("TRANS{}", words("XYZ"));
      case 7:
        return fmt::format("ROT RPL={}", pick(90));
      case 8:
        return pick(2) == 0 ? "TRANS" : "ROT";
      case 9:
        return fmt::format("G1 X=IC({}) Y=AC({})", number(), number());
      case 10:
        return open("FOR R9=1 TO 2", "ENDFOR");
      case 11:
        return open(fmt::format("IF R{} > {}", pick(5), number()), "ENDIF");
      default:
        return fmt::format("{} RND={}", "G1" + words("XY"), 1 + pick(3));
    }
  }

  std::string klartext() {
    switch (pick(13)) {
      case 0:
        return "L" + words("XYZ") + " FMAX";
      case 1:
      case 2:
        return "L" + words("XYZ") + feed();
      case 3:
        return "CC" + word('X') + word('Y');
      case 4:
        return fmt::format("C{}{} DR{}", word('X'), word('Y'), pick(2) == 0 ? "+" : "-");
      case 5:
        return fmt::format("CR{}{} R{} DR{}", word('X'), word('Y'), number(), pick(2) == 0 ? "+" : "-");
      case 6:
        return fmt::format("RND R{}", 1 + pick(3));
      case 7:
        return fmt::format("CHF {}", 1 + pick(3));
      case 8:
        return fmt::format("L{} R{}{}", words("XY"), pick(2) == 0 ? "L" : "R", feed());
      case 9:
        return "L" + words("XY") + " R0";
      case 10:
        return fmt::format("CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X{}\nCYCL DEF 7.2 Y{}", number(), number());
      case 11:
        return fmt::format("Q{} = {}", 1 + pick(4), number());
      default:
        return fmt::format("L X+Q{} Y+Q{}", 1 + pick(4), 1 + pick(4));
    }
  }

  std::string open(const std::string& begin, const std::string& end) {
    ends_.push_back(end);
    return begin;
  }
  std::string close() {
    std::string out;
    for (auto end = ends_.rbegin(); end != ends_.rend(); ++end) out += *end + "\n";
    return out;
  }

  FuzzedDataProvider& bytes_;
  const nc::LanguageId language_;
  std::string text_;
  std::vector<std::string> ends_;
};

}  // namespace
}  // namespace camber::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace camber;
  FuzzedDataProvider bytes(data, size);
  std::array<std::uint8_t, 6> choice{};
  for (std::uint8_t& byte : choice) byte = bytes.ConsumeIntegral<std::uint8_t>();
  constexpr std::array kLanguages{nc::LanguageId::iso, nc::LanguageId::siemens, nc::LanguageId::heidenhain};
  const nc::LanguageId language = kLanguages[bytes.ConsumeIntegralInRange<std::size_t>(0, 2)];
  nc::InterpreterOptions options;
  options.max_repeated_blocks = fuzz::kMaxRepeatedBlocks;
  options.tool_offsets[1].radius_mm = 1.5;
  if (language != nc::LanguageId::iso)
    options.dialect =
        language == nc::LanguageId::siemens ? *nc::dialect_named("siemens") : *nc::dialect_named("heidenhain");
  fuzz::check_program(fuzz::Writer(bytes, language).program(), options, false, choice);
  return 0;
}
