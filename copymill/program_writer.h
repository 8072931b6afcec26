#pragma once
// Copy milling as an NC program.
#include <cstddef>
#include <optional>
#include <string>

#include "base/geometry.h"
#include "copymill/path_piece.h"
#include "machine/copy_operations.h"
#include "nc/dialect.h"

namespace camber::copymill {

/// Writes G0, G1, G2 and G3 in the XY plane with absolute places and incremental centres; words that stay as they are
/// are left out.
class ProgramWriter {
 public:
  ProgramWriter(const nc::Dialect& dialect, int decimals);

  void begin(const machine::CopyOperation& operation, const machine::Tool& tool, double safe_z_mm);
  void rapid(const Vec3& to);
  void cut(const PathPiece& piece, double feed_mm_per_s);
  /// The rest of the program. The text is complete.
  std::string finish();
  std::size_t blocks() const { return blocks_; }

 private:
  std::string word(char letter, double value) const;
  std::string places(const Vec3& to);
  void line(const std::string& text);

  int decimals_;
  std::string text_;
  std::string motion_, feed_;
  std::optional<Vec3> at_;
  std::size_t blocks_ = 0;
  bool begun_ = false;
};

}  // namespace camber::copymill
