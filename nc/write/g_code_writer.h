#pragma once
// What programs in G code have in common: G0 to G3 that hold until the next, arc centres from the start.
#include <string>

#include "nc/write/program_writer.h"

namespace camber::nc {

class GCodeWriter : public ProgramWriter {
 protected:
  using ProgramWriter::ProgramWriter;

  void write_rapid(const std::string& words) override { put(with_code("G0", words)); }
  void write_line(const std::string& words, double feed) override { put(with_code("G1", words) + feed_word(feed)); }
  void write_arc(const Arc& arc, double feed) override;
  void write_spindle_stop() override;
  /// A motion code is in force that put() has written.
  void set_motion(const char* code) { motion_ = code; }

 private:
  std::string with_code(const std::string& code, const std::string& words);

  std::string motion_;
  Plane plane_ = Plane::xy;
};

}  // namespace camber::nc
