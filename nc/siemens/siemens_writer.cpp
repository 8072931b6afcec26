// Programs for Sinumerik controls.
#include <fmt/format.h>

#include "nc/siemens/siemens_language.h"
#include "nc/write/g_code_writer.h"

namespace camber::nc::siemens {
namespace {

class SiemensWriter : public GCodeWriter {
 public:
  SiemensWriter(const Dialect& dialect, WriterFormat format) : GCodeWriter(dialect, std::move(format)) {}

  void dwell(double seconds) override { put(fmt::format("G4 F{:g}", seconds)); }
  void stop_exactly() override { put("G60"); }

 private:
  void write_head() override {
    put(fmt::format("%_N_{}_MPF", program_name(format().title)));
    put(";$PATH=/_N_MPF_DIR");
    put("G17 G71 G90 G94 G40");
  }

  void write_tool(const WrittenTool& tool) override {
    put(fmt::format("T{} ; {}", tool.number, tool.comment));
    put("M6 D1");
    put(fmt::format("G54 S{:.0f} M3", tool.spindle_rpm));
    put("G0 " + coordinate('Z', tool.safe_z_mm));
    if (format().coolant) put("M8");
    set_motion("G0");
  }

  void write_end() override { put(std::string(dialect().program_end)); }
};

}  // namespace

std::unique_ptr<ProgramWriter> writer(const Dialect& dialect, WriterFormat format) {
  return std::make_unique<SiemensWriter>(dialect, std::move(format));
}

}  // namespace camber::nc::siemens
