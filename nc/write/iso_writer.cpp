// Programs in G code.
#include <fmt/format.h>

#include "nc/write/g_code_writer.h"

namespace camber::nc {
namespace {

class IsoWriter : public GCodeWriter {
 public:
  IsoWriter(const Dialect& dialect, WriterFormat format) : GCodeWriter(dialect, std::move(format)) {}

  void dwell(double seconds) override {
    put(dialect().dwell_p_is_ms ? fmt::format("G4 P{:.0f}", 1000 * seconds) : fmt::format("G4 P{:g}", seconds));
  }
  void stop_exactly() override { put("G61"); }

 private:
  void write_head() override {
    put("%");
    if (dialect().has_program_number)
      put(fmt::format("O0001 ({})", format().title));
    else
      put(fmt::format("({})", format().title));
    const auto tolerance = dialect().g64_p_is_tolerance ? format().corner_tolerance_mm : std::nullopt;
    put("G21 G17 G90 G94 G40 G49 G80" + (tolerance ? fmt::format(" G64 P{:g}", *tolerance) : std::string()));
  }

  void write_tool(const WrittenTool& tool) override {
    put(fmt::format("T{} M6 ({})", tool.number, tool.comment));
    put(fmt::format("G54 S{:.0f} M3", tool.spindle_rpm));
    put(fmt::format("G43 H{} G0 {}", tool.number, coordinate('Z', tool.safe_z_mm)));
    if (format().coolant) put("M8");
    set_motion("G0");
  }

  void write_end() override {
    put(std::string(dialect().program_end));
    put("%");
  }

  bool whole_numbers_have_points() const override { return true; }
};

}  // namespace

std::unique_ptr<ProgramWriter> iso_writer(const Dialect& dialect, WriterFormat format) {
  return std::make_unique<IsoWriter>(dialect, std::move(format));
}

}  // namespace camber::nc
