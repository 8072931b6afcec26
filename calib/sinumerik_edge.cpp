// Channels from the recordings of a Sinumerik Edge (Capture4Analysis, Analyze MyWorkpiece /Capture4Analysis).
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "calib/column_map.h"

namespace camber::calib {
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
