#pragma once
// Numbers without a decimal point, which some controls count in least increments. Internal to nc/.
#include <cstddef>
#include <string>

#include "nc/frame_codes.h"

namespace camber::nc {

/// Doubts about the options that a run raises.
struct RunVerdict {
  /// Arcs fit with absolute centres only, none with relative ones only, and no word says which they are.
  bool centres_look_absolute = false;
  /// Not empty: how numbers without a decimal point count is not known, no coordinate has a point, and read as
  /// millimetres or inches they are larger than any machine.
  std::string increments_warning{};
  std::size_t increments_offset = 0;
};

class WholeNumbers {
 public:
  WholeNumbers(BlockContext& at, const ModalGroups& modal, const FrameCodes& frames)
      : at_(at), modal_(modal), frames_(frames) {}

  /// Scales the words of the block.
  void scale_block();
  /// Factor on the value of a number without a decimal point. 1: as it stands.
  double scale_of(const Word& word);
  void warn();
  void add_verdict(RunVerdict& out) const;

 private:
  /// Words whose reading depends on the setting for numbers without a decimal point, where it is not known.
  struct Noted {
    const Program* file = nullptr;  ///< file of the first one; null: there is none
    std::size_t offset = 0;
    std::string text;
    double scale = 1;
    std::size_t more = 0;
    bool any_point = false;  ///< a coordinate of the program has a point
    double largest_mm = 0;   ///< coordinate without one
    double value = 0;        ///< as written
    bool inch = false, is_time = false, is_angle = false;
    std::string read_with(double factor) const;
  };
  double unit_of(char letter, bool& is_angle) const;
  std::string setting() const;

  BlockContext& at_;
  const ModalGroups& modal_;
  const FrameCodes& frames_;
  Noted noted_;
};

}  // namespace camber::nc
