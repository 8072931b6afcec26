// Tool libraries of Fusion: JSON, and .tools, a zip file with that JSON.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <zip.h>
#include <nlohmann/json.hpp>

#include "base/diagnostics.h"
#include "base/folders.h"
#include "base/units.h"
#include "machine/job_keys.h"
#include "machine/library_words.h"

namespace camber::machine {
namespace {

constexpr zip_uint64_t kMax_bytes = 64u << 20;

struct Close {
  void operator()(zip_t* z) const { zip_discard(z); }
  void operator()(zip_file_t* f) const { zip_fclose(f); }
};

/// The text of the first entry of the zip file `path` whose name ends with `ending`; messages about it name
/// "path/entry". Throws InputError [file-missing] and, with `check`: no zip file, no such entry, over 64 MB, damaged.
SourceText read_zip_entry(const std::string& path, const std::string& ending, const std::string& check) {
  require_confined(path);
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) fail_on_file(path, "no such file", "file-missing");
  int error = 0;
  const std::unique_ptr<zip_t, Close> zip(zip_open(path.c_str(), ZIP_RDONLY, &error));
  if (!zip) fail_on_file(path, fmt::format("is not a zip file; one with a {} file in it was expected", ending), check);
  const auto entries = static_cast<zip_uint64_t>(std::max<zip_int64_t>(zip_get_num_entries(zip.get(), 0), 0));
  zip_uint64_t index = 0;
  std::string name;
  for (; index < entries; ++index) {
    const char* at = zip_get_name(zip.get(), index, 0);
    name = at ? at : "";
    if (name.ends_with(ending)) break;
  }
  if (index == entries) fail_on_file(path, fmt::format("is a zip file without a {} file", ending), check);
  zip_stat_t stat;
  if (zip_stat_index(zip.get(), index, 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0 || stat.size > kMax_bytes)
    fail_on_file(path, fmt::format("contains {} of more than {} MB", name, kMax_bytes >> 20), check);
  const std::unique_ptr<zip_file_t, Close> file(zip_fopen_index(zip.get(), index, 0));
  std::string text(stat.size, '\0');
  if (!file || zip_fread(file.get(), text.data(), stat.size) != static_cast<zip_int64_t>(stat.size))
    fail_on_file(path, fmt::format("contains {}, which cannot be read: damaged, or under a password", name), check);
  return SourceText(path + "/" + name, std::move(text));
}

using nlohmann::json;

class FusionTool {
 public:
  FusionTool(const json& entry, const std::string& path, std::size_t index)
      : entry_(entry), path_(path), index_(index) {}

  ToolProposal read() const {
    if (!entry_.is_object()) fail("it is no table {...}");
    ToolProposal tool;
    tool.from = fmt::format("{}, tool {}", path_, index_);
    const std::string type = text(entry_, "type");
    tool.what = text(entry_, "description");
    if (tool.what.empty()) tool.what = type;
    if (type == "holder") {
      tool.kind = type;
      tool.holder = holder(entry_);
      return tool;
    }
    tool.number = number();
    const double unit = unit_mm(entry_);
    const json& g = part("geometry");
    set_fusion_cutter(tool, type,
                      {.diameter = size(g, "DC", unit),
                       .corner_radius = size(g, "RE", unit),
                       .flute_length = size(g, "LCF", unit),
                       .body_length = size(g, "LB", unit),
                       .overall_length = size(g, "OAL", unit),
                       .shank_diameter = size(g, "SFDM", unit),
                       .shoulder_diameter = size(g, "shoulder-diameter", unit),
                       .shoulder_length = size(g, "shoulder-length", unit),
                       .tip_diameter = size(g, "tip-diameter", unit),
                       .flutes = size(g, "NOF", 1),
                       .taper_deg = size(g, "TA", 1),
                       .point_deg = size(g, "SIG", 1)});
    tool.youngs_modulus_GPa = modulus_of_library_GPa(text(entry_, "BMC"));
    if (const auto at = entry_.find("holder"); at != entry_.end() && at->is_object()) tool.holder = holder(*at);
    return tool;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    fail_on_file(path_, fmt::format("tool {}: {}", index_, what), "tool-library");
  }

  const json& part(const char* key) const {
    static const json kNone = json::object();
    const auto at = entry_.find(key);
    return at != entry_.end() && at->is_object() ? *at : kNone;
  }

  std::string text(const json& object, const char* key) const {
    const auto at = object.find(key);
    return at != object.end() && at->is_string() ? at->get<std::string>() : std::string();
  }

  double unit_mm(const json& object) const {
    const std::string unit = text(object, "unit");
    if (unit == "inches") return kMmPerInch;
    if (unit != "millimeters" && !unit.empty())
      fail(fmt::format("unit is \"{}\"; \"millimeters\" or \"inches\" was expected", unit));
    return 1;
  }

  /// Zero where it is not given.
  double size(const json& object, const char* key, double unit) const {
    const auto at = object.find(key);
    if (at == object.end() || at->is_null()) return 0;
    if (!at->is_number()) fail(fmt::format("{} is {}; a number was expected", key, at->dump()));
    return at->get<double>() * unit;
  }

  std::optional<int> number() const {
    const json& post = part("post-process");
    const auto at = post.find("number");
    if (at == post.end() || at->is_null()) return std::nullopt;
    const double value = at->is_number() ? at->get<double>() : -1;
    if (!kToolNumber.holds(value)) fail(fmt::format("number is {}; a whole number was expected", at->dump()));
    return static_cast<int>(value);
  }

  std::vector<HolderPart> holder(const json& object) const {
    std::vector<HolderPart> out;
    const auto segments = object.find("segments");
    if (segments == object.end() || !segments->is_array()) return out;
    const double unit = unit_mm(object);
    for (const json& s : *segments) {
      if (!s.is_object()) fail("a segment of its holder is no table {...}");
      out.push_back({size(s, "lower-diameter", unit), size(s, "upper-diameter", unit), size(s, "height", unit)});
    }
    return out;
  }

  const json& entry_;
  const std::string& path_;
  std::size_t index_;
};

}  // namespace

std::vector<ToolProposal> read_fusion_library(const std::string& path) {
  const bool packed = std::filesystem::path(path).extension() == ".tools";
  const SourceText source = packed ? read_zip_entry(path, ".json", "tool-library") : SourceText::read(path);
  json library;
  try {
    library = json::parse(source.text());
  } catch (const json::parse_error& e) {
    const std::size_t at = e.byte > 0 ? std::min<std::size_t>(e.byte - 1, source.text().size()) : 0;
    throw InputError({source.diagnostic(Severity::error, at,
                                        "this is not JSON; a tool library of Fusion (File, Export, JSON) was expected",
                                        "tool-library")});
  }
  const auto data = library.is_object() ? library.find("data") : library.end();
  if (!library.is_object() || data == library.end() || !data->is_array())
    fail_on_file(path, "has no list \"data\"; a tool library of Fusion (File, Export, JSON) was expected",
                 "tool-library");
  std::vector<ToolProposal> out;
  for (std::size_t i = 0; i < data->size(); ++i) out.push_back(FusionTool((*data)[i], path, i + 1).read());
  return out;
}

}  // namespace camber::machine
