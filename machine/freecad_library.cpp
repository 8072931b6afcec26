// Tool bits and libraries of FreeCAD: .fctb and .fctl, JSON.
#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "machine/job_keys.h"
#include "machine/library_words.h"
#include "machine/quantity.h"

namespace camber::machine {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct JsonFile {
  SourceText source;
  json root;
};

[[noreturn]] void fail_at(const SourceText& source, std::size_t offset, std::string message) {
  throw InputError({source.diagnostic(Severity::error, offset, std::move(message), "tool-library")});
}

JsonFile read_json(const std::string& path, const char* wanted) {
  JsonFile out{SourceText::read(path), {}};
  try {
    out.root = json::parse(out.source.text());
  } catch (const json::parse_error& e) {
    const std::size_t at = e.byte > 0 ? std::min<std::size_t>(e.byte - 1, out.source.text().size()) : 0;
    fail_at(out.source, at, fmt::format("this is not JSON; {} was expected", wanted));
  }
  if (!out.root.is_object()) fail_at(out.source, 0, fmt::format("this is no table {{...}}; {} was expected", wanted));
  return out;
}

/// Where "text" stands in the file; its beginning where it does not.
std::size_t place_of(const SourceText& source, const std::string& text, std::size_t from = 0) {
  const std::size_t at = source.text().find(json(text).dump(), from);
  return at == std::string::npos ? 0 : at;
}

struct Shape {
  std::string_view word, kind;
};
// Names of shapes and of their files, in lower case without marks; 0.20, 1.x and better-tool-library.
constexpr std::array kShapes{
    Shape{"endmill", "flat"},
    Shape{"ballend", "ball"},
    Shape{"bullnose", "bull"},
    Shape{"torus", "bull"},
    Shape{"taperedballnose", "tapered ball"},
    Shape{"taperedball", "tapered ball"},
    Shape{"drill", "drill"},
    Shape{"chamfer", "chamfer"},
    Shape{"vbit", "vbit"},
    Shape{"threadmill", "thread mill"},
    Shape{"tap", "tap"},
    Shape{"reamer", "reamer"},
    Shape{"dovetail", "dovetail"},
    Shape{"slittingsaw", "slitting saw"},
    Shape{"probe", "probe"},
    Shape{"radius", "corner rounding mill"},
    Shape{"fillet", "corner rounding mill"},
};

std::string letters(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)))
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

class Bit {
 public:
  Bit(const JsonFile& file) : file_(file), parameters_(table("parameter")), attributes_(table("attribute")) {}

  ToolProposal read() const {
    ToolProposal tool;
    tool.from = file_.source.name();
    tool.what = text(file_.root, "name");
    tool.kind = kind();
    if (tool.what.empty()) tool.what = tool.kind;
    set_type_by_kind(tool);
    tool.diameter_mm = length("Diameter");
    tool.overall_length_mm = length("Length");
    tool.shank_diameter_mm = first({"ShankDiameter", "ShaftDiameter"});
    tool.neck_diameter_mm = length("NeckDiameter");
    tool.flute_length_mm = tool.kind == "vbit" ? std::nullopt  // its CuttingEdgeHeight is the band above the cone
                           : tool.kind == "slitting saw"
                               ? length("BladeThickness")
                               : first({"CuttingEdgeHeight", "CuttingEdgeLength", "DovetailHeight"});
    if (const auto flutes = number("Flutes", length_mm_of); flutes && *flutes >= 1)
      tool.flutes = static_cast<int>(std::min(*flutes, 1e6));
    if (tool.kind == "bull") read_corner(tool);
    if (tool.kind == "drill") tool.point_angle_deg = number("TipAngle", angle_deg_of);
    if (is_conical(tool.kind)) {
      tool.tip_diameter_mm = length("TipDiameter");
      tool.point_angle_deg = number("CuttingEdgeAngle", angle_deg_of);
    }
    if (tool.kind == "tapered ball")
      if (const auto full = number("TaperAngle", angle_deg_of)) tool.taper_deg = *full / 2;
    tool.overhang_mm = value(attributes_, "btl-stickout", length_mm_of);
    tool.youngs_modulus_GPa = modulus_of_library_GPa(text(parameters_, "Material"));
    check_cone(tool);
    return tool;
  }

 private:
  const json& table(const char* key) const {
    static const json kNone = json::object();
    const auto at = file_.root.find(key);
    if (at == file_.root.end()) return kNone;
    if (!at->is_object())
      fail_at(file_.source, place_of(file_.source, key), fmt::format("{} is no table {{...}}", key));
    return *at;
  }

