// Tool libraries of HSMWorks, Inventor CAM and older Fusion: .hsmlib, XML.
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/job_keys.h"
#include "machine/library_words.h"
#include "machine/tool_proposal.h"

namespace camber::machine {
namespace {

class HsmTool {
 public:
  HsmTool(const pugi::xml_node& node, const std::string& path, std::size_t index)
      : node_(node), path_(path), index_(index), unit_mm_(unit_mm()) {}

  ToolProposal read() const {
    ToolProposal tool;
    if (const auto number = value("nc", "number", 1)) {
      if (!kToolNumber.holds(*number))
        fail(fmt::format("nc number=\"{}\"; a whole number was expected", text("nc", "number")));
      tool.number = static_cast<int>(*number);
    }
    tool.from = fmt::format("{}, tool {}", path_, index_);
    const std::string type = node_.attribute("type").value();
    tool.what = node_.child("description").text().get();
    if (tool.what.empty()) tool.what = type;
    const bool drill = kind_of_fusion(type) == "drill";
    set_fusion_cutter(tool, type,
                      {.diameter = size("diameter", unit_mm_),
                       .corner_radius = size("corner-radius", unit_mm_),
                       .flute_length = size("flute-length", unit_mm_),
                       .body_length = size("body-length", unit_mm_),
                       .overall_length = size("overall-length", unit_mm_),
                       .shank_diameter = size("shaft-diameter", unit_mm_),
                       .shoulder_diameter = size("shoulder-diameter", unit_mm_),
                       .shoulder_length = size("shoulder-length", unit_mm_),
                       .tip_diameter = size("tip-diameter", unit_mm_),
                       .flutes = size("number-of-flutes", 1),
                       .taper_deg = drill ? 0 : size("taper-angle", 1),
                       .point_deg = drill ? size("taper-angle", 1) : 0});
    tool.youngs_modulus_GPa = modulus_of_library_GPa(text("material", "name"));
    read_holder(tool);
    return tool;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    fail_on_file(path_, fmt::format("tool {}: {}", index_, what), "tool-library");
  }

  double unit_mm() const {
    const std::string_view unit = node_.attribute("unit").value();
    if (unit == "millimeters") return 1;
    if (unit == "inches") return kMmPerInch;
    fail(fmt::format("unit=\"{}\"; millimeters or inches was expected", unit));
  }

  std::string text(const char* element, const char* attribute) const {
    return node_.child(element).attribute(attribute).value();
  }

  std::optional<double> value(const char* element, const char* attribute, double unit) const {
    const std::string word = text(element, attribute);
    if (word.empty()) return std::nullopt;
    const auto number = parse_number(word);
    if (!number) fail(fmt::format("{} {}=\"{}\"; a number was expected", element, attribute, word));
    return *number * unit;
  }

  /// Length of the body; zero where it is not given.
  double size(const char* attribute, double unit) const { return value("body", attribute, unit).value_or(0); }

  double number_of(const pugi::xml_node& node, const char* attribute) const {
    const std::string_view word = node.attribute(attribute).value();
    const auto number = parse_number(word);
    if (!number) fail(fmt::format("{} {}=\"{}\"; a number was expected", node.name(), attribute, word));
    return *number * unit_mm_;
  }

  /// Sections are points: length 0 begins a segment at its diameter, the next one ends it.
  void read_holder(ToolProposal& tool) const {
    double diameter = 0;
    for (const pugi::xml_node& section : node_.child("holder").children("section")) {
      const double length = number_of(section, "length"), next = number_of(section, "diameter");
      if (length > 0) tool.holder.push_back({diameter, next, length});
      diameter = next;
    }
  }

  const pugi::xml_node& node_;
  const std::string& path_;
  std::size_t index_;
  double unit_mm_;
};

}  // namespace

std::vector<ToolProposal> read_hsm_library(const std::string& path) {
  const SourceText source = SourceText::read(path);
  pugi::xml_document document;  // tells UTF-16, which these files are, from UTF-8
  const auto result = document.load_buffer(source.text().data(), source.text().size());
  const std::string_view root = document.document_element().name();
  if (!result || (root != "tool-library" && root != "tool-table"))
    fail_on_file(path,
                 fmt::format("{}; a tool library of HSMWorks (XML with tool-library) was expected",
                             result ? fmt::format("its root is <{}>", root)
                                    : fmt::format("this is not XML ({})", result.description())),
                 "tool-library");
  std::vector<ToolProposal> out;
  std::size_t index = 0;
  for (const pugi::xml_node& node : document.document_element().children("tool"))
    out.push_back(HsmTool(node, path, ++index).read());
  return out;
}

}  // namespace camber::machine
