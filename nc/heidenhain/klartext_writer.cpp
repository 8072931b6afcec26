// Programs in Klartext.
#include <cassert>

#include <fmt/format.h>

#include "nc/heidenhain/heidenhain_language.h"
#include "nc/write/program_writer.h"

namespace camber::nc::heidenhain {
namespace {

class KlartextWriter : public ProgramWriter {
 public:
  KlartextWriter(const Dialect& dialect, WriterFormat format) : ProgramWriter(dialect, std::move(format)) {}

  void dwell(double seconds) override {
    put("CYCL DEF 9.0 DWELL TIME");
    put(fmt::format("CYCL DEF 9.1 DWELL {:g}", seconds));
  }
  /// No word of the language asks for it.
  void stop_exactly() override {}

 private:
  void write_head() override { put(fmt::format("BEGIN PGM {} MM", program_name(format().title))); }

  void write_tool(const WrittenTool& tool) override {
    put(fmt::format("TOOL CALL {} Z S{:.0f} ; {}", tool.number, tool.spindle_rpm, tool.comment));
    put(fmt::format("L {} R0 FMAX M3", coordinate('Z', tool.safe_z_mm)));
    if (format().coolant) put("M8");
  }

  void write_spindle_stop() override {
    if (format().coolant) put("M9");
    put("M5");
  }

  void write_end() override {
    put(std::string(dialect().program_end));
    put(fmt::format("END PGM {} MM", program_name(format().title)));
  }

  /// FMAX holds for its block alone.
  void write_rapid(const std::string& words) override { put("L " + words + " FMAX"); }
  void write_line(const std::string& words, double feed) override { put("L " + words + feed_word(feed)); }

  void write_arc(const Arc& arc, double feed) override {
    const PlaneAxes axes = axes_of(arc.plane);
    assert(arc.from[axes.normal] == arc.to[axes.normal]);
    const char first = "XYZ"[axes.first], second = "XYZ"[axes.second];
    put(fmt::format("CC {} {}", coordinate(first, arc.centre.x()), coordinate(second, arc.centre.y())));
    put(fmt::format("C {} {} DR{}{}", coordinate(first, arc.to[axes.first]), coordinate(second, arc.to[axes.second]),
                    arc.counter_clockwise ? '+' : '-', feed_word(feed)));
  }

  std::string coordinate(char letter, double value) const override {
    const std::string text = number(value, format().decimals);
    return letter + (text.front() == '-' ? text : "+" + text);
  }
};

}  // namespace

std::unique_ptr<ProgramWriter> writer(const Dialect& dialect, WriterFormat format) {
  return std::make_unique<KlartextWriter>(dialect, std::move(format));
}

}  // namespace camber::nc::heidenhain
