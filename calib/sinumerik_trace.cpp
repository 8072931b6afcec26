// Channels from the trace XML of Sinumerik controls.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <map>
#include <pugixml.hpp>

#include "base/numbers.h"
#include "calib/column_map.h"

namespace camber::calib {
namespace {

/// Traces of both generations have one traceData somewhere below the root.
pugi::xml_node trace_data(const pugi::xml_node& root) {
  return root.find_node([](const pugi::xml_node& n) { return std::strcmp(n.name(), "traceData") == 0; });
}

std::size_t offset_of(const pugi::xml_node& node) {
  return node.offset_debug() < 0 ? 0 : static_cast<std::size_t>(node.offset_debug());
}

class FrameReader {
 public:
  explicit FrameReader(const SourceText& source) : source_(source) {}

  void read(const pugi::xml_node& frame) {
    std::map<std::string, std::size_t> by_id;
    for (const pugi::xml_node& header : frame.children("frameHeader"))
      for (const pugi::xml_node& signal : header.children("dataSignal")) add_signal(signal, by_id);
    for (const pugi::xml_node& signal : frame.children("dataSignal")) add_signal(signal, by_id);
    for (const pugi::xml_node& rec : frame.children("rec")) add_row(rec, by_id);
  }

  std::vector<Channel> channels;

 private:
  [[noreturn]] void fail(const pugi::xml_node& node, std::string message) const {
    throw InputError({source_.diagnostic(Severity::error, offset_of(node), std::move(message), "sinumerik-xml")});
  }

  /// Frames of one trace go on with the channels of the frames before.
  void add_signal(const pugi::xml_node& signal, std::map<std::string, std::size_t>& by_id) {
    const std::string id = signal.attribute("id").value(), name = signal.attribute("name").value();
    if (id.empty()) fail(signal, "dataSignal has no id");
    std::size_t at = 0;
    while (at < channels.size() && channels[at].names.front() != name) ++at;
    if (at == channels.size()) {
      channels.push_back({.names = {name}, .t_s = {}, .value = {}});
      for (const char* other : {"key", "description"})
        if (const auto text = signal.attribute(other)) channels.back().names.emplace_back(text.value());
    }
    by_id[id] = at;
  }

  void add_row(const pugi::xml_node& rec, const std::map<std::string, std::size_t>& by_id) {
    const auto time = parse_number(rec.attribute("time").value());
    if (!time) fail(rec, fmt::format("rec has time \"{}\"; seconds were expected", rec.attribute("time").value()));
    for (const pugi::xml_attribute& a : rec.attributes()) {
      const auto signal = by_id.find(a.name());
      const auto value = parse_number(a.value());
      if (signal == by_id.end() || !value) continue;
      Channel& c = channels[signal->second];
      if (!c.t_s.empty() && *time <= c.t_s.back())
        fail(rec, fmt::format("time {} s is not after the sample before it, {} s", *time, c.t_s.back()));
      c.t_s.push_back(*time);
      c.value.push_back(*value);
    }
  }

  const SourceText& source_;
};

}  // namespace

std::vector<Channel> read_sinumerik_channels(const SourceText& source) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed =
      document.load_buffer(source.text().data(), source.text().size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed)
    throw InputError({source.diagnostic(Severity::error,
                                        std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset)),
                                                 source.text().empty() ? 0 : source.text().size() - 1),
                                        fmt::format("the XML cannot be read from here on: {}", parsed.description()),
                                        "sinumerik-xml")});
  const pugi::xml_node data = trace_data(document);
  if (!data)
    fail_on_file(source.name(), "the XML has no traceData; a Sinumerik trace (traceDisplaySetup) was expected",
                 "sinumerik-xml");
  FrameReader reader(source);
  for (const pugi::xml_node& frame : data.children("dataFrame")) reader.read(frame);
  if (reader.channels.empty()) fail_on_file(source.name(), "traceData has no dataSignal", "sinumerik-xml");
  return std::move(reader.channels);
}

}  // namespace camber::calib
