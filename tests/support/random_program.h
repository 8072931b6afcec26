#pragma once
// Random NC programs in the language that Fanuc-like controls and LinuxCNC share, for RapidCheck. What is random are
// lists of plain numbers, which RapidCheck can shrink; a writer that knows where the tool stands makes valid text of
// any of them.
#include <rapidcheck.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/geometry.h"

namespace camber::tests {

/// The same programs in every run, unless RC_PARAMS says otherwise. RapidCheck reads it when the first property runs.
inline const int kFixedSeed = setenv("RC_PARAMS", "seed=20260101 max_success=500", 0);

/// One block, or the few that belong together (a drilling cycle). What the numbers mean depends on the kind.
struct RandomBlock {
  int kind = 0;
  std::array<int, 5> n{};  ///< -10000 .. 10000
  int flags = 0;           ///< 0 .. 255
};

struct RandomProgram {
  std::vector<RandomBlock> blocks;
  int style = 0;  ///< bits: see ProgramWriter
  bool inch = false;
};

inline std::ostream& operator<<(std::ostream& out, const RandomBlock& b) {
  return out << fmt::format("{{{}, {{{}, {}, {}, {}, {}}}, {}}}", b.kind, b.n[0], b.n[1], b.n[2], b.n[3], b.n[4],
                            b.flags);
}

/// Features that a writer leaves out because the other reader does not share them.
struct ProgramOptions {
  bool block_skip = true;
  bool ends_in_blocks = true;  ///< M1 M5 M9 G9 in blocks with moves
  bool cycles_in_all_planes = true;
  bool dwells = true;
};

class ProgramWriter {
 public:
  static constexpr int kKinds = 20;

  ProgramWriter(const RandomProgram& program, const ProgramOptions& options)
      : program_(program), options_(options), inch_(program.inch) {}

  std::string run() {
    if (style(kTape)) out_ += "%" + line_end();
    block({inch_ ? "G20" : "G21", "G17", "G40", "G49", "G80", "G90", "G94"});
    block({"F100", "S1000", "M3"});
    block({"G0", "X0", "Y0", "Z20"});
    at_ = {0, 0, 20};
    for (const RandomBlock& b : program_.blocks) add(b);
    block({"M2"});
    if (style(kTape)) out_ += "%" + line_end();
    return out_;
  }

 private:
  enum Style { kCrlf = 1, kLowerCase = 2, kNoBlanks = 4, kNumbers = 8, kTape = 16, kPlain = 32, kNoLeadingZero = 64 };
  using Words = std::vector<std::string>;

  bool style(Style s) const { return (program_.style & s) != 0; }
  std::string line_end() const { return style(kCrlf) ? "\r\n" : "\n"; }
  int first() const { return plane_ == 17 ? 0 : plane_ == 18 ? 2 : 1; }
  int second() const { return plane_ == 17 ? 1 : plane_ == 18 ? 0 : 2; }
  int normal() const { return plane_ == 17 ? 2 : plane_ == 18 ? 1 : 0; }

  void block(Words words, const std::string& before = "", const std::string& comment = "") {
    if (style(kNumbers)) words.insert(words.begin(), fmt::format("N{}", number_ += 10));
    std::string line = before;
    for (std::size_t i = 0; i < words.size(); ++i) line += (i > 0 && !style(kNoBlanks) ? " " : "") + words[i];
    if (style(kLowerCase))
      for (char& c : line) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    out_ += line + comment + line_end();
  }

  /// 12.5000 as 12.5, 3.0000 as 3. or 3, 0.5 as .5: as the style has it.
  std::string word(char letter, double value) const {
    std::string text = fmt::format("{:.{}f}", value, decimals());
    while (text.back() == '0') text.pop_back();
    if (text == "-0.") text = "0.";
    if (text.back() == '.' && style(kPlain)) text.pop_back();
    if (style(kNoLeadingZero) && text.starts_with("0.") && text.size() > 2) text.erase(0, 1);
    if (style(kNoLeadingZero) && text.starts_with("-0.")) text.erase(1, 1);
    return letter + text;
  }

  int decimals() const { return inch_ ? 5 : 4; }
  double round(double value) const {
    const double scale = std::pow(10.0, decimals());
    return std::round(value * scale) / scale;
  }
  /// A number of the block as a length: up to 10 mm, or a twentieth of that in inches, with three and four decimals.
  double length(int n) const { return inch_ ? round(n / 2e4) : n / 1000.0; }

