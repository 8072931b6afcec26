#pragma once
// Words with a comma at the end of a block: ,R rounds and ,C chamfers its corner with the next one; ,A gives its angle
// (Mover). Internal to nc/.
#include <cstddef>
#include <string>

#include "nc/radius_codes.h"
#include "nc/whole_numbers.h"

namespace camber::nc {

class CornerWords {
 public:
  CornerWords(BlockContext& at, const ModalGroups& modal, RadiusCodes& radius, WholeNumbers& whole_numbers)
      : at_(at), modal_(modal), radius_(radius), whole_numbers_(whole_numbers) {}

  void finish_corner(std::size_t moves_before);
  void read_corner_words(std::size_t moves_before);
  void finish();

 private:
  /// ,R or ,C of a block that has moved, until the next one does.
  struct Corner {
    bool waits = false;
    bool chamfer = false;
    double size_mm = 0;    ///< radius; of a chamfer the distance from the corner
    std::size_t move = 0;  ///< index into Interpretation::moves
    std::size_t offset = 0;
    std::string text;  ///< text of the word, for messages
  };
  void put_corner(const Corner& corner, std::size_t before, std::size_t after);
  void corner_error(std::size_t offset, std::string message);

  BlockContext& at_;
  const ModalGroups& modal_;
  RadiusCodes& radius_;
  WholeNumbers& whole_numbers_;
  Corner corner_;
};

}  // namespace camber::nc
