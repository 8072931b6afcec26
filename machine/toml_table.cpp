#include "machine/toml_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace camber::machine {
namespace {

std::string shown(double value) {
  return std::isnan(value) ? "nan" : std::isinf(value) ? (value > 0 ? "inf" : "-inf") : fmt::format("{}", value);
}

std::string_view kind_name(TomlNode::Kind kind) {
  switch (kind) {
    case TomlNode::Kind::table:
      return "a table";
    case TomlNode::Kind::array:
      return "an array";
    case TomlNode::Kind::text:
      return "a text";
    case TomlNode::Kind::number:
      return "a number";
    case TomlNode::Kind::boolean:
      return "true or false";
    case TomlNode::Kind::other:
      break;
  }
  return "a date or time";
}

/// Levenshtein distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t swap = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({swap, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string listed(std::span<const std::string_view> words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += fmt::format("{}\"{}\"", i == 0 ? "" : i + 1 == words.size() ? " or " : ", ", words[i]);
  return out;
}

}  // namespace

bool NumberRange::holds(double value) const {
  if (std::isnan(value)) return false;
  if (std::isinf(value) && !infinity_allowed) return false;
  if (above_min ? value <= min : value < min) return false;
  return value <= max && (!whole || value == std::floor(value));
}

std::string NumberRange::wanted() const {
  const std::string noun = whole ? "a whole number" : "a number";
  const auto name = [](double v) { return v == 0 ? std::string("zero") : shown(v); };
  const std::string or_inf = infinity_allowed && std::isinf(max) ? " or inf" : "";
  if (std::isinf(min) && std::isinf(max)) return noun + or_inf;
  if (std::isinf(min)) return fmt::format("{} of at most {}", noun, name(max));
  if (std::isinf(max))
    return (above_min ? fmt::format("{} greater than {}", noun, name(min))
                      : fmt::format("{} of {} or more", noun, name(min))) +
           or_inf;
  if (above_min) return fmt::format("{} greater than {} and at most {}", noun, name(min), name(max));
  return fmt::format("{} from {} to {}", noun, shown(min), shown(max));
}

std::vector<std::string> nearest_words(std::string_view word, std::vector<std::string> known, std::size_t count) {
  std::ranges::stable_sort(known, {}, [&](const std::string& candidate) { return edit_distance(word, candidate); });
  known.resize(std::min(known.size(), count));
  return known;
}