  /// Words that take the tool from where it stands to `wanted` in the named axes; moves it there.
  Words go(const Vec3& wanted, const std::array<bool, 3>& named) {
    Words words;
    for (int axis = 0; axis < 3; ++axis) {
      if (!named[static_cast<std::size_t>(axis)]) continue;
      const double value = round(incremental_ ? wanted[axis] - at_[axis] : wanted[axis]);
      words.push_back(word("XYZ"[axis], value));
      at_[axis] = incremental_ ? at_[axis] + value : value;
    }
    return words;
  }

  static Words joined(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }

  Vec3 point(const RandomBlock& b) const { return {length(b.n[0]), length(b.n[1]), length(b.n[2])}; }

  static std::array<bool, 3> axes_of(int flags) {
    const int which = flags % 8 == 0 ? 7 : flags % 8;
    return {(which & 1) != 0, (which & 2) != 0, (which & 4) != 0};
  }

  void motion(const std::string& code, const RandomBlock& b, Words rest = {}, const std::string& before = "") {
    Words words;
    if (motion_ != code || b.flags & 64) words.push_back(code);
    motion_ = code;
    words = joined(words, go(point(b), axes_of(b.flags)));
    const bool comment = b.flags & 32;
    block(joined(words, rest), before, comment ? " (C " + std::to_string(b.flags) + ")" : "");
  }

  /// Centre and sweep are random; the end is what the decimals leave of it.
  void arc(const RandomBlock& b, double sweep_rad, bool by_radius, bool rises, int turns) {
    const double smallest = length(1000);
    double i = length(b.n[0]), j = length(b.n[1]);
    if (std::hypot(i, j) < smallest) i += 2 * smallest;
    const bool clockwise = b.flags & 1;
    const double turn = clockwise ? -sweep_rad : sweep_rad;
    const bool full = sweep_rad >= 2 * kPi;
    Vec3 end = at_;
    if (!full) {
      end[first()] += i - i * std::cos(turn) + j * std::sin(turn);
      end[second()] += j - i * std::sin(turn) - j * std::cos(turn);
    }
    if (rises) end[normal()] += length(b.n[2]);
    std::array<bool, 3> named{};
    named[static_cast<std::size_t>(first())] = named[static_cast<std::size_t>(second())] = !full || b.flags & 2;
    named[static_cast<std::size_t>(normal())] = rises;
    // A full turn that names its end must name it exactly: only where the text can say where the tool stands.
    if (full && !incremental_) named[0] = named[1] = named[2] = false;
    if (full && !incremental_ && rises) named[static_cast<std::size_t>(normal())] = true;
    motion_ = clockwise ? "G2" : "G3";
    Words words{motion_};
    words = joined(words, go(end, named));
    if (by_radius) {
      words.push_back(word('R', (sweep_rad > kPi ? -1 : 1) * std::hypot(i, j)));
    } else {
      words.push_back(word("IJK"[first()], i));
      words.push_back(word("IJK"[second()], j));
    }
    if (turns > 1) words.push_back(fmt::format("P{}", turns));
    block(words);
  }

  /// Away from none, half and full turns, which rounding could turn into each other.
  double sweep(const RandomBlock& b, double from, double to) const {
    return from + (to - from) * (b.n[3] + 10000) / 20000.0;
  }

  void cycle(const RandomBlock& b) {
    if (plane_ != 17 && !options_.cycles_in_all_planes) return;
    static constexpr std::array kCycles = {81, 82, 83, 73};
    const int g = kCycles[static_cast<std::size_t>(b.flags) % kCycles.size()];
    if (incremental_) block({"G90"});
    incremental_ = false;
    const char letter = "XYZ"[normal()];
    const double height = round(at_[normal()] + length(1000));
    const double retract = round(height - length(std::abs(b.n[3]) + 100));
    const double bottom = round(retract - length(std::abs(b.n[4]) + 100));
    go_to_height(height);
    Words words{b.flags & 8 ? "G98" : "G99", fmt::format("G{}", g)};
    std::array<bool, 3> both{true, true, true};
    both[static_cast<std::size_t>(normal())] = false;
    words = joined(words, go(point(b), both));
    words.push_back(word(letter, bottom));
    words.push_back(word('R', retract));
    if (g == 82) words.push_back("P0.5");
    if (g == 83 || g == 73) words.push_back(word('Q', round(length(3000 + std::abs(b.n[4]) / 3))));
    block(words);
    if (b.flags & 16) block(go(Vec3(point(b) + Vec3::Constant(length(2000))), both));
    block({"G80"});
    at_[normal()] = b.flags & 8 ? height : retract;
    motion_.clear();
    go_to_height(height);
  }