  static std::string text(const json& object, const char* key) {
    const auto at = object.find(key);
    return at != object.end() && at->is_string() ? at->get<std::string>() : std::string();
  }

  /// Returns the kind of the bit by the file of its shape; where that name says nothing, by shape-type.
  std::string kind() const {
    const std::string file = text(file_.root, "shape"), type = text(file_.root, "shape-type");
    for (const std::string& word : {letters(fs::path(file).stem().string()), letters(type)}) {
      const auto* at = std::ranges::find(kShapes, std::string_view(word), &Shape::word);
      if (at != kShapes.end()) return std::string(at->kind);
    }
    if (file.empty() && type.empty()) fail_at(file_.source, 0, "no shape; a tool bit of FreeCAD (.fctb) was expected");
    return file.empty() ? type : fs::path(file).stem().string();
  }

  template <class Read>
  std::optional<double> value(const json& table, const char* key, Read read) const {
    const auto at = table.find(key);
    if (at == table.end() || at->is_null()) return std::nullopt;
    const auto number = at->is_number()   ? std::optional(at->get<double>())
                        : at->is_string() ? read(at->get<std::string>())
                                          : std::nullopt;
    if (!number)
      fail_at(file_.source, place_of(file_.source, key),
              fmt::format("{} is {}; a number with a unit was expected, as in \"5.0 mm\"", key, at->dump()));
    return *number > 0 ? number : std::nullopt;
  }
  template <class Read>
  std::optional<double> number(const char* key, Read read) const {
    return value(parameters_, key, read);
  }
  std::optional<double> length(const char* key) const { return number(key, length_mm_of); }
  std::optional<double> first(std::initializer_list<const char*> keys) const {
    for (const char* key : keys)
      if (const auto at = length(key)) return at;
    return std::nullopt;
  }

  /// CornerRadius (1.x) and TorusRadius are the corner's; FlatRadius (0.20) is that of the flat bottom.
  void read_corner(ToolProposal& tool) const {
    tool.corner_radius_mm = first({"CornerRadius", "TorusRadius"});
    const auto flat = length("FlatRadius");
    if (!tool.corner_radius_mm && flat && tool.diameter_mm && *tool.diameter_mm / 2 > *flat)
      tool.corner_radius_mm = *tool.diameter_mm / 2 - *flat;
  }

  const JsonFile& file_;
  const json& parameters_;
  const json& attributes_;
};

/// The file of a bit that a library names; empty where there is none.
std::string bit_path(const fs::path& library, const std::string& name) {
  const fs::path folder = library.parent_path();
  for (const fs::path& at : {folder / name, folder / "Bit" / name, folder.parent_path() / "Bit" / name}) {
    std::error_code ec;
    if (fs::is_regular_file(at, ec)) return at.lexically_normal().string();
  }
  return {};
}

}  // namespace

ToolProposal read_freecad_bit(const std::string& path) {
  const JsonFile file = read_json(path, "a tool bit of FreeCAD (.fctb)");
  return Bit(file).read();
}

std::vector<ToolProposal> read_freecad_library(const std::string& path, Diagnostics& diagnostics) {
  constexpr const char* kWanted = "a tool library of FreeCAD (.fctl)";
  const JsonFile file = read_json(path, kWanted);
  const auto tools = file.root.find("tools");
  if (tools == file.root.end() || !tools->is_array())
    fail_at(file.source, 0, fmt::format("no list \"tools\"; {} was expected", kWanted));
  std::vector<ToolProposal> out;
  std::size_t at = place_of(file.source, "tools");
  for (const json& entry : *tools) {
    const auto nr = entry.is_object() ? entry.find("nr") : entry.end();
    const auto name = entry.is_object() ? entry.find("path") : entry.end();
    if (!entry.is_object() || nr == entry.end() || !nr->is_number() || !kToolNumber.holds(nr->get<double>()) ||
        name == entry.end() || !name->is_string())
      fail_at(file.source, at,
              fmt::format("{} among the tools; {{\"nr\": 1, \"path\": \"a.fctb\"}} was expected", entry.dump()));
    const std::string bit = bit_path(path, *name);
    at = place_of(file.source, *name, at);
    if (bit.empty()) {
      diagnostics.add(file.source.diagnostic(
          Severity::warning, at,
          fmt::format("T{}: no file {} beside the library or in the folder Bit; the tool is left out", nr->dump(),
                      name->get<std::string>()),
          "file-missing"));
      continue;
    }
    out.push_back(read_freecad_bit(bit));
    out.back().number = nr->get<int>();
  }
  return out;
}

}  // namespace camber::machine