std::string nearest_word(std::string_view word, std::span<const std::string> known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const auto& candidate : known) {
    std::size_t distance = edit_distance(word, candidate);
    // A unit that was left off, or another unit: the shorter is the beginning of the longer.
    if (candidate.starts_with(word) || word.starts_with(candidate)) distance = std::min<std::size_t>(distance, 1);
    // The same first word: voxels for voxel_mm.
    const std::string_view stem = std::string_view(candidate).substr(0, candidate.find('_'));
    if (stem.size() > 3 && word.starts_with(stem)) distance = std::min<std::size_t>(distance, 2);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

TomlTable::TomlTable(const TomlNode& node, std::string name, Diagnostics& diagnostics)
    : node_(&node), name_(std::move(name)), diagnostics_(&diagnostics) {}

TomlTable TomlTable::top(const TomlFile& file, Diagnostics& diagnostics) { return {file.root, "", diagnostics}; }

void TomlTable::fall_back_on(const TomlNode& node, std::string name) {
  fallback_ = &node;
  fallback_name_ = std::move(name);
}

std::string TomlTable::where() const { return name_.empty() ? "" : " in [" + name_ + "]"; }

const TomlNode::Entry* TomlTable::find(std::string_view key) const {
  for (const TomlNode* node : {node_, fallback_})
    if (node)
      for (const auto& entry : node->entries)
        if (entry.key == key) return &entry;
  return nullptr;
}

std::optional<TomlNode::Kind> TomlTable::kind_of(std::string_view key) const {
  const auto* entry = find(key);
  return entry ? std::optional(entry->value.kind) : std::nullopt;
}

const TomlNode* TomlTable::use(std::string_view key) {
  known_.emplace(key);
  const auto* entry = find(key);
  return entry ? &entry->value : nullptr;
}

void TomlTable::report(Severity severity, const TomlNode& file, std::size_t offset, std::string message,
                       std::string check) {
  diagnostics_->add(file.source->diagnostic(severity, offset, std::move(message), std::move(check)));
}

void TomlTable::report(Severity severity, const TomlNode& at, std::string message, std::string check) {
  report(severity, at, at.offset, std::move(message), std::move(check));
}

Diagnostic TomlTable::place_of(std::string_view key) const {
  const auto* entry = find(key);
  const TomlNode& at = entry ? entry->value : *node_;
  return at.source->diagnostic(Severity::error, at.offset, {}, {});
}

void TomlTable::error_at(std::string_view key, std::string message, std::string check) {
  const auto* entry = find(key);
  report(Severity::error, entry ? entry->value : *node_, std::move(message), std::move(check));
}

void TomlTable::warning_at(std::string_view key, std::string message, std::string check) {
  const auto* entry = find(key);
  report(Severity::warning, entry ? entry->value : *node_, std::move(message), std::move(check));
}

void TomlTable::error_at_name(std::string_view key, std::string message, std::string check) {
  const auto* entry = find(key);
  if (entry)
    report(Severity::error, entry->value, entry->key_offset, std::move(message), std::move(check));
  else
    report(Severity::error, *node_, std::move(message), std::move(check));
}

void TomlTable::missing(std::string_view key, std::string_view wanted) {
  const std::string message = fmt::format("{} is missing{}; {} was expected", key, where(), wanted);
  if (name_.empty())  // the top of the file has no place of its own
    diagnostics_->add({Severity::error, {node_->source->name(), 0, 0}, message, "key-missing", {}});
  else
    report(Severity::error, *node_, message, "key-missing");
}

void TomlTable::wrong_type(std::string_view key, const TomlNode& value, std::string_view wanted) {
  report(Severity::error, value, fmt::format("{} is {}; {} was expected", key, kind_name(value.kind), wanted),
         "value-type");
}

bool TomlTable::number_ok(const std::string& key, const TomlNode& value, const NumberRange& range,
                          std::string_view wanted) {
  if (value.kind != TomlNode::Kind::number) {
    wrong_type(key, value, wanted);
    return false;
  }
  if (range.holds(value.number)) return true;
  report(Severity::error, value, fmt::format("{} is {}; {} was expected", key, shown(value.number), wanted),
         "value-range");
  return false;
}

std::optional<double> TomlTable::optional_number(std::string_view key, const NumberRange& range) {
  const auto* value = use(key);
  if (!value || !number_ok(std::string(key), *value, range, range.wanted())) return std::nullopt;
  return value->number;
}

double TomlTable::number(std::string_view key, const NumberRange& range, double fallback) {
  return optional_number(key, range).value_or(fallback);
}

double TomlTable::required_number(std::string_view key, const NumberRange& range) {
  if (!use(key)) missing(key, range.wanted());
  return optional_number(key, range).value_or(0);
}

std::string TomlTable::text(std::string_view key, std::string fallback) {
  const auto* value = use(key);
  if (!value) return fallback;
  if (value->kind == TomlNode::Kind::text && !value->text.empty()) return value->text;
  if (value->kind == TomlNode::Kind::text)
    report(Severity::error, *value, fmt::format("{} is empty; a text was expected", key), "value-range");
  else
    wrong_type(key, *value, "a text in quotes");
  return fallback;
}

std::string TomlTable::required_text(std::string_view key) {
  if (!use(key)) missing(key, "a text in quotes");
  return text(key, "");
}

bool TomlTable::boolean(std::string_view key, bool fallback) {
  const auto* value = use(key);
  if (!value) return fallback;
  if (value->kind == TomlNode::Kind::boolean) return value->boolean;
  wrong_type(key, *value, "true or false");
  return fallback;
}

std::size_t TomlTable::choice(std::string_view key, std::span<const std::string_view> words, std::size_t fallback) {
  const auto* value = use(key);
  if (!value) return fallback;
  if (value->kind != TomlNode::Kind::text) {
    wrong_type(key, *value, listed(words));
    return fallback;
  }
  const auto at = std::find(words.begin(), words.end(), value->text);
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  report(Severity::error, *value, fmt::format("{} is \"{}\"; {} was expected", key, value->text, listed(words)),
         "value-choice");
  return fallback;
}

std::optional<std::size_t> TomlTable::required_choice(std::string_view key, std::span<const std::string_view> words) {
  if (!use(key)) {
    missing(key, listed(words));
    return std::nullopt;
  }
  const std::size_t at = choice(key, words, words.size());
  return at < words.size() ? std::optional(at) : std::nullopt;
}

bool TomlTable::is_list(std::string_view key) const {
  const auto* entry = find(key);
  return entry && entry->value.kind == TomlNode::Kind::array;
}

std::optional<std::vector<double>> TomlTable::number_list(std::string_view key, const NumberRange& range,
                                                          std::string_view wanted) {
  const auto* value = use(key);
  if (!value) return std::nullopt;
  if (value->kind != TomlNode::Kind::array) {
    wrong_type(key, *value, wanted);
    return std::nullopt;
  }
  std::vector<double> out;
  for (std::size_t i = 0; i < value->items.size(); ++i) {
    if (!number_ok(fmt::format("{}[{}]", key, i), value->items[i], range, range.wanted())) return std::nullopt;
    out.push_back(value->items[i].number);
  }
  return out;
}

std::optional<std::vector<std::string>> TomlTable::text_list(std::string_view key, std::string_view wanted) {
  const auto* value = use(key);
  if (!value) return std::nullopt;
  const auto is_text = [](const TomlNode& item) { return item.kind == TomlNode::Kind::text; };
  if (value->kind != TomlNode::Kind::array || !std::ranges::all_of(value->items, is_text)) {
    report(Severity::error, *value, fmt::format("{}: {} was expected", key, wanted), "value-type");
    return std::nullopt;
  }
  std::vector<std::string> out;
  for (const TomlNode& item : value->items) out.push_back(item.text);
  return out;
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key, std::size_t count, const NumberRange& range,
                                                      std::string_view wanted) {
  auto out = number_list(key, range, wanted);
  if (!out || out->size() == count) return out;
  error_at(key, fmt::format("{} has {} numbers; {} was expected", key, out->size(), wanted), "value-count");
  return std::nullopt;
}

std::optional<std::vector<std::vector<double>>> TomlTable::number_rows(std::string_view key, std::size_t rows,
                                                                       std::size_t columns, const NumberRange& range,
                                                                       std::string_view wanted) {
  const auto* value = use(key);
  if (!value) return std::nullopt;
  const auto is_row = [&](const TomlNode& item) {
    return item.kind == TomlNode::Kind::array && item.items.size() == columns;
  };
  if (value->kind != TomlNode::Kind::array || (rows > 0 && value->items.size() != rows) ||
      !std::all_of(value->items.begin(), value->items.end(), is_row)) {
    report(Severity::error, *value, fmt::format("{}: {} was expected", key, wanted), "value-count");
    return std::nullopt;
  }
  std::vector<std::vector<double>> out;
  for (std::size_t i = 0; i < value->items.size(); ++i) {
    out.emplace_back();
    for (std::size_t j = 0; j < columns; ++j) {
      const TomlNode& item = value->items[i].items[j];
      if (!number_ok(fmt::format("{}[{}][{}]", key, i, j), item, range, range.wanted())) return std::nullopt;
      out.back().push_back(item.number);
    }
  }
  return out;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const auto* value = use(key);
  if (!value) return std::nullopt;
  const std::string name = name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
  if (value->kind != TomlNode::Kind::table) {
    wrong_type(key, *value, fmt::format("a table [{}]", name));
    return std::nullopt;
  }
  return TomlTable(*value, name, *diagnostics_);
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  std::vector<TomlTable> out;
  const auto* value = use(key);
  if (!value) return out;
  const std::string name = fmt::format("[{}]", key);
  const auto is_table = [](const TomlNode& item) { return item.kind == TomlNode::Kind::table; };
  if (value->kind != TomlNode::Kind::array || !std::ranges::all_of(value->items, is_table)) {
    wrong_type(key, *value, fmt::format("a list of tables [{}]", name));
    return out;
  }
  for (const TomlNode& item : value->items) out.emplace_back(TomlTable(item, name, *diagnostics_));
  return out;
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> out;
  for (const auto& entry : node_->entries) out.push_back(entry.key);
  return out;
}

void TomlTable::refuse_unknown(const TomlNode& node, const std::string& where) {
  const std::vector<std::string> known(known_.begin(), known_.end());
  for (const auto& entry : node.entries) {
    if (known_.contains(entry.key)) continue;
    const std::string near = nearest_word(entry.key, known);
    const std::string hint = near.empty() ? "" : fmt::format("; did you mean {}?", near);
    report(Severity::error, entry.value, entry.key_offset, fmt::format("unknown key {}{}{}", entry.key, where, hint),
           "key-unknown");
  }
}

void TomlTable::finish() {
  refuse_unknown(*node_, where());
  if (fallback_) refuse_unknown(*fallback_, fmt::format(" in [{}]", fallback_name_));
}

}  // namespace camber::machine
