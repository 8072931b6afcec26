#include "nc/write/g_code_writer.h"

#include <algorithm>

namespace camber::nc {

void GCodeWriter::write_arc(const Arc& arc, double feed) {
  if (arc.plane != plane_) put(arc.plane == Plane::xy ? "G17" : arc.plane == Plane::zx ? "G18" : "G19");
  plane_ = arc.plane;
  const PlaneAxes axes = axes_of(arc.plane);
  std::string words = arc.words;
  // In the order of the letters: I K in the plane of Z and X.
  for (const int a : {std::min(axes.first, axes.second), std::max(axes.first, axes.second)}) {
    const double centre = a == axes.first ? arc.centre.x() : arc.centre.y();
    words += (words.empty() ? "" : " ") + coordinate("IJK"[a], centre - arc.from[a]);
  }
  put(with_code(arc.counter_clockwise ? "G3" : "G2", words) + feed_word(feed));
}

void GCodeWriter::write_spindle_stop() {
  if (format().coolant) put("M9");
  put("M5");
}

std::string GCodeWriter::with_code(const std::string& code, const std::string& words) {
  const bool known = code == motion_;
  motion_ = code;
  return known ? words : code + " " + words;
}

}  // namespace camber::nc