  /// In rapid, in absolute words.
  void go_to_height(double height) {
    Vec3 up = at_;
    up[normal()] = height;
    std::array<bool, 3> only{};
    only[static_cast<std::size_t>(normal())] = true;
    motion_ = "G0";
    block(joined({"G0"}, go(up, only)));
  }

  void set_unit(bool inch) {
    if (inch != inch_) at_ *= inch ? 1 / 25.4 : 25.4;
    inch_ = inch;
    block({inch ? "G20" : "G21", "F100"});
  }

  void add(const RandomBlock& b) {
    switch (b.kind) {
      case 0:
        return motion("G0", b);
      case 1:
      case 2:
        return motion("G1", b);
      case 3:
        return motion(motion_ == "G0" ? "G0" : "G1", b);  // often without its G word
      case 4:
        return arc(b, sweep(b, 0.1, 6.1), false, false, 1);
      case 5:
        return arc(b, sweep(b, 0.3, 2.9), true, false, 1);
      case 6:
        return arc(b, sweep(b, 3.4, 5.9), true, b.flags & 4, 1);
      case 7:
        return arc(b, sweep(b, 0.1, 6.1), false, true, 1);
      case 8:
        return arc(b, 2 * kPi, false, b.flags & 4, 1);
      case 9:
        return arc(b, b.flags & 8 ? 2 * kPi : sweep(b, 0.1, 6.1), false, b.flags & 4, 2 + b.flags % 3);
      case 10:
        plane_ = 17 + b.flags % 3;
        return block({fmt::format("G{}", plane_)});
      case 11:
        incremental_ = b.flags & 1;
        return block({incremental_ ? "G91" : "G90"});
      case 12:
        return set_unit(b.flags & 1);
      case 13:
        return block({}, "", fmt::format("(NOTE {})", b.flags));
      case 14:
        return cycle(b);
      case 15:
        return block({b.flags & 1 ? "M8" : "M9"});
      case 16:
        return motion("G1", b, {fmt::format("F{}", 50 + b.flags)});
      case 17:
        return options_.block_skip ? motion("G1", b, {}, "/") : motion("G1", b);
      case 18:
        if (!options_.dwells) return;
        return block({"G4", "P0.5"});
      default:
        break;
    }
    if (!options_.ends_in_blocks) return motion("G1", b);
    static const std::array<std::string, 4> kEnds = {"M9", "M5", "M1", "G9"};
    motion("G1", b, {kEnds[static_cast<std::size_t>(b.flags) % 4]});
    if (b.flags % 4 == 1) block({"M3"});
  }

  const RandomProgram& program_;
  const ProgramOptions options_;
  bool inch_;
  std::string out_;
  Vec3 at_ = Vec3::Zero();  ///< in the program's unit
  std::string motion_;
  bool incremental_ = false;
  int plane_ = 17;
  int number_ = 0;
};

inline std::string text_of(const RandomProgram& program, const ProgramOptions& options = {}) {
  return ProgramWriter(program, options).run();
}

inline std::ostream& operator<<(std::ostream& out, const RandomProgram& program) {
  return out << "\n" << text_of(program);
}

inline rc::Gen<RandomBlock> random_block() {
  return rc::gen::build<RandomBlock>(
      rc::gen::set(&RandomBlock::kind, rc::gen::inRange(0, ProgramWriter::kKinds)),
      rc::gen::set(&RandomBlock::n,
                   rc::gen::container<std::array<int, 5>>(rc::gen::noShrink(rc::gen::inRange(-10000, 10001)))),
      rc::gen::set(&RandomBlock::flags, rc::gen::inRange(0, 256)));
}

/// A program of up to so many blocks.
inline rc::Gen<RandomProgram> random_program(int blocks) {
  // The numbers at RapidCheck's full size from the first program on: smaller sizes draw the first few kinds only.
  const auto full = [](auto gen) { return rc::gen::resize(rc::kNominalSize, std::move(gen)); };
  return rc::gen::build<RandomProgram>(
      rc::gen::set(&RandomProgram::blocks,
                   rc::gen::resize(blocks, rc::gen::container<std::vector<RandomBlock>>(full(random_block())))),
      rc::gen::set(&RandomProgram::style, full(rc::gen::inRange(0, 128))),
      rc::gen::set(&RandomProgram::inch, rc::gen::element(false, true)));
}

}  // namespace camber::tests
