// Measured values from QIF 2 results.
#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/measured_table.h"

namespace camber::machine {
namespace {

/// The name without its name-space prefix.
std::string_view local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

pugi::xml_node child_of(const pugi::xml_node& node, std::string_view name) {
  for (const pugi::xml_node& c : node.children())
    if (local_name(c) == name) return c;
  return {};
}

std::string text_of(const pugi::xml_node& node, std::string_view name) { return child_of(node, name).text().get(); }

/// All nodes below whose name ends so, in the order of the file.
template <class Visit>
void each_below(const pugi::xml_node& root, std::string_view end, const Visit& visit) {
  for (pugi::xml_node n = root.first_child(); n;) {
    if (local_name(n).ends_with(end)) visit(n);
    pugi::xml_node next = n.first_child();
    while (!next && n != root) {
      next = n.next_sibling();
      if (!next) n = n.parent();
    }
    n = next;
  }
}

/// "DiameterCharacteristicActual" is a Diameter.
std::string kind_of(const pugi::xml_node& actual) {
  const std::string_view name = local_name(actual);
  return std::string(name.substr(0, name.find("Characteristic")));
}

/// Characteristics that are a size or a place: no angles, no counts.
bool is_length(std::string_view kind) {
  return kind.find("Angle") == std::string_view::npos && kind.find("UserDefined") == std::string_view::npos &&
         kind.find("Surface") == std::string_view::npos && kind.find("Thread") == std::string_view::npos;
}

class QifFile {
 public:
  explicit QifFile(const std::string& path) : path_(path) {
    const SourceText source = SourceText::read(path);
    const std::string& text = source.text();
    const auto parsed = document_.load_buffer(text.data(), text.size());
    if (!parsed)
      throw InputError({source.diagnostic(
          Severity::error, static_cast<std::size_t>(parsed.offset),
          fmt::format("not well-formed XML ({}); QIF results were expected", parsed.description()), "qif-results")});
    root_ = document_.document_element();
    if (local_name(root_) != "QIFDocument")
      fail(fmt::format("begins with <{}>; a <QIFDocument> was expected", root_.name()));
    index();
  }

  std::vector<MeasuredValue> values() const {
    std::vector<MeasuredValue> out;
    bool results = false;
    each_below(root_, "MeasurementResults", [&](const pugi::xml_node& run) {
      results = true;
      const std::string serial = serial_of(run);
      each_below(run, "CharacteristicActual", [&](const pugi::xml_node& actual) {
        if (auto value = value_of(actual)) {
          value->part = serial;
          out.push_back(std::move(*value));
        }
      });
    });
    if (!results) fail("has no <MeasurementResults>; the results of a measurement were expected");
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { fail_on_file(path_, what, "qif-results"); }

  void index() {
    each_below(root_, "", [&](const pugi::xml_node& node) {
      if (const auto id = node.attribute("id")) by_id_[id.value()] = node;
    });
    each_below(root_, "PrimaryUnits", [&](const pugi::xml_node& units) {  // OtherUnits are of single values
      std::string name = text_of(child_of(units, "LinearUnit"), "UnitName");
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
      if (name.find("inch") != std::string::npos) mm_per_unit_ = kMmPerInch;
    });
  }

  pugi::xml_node referred(const pugi::xml_node& from, std::string_view key, const char* what) const {
    const std::string id = text_of(from, key);
    const auto at = by_id_.find(id);
    if (at == by_id_.end())
      fail(fmt::format("<{} id=\"{}\"> names the {} \"{}\", which is not there", from.name(),
                       from.attribute("id").value(), what, id));
    return at->second;
  }

  std::string serial_of(const pugi::xml_node& run) const {
    const auto at = by_id_.find(text_of(child_of(run, "ActualComponentIds"), "Id"));
    return at == by_id_.end() ? std::string() : text_of(at->second, "SerialNumber");
  }

  std::optional<double> number(const pugi::xml_node& node, std::string_view key) const {
    const std::string text = text_of(node, key);
    if (text.empty()) return std::nullopt;
    const auto value = parse_number(text);
    if (!value)
      fail(fmt::format("<{} id=\"{}\"> has {} = \"{}\"; a number was expected", node.name(),
                       node.attribute("id").value(), key, text));
    return *value * mm_per_unit_;
  }

  std::optional<MeasuredValue> value_of(const pugi::xml_node& actual) const {
    const std::string kind = kind_of(actual);
    const auto measured = is_length(kind) ? number(actual, "Value") : std::nullopt;
    if (!measured) return std::nullopt;
    const pugi::xml_node item = referred(actual, "CharacteristicItemId", "item"),
                         nominal = referred(item, "CharacteristicNominalId", "nominal"),
                         definition = referred(nominal, "CharacteristicDefinitionId", "definition");
    MeasuredValue out{.feature = text_of(item, "Name"), .part = {}, .date = {}, .value_mm = *measured};
    if (out.feature.empty()) out.feature = text_of(definition, "Name");
    out.kind = kind;
    out.status = text_of(child_of(actual, "Status"), "CharacteristicStatusEnum");
    out.nominal_mm = number(nominal, "TargetValue");
    read_limits(child_of(definition, "Tolerance"), out);
    return out;
  }

  /// Limits, or deviations from the nominal unless DefinedAsLimit is true.
  void read_limits(const pugi::xml_node& tolerance, MeasuredValue& out) const {
    const std::string as_limit = text_of(tolerance, "DefinedAsLimit");
    const bool absolute = as_limit == "true" || as_limit == "1";
    const double from = absolute ? 0 : out.nominal_mm.value_or(0);
    if (!absolute && !out.nominal_mm) return;
    if (const auto v = number(tolerance, "MinValue")) out.lower_mm = from + *v;
    if (const auto v = number(tolerance, "MaxValue")) out.upper_mm = from + *v;
  }

  std::string path_;
  pugi::xml_document document_;
  pugi::xml_node root_;
  std::map<std::string, pugi::xml_node> by_id_;
  double mm_per_unit_ = 1;
};

}  // namespace

std::vector<MeasuredValue> read_qif(const std::string& path) { return QifFile(path).values(); }

}  // namespace camber::machine
