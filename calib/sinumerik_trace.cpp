// Channels from the trace XML of Sinumerik controls.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
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

namespace {

using nlohmann::json;

class EdgeReader {
 public:
  explicit EdgeReader(const SourceText& source) : source_(source) {}

  std::vector<Channel> run() {
    json document;
    try {
      document = json::parse(source_.text());
    } catch (const json::parse_error& e) {
      const std::size_t last = source_.text().empty() ? 0 : source_.text().size() - 1;
      throw InputError({source_.diagnostic(Severity::error, std::min(e.byte > 0 ? e.byte - 1 : 0, last),
                                           "the JSON cannot be read from here on; a Sinumerik Edge recording was "
                                           "expected",
                                           kCheck)});
    } catch (const json::exception&) {
      fail("the JSON has a number out of range; a Sinumerik Edge recording was expected");
    }
    read_header(member(document, "Header", "the recording"));
    const json& payload = member(document, "Payload", "the recording");
    if (!payload.is_array()) fail("Payload is no list of messages");
    std::size_t number = 0;
    for (const json& message : payload) {
      ++number;
      if (message.is_object() && message.contains("HFData")) read_rows(message["HFData"], number);
    }
    return std::move(channels_);
  }

 private:
  static constexpr const char* kCheck = "sinumerik-edge";

  [[noreturn]] void fail(const std::string& message) const { fail_on_file(source_.name(), message, kCheck); }

  const json& member(const json& object, const char* name, const char* of) const {
    if (!object.is_object() || !object.contains(name))
      fail(fmt::format("{} has no {}; a Sinumerik Edge recording (Header, Payload) was expected", of, name));
    return object[name];
  }

  void read_header(const json& header) {
    const json& cycle = member(header, "CycleTimeMs", "Header");
    if (!cycle.is_number() || cycle.get<double>() <= 0) fail("CycleTimeMs is no number above 0");
    cycle_s_ = cycle.get<double>() / 1000;
    const json& signals = member(header, "SignalListHFData", "Header");
    if (!signals.is_array() || signals.empty()) fail("SignalListHFData names no signal");
    for (const json& signal : signals) {
      Channel channel;
      for (const char* key : {"Name", "Address"})
        if (signal.is_object() && signal.contains(key) && signal[key].is_string())
          channel.names.push_back(signal[key].get<std::string>());
      if (channel.names.empty()) fail(fmt::format("signal {} has no name", channels_.size() + 1));
      channels_.push_back(std::move(channel));
    }
    if (channels_.front().names.front() != "CYCLE") fail("the first signal is not CYCLE, the counter of the samples");
  }

  /// The counter says when: rows may be missing. A row that repeats a counter is left out.
  void read_rows(const json& rows, std::size_t message) {
    if (!rows.is_array()) fail(fmt::format("message {}: HFData is no list of rows", message));
    for (const json& row : rows) {
      if (!row.is_array() || row.size() != channels_.size())
        fail(fmt::format("message {}: a row of HFData has {} numbers; the header names {} signals", message, row.size(),
                         channels_.size()));
      if (!row[0].is_number()) fail(fmt::format("message {}: CYCLE of a row is no number", message));
      const auto counter = row[0].get<double>();
      if (!first_) first_ = counter;
      const double t_s = (counter - *first_) * cycle_s_;
      for (std::size_t i = 0; i < channels_.size(); ++i) {
        Channel& c = channels_[i];
        if (!row[i].is_number() || (!c.t_s.empty() && t_s <= c.t_s.back())) continue;
        c.t_s.push_back(t_s);
        c.value.push_back(row[i].get<double>());
      }
    }
  }

  const SourceText& source_;
  std::vector<Channel> channels_;
  std::optional<double> first_;
  double cycle_s_ = 0;
};

}  // namespace

std::vector<Channel> read_edge_channels(const SourceText& source) { return EdgeReader(source).run(); }

}  // namespace camber::calib
