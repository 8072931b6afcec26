// Tool libraries of HSMWorks, Inventor CAM and older Fusion: .hsmlib, XML.
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/library_words.h"
#include "machine/tool_proposal.h"

namespace camber::machine {
namespace {

class HsmTool {
 public:
  HsmTool(const pugi::xml_node& node, const std::string& path, std::size_t index)
      : node_(node), path_(path), index_(index), unit_mm_(unit_mm()) {}

  /// Nothing for a tool without a number in the machine.
  std::optional<ToolProposal> read() const {
    const auto number = value("nc", "number", 1);
    if (!number) return std::nullopt;
    if (*number < 0 || *number > 1e6 || *number != std::floor(*number))
      fail(fmt::format("nc number=\"{}\"; a whole number was expected", text("nc", "number")));
    ToolProposal tool;
    tool.number = static_cast<int>(*number);
    tool.from = fmt::format("{}, tool {}", path_, index_);
    const std::string type = node_.attribute("type").value();
    tool.what = node_.child("description").text().get();
    if (tool.what.empty()) tool.what = type;
    tool.type = type_of_library(type);
    tool.diameter_mm = size("diameter", unit_mm_);
    if (tool.type == ToolType::bull) tool.corner_radius_mm = size("corner-radius", unit_mm_);
    tool.flute_length_mm = size("flute-length", unit_mm_);
    tool.overhang_mm = size("body-length", unit_mm_);
    tool.shank_diameter_mm = size("shaft-diameter", unit_mm_);
    if (const auto flutes = size("number-of-flutes", 1)) tool.flutes = static_cast<int>(std::lround(*flutes));
    tool.youngs_modulus_GPa = modulus_of_library_GPa(text("material", "name"));
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

  /// Of the body; nothing where it is zero, as the library writes what does not apply.
  std::optional<double> size(const char* attribute, double unit) const {
    const auto number = value("body", attribute, unit);
    return number && *number > 0 ? number : std::nullopt;
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
    if (auto tool = HsmTool(node, path, ++index).read()) out.push_back(std::move(*tool));
  return out;
}

}  // namespace camber::machine
