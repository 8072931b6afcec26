#include "ui/folder.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace camber::ui {
namespace {

constexpr std::string_view kAssumed = "assumed", kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(kBlanks);
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(kBlanks) - from + 1);
}

bool is_key(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-' || c == '.' || c == '"';
  });
}

/// Brackets that are open and where a comment begins, quotation marks observed.
struct Scan {
  int open = 0;
  std::size_t comment = std::string_view::npos;
};
Scan scan(std::string_view text) {
  Scan out;
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote) {
      if (c == '\\' && quote == '"') ++i;
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++out.open;
    } else if (c == ']' || c == '}') {
      --out.open;
    } else if (c == '#') {
      out.comment = i;
      break;
    }
  }
  return out;
}

/// "key = value # comment".
struct Setting {
  std::string key, value, comment;
  int open = 0;
};
std::optional<Setting> setting_of(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos || !is_key(trimmed(line.substr(0, equals)))) return std::nullopt;
  const std::string_view rest = line.substr(equals + 1);
  const Scan found = scan(rest);
  Setting out;
  out.key = trimmed(line.substr(0, equals));
  out.value = trimmed(rest.substr(0, found.comment));
  if (found.comment != std::string_view::npos) out.comment = trimmed(rest.substr(found.comment + 1));
  out.open = found.open;
  return out;
}

/// "[tool.3]" is tool.3, "[[copy]]" copy[].
std::optional<std::string> table_of(std::string_view line) {
  line = trimmed(line.substr(0, scan(line).comment));
  if (!line.starts_with('[') || !line.ends_with(']')) return std::nullopt;
  if (line.starts_with("[[")) return std::string(trimmed(line.substr(2, line.size() - 4))) + "[]";
  return std::string(trimmed(line.substr(1, line.size() - 2)));
}

bool says_guess(std::string_view comment) {
  return comment.find("CHECK") != std::string_view::npos || comment.find("typical") != std::string_view::npos;
}

/// A comment line above a setting that begins with CHECK.
bool has_check(std::string_view note) {
  return note.starts_with("CHECK") || note.find("\nCHECK") != std::string_view::npos;
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    out.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

/// A setting's place in the text: lines [first, last].
struct Place {
  JobField field;
  std::size_t first = 0, last = 0;
};

class Reader {
 public:
  explicit Reader(const std::vector<std::string>& lines) : lines_(lines) {
    for (at_ = 0; at_ < lines_.size(); ++at_) take(trimmed(lines_[at_]));
    for (Place& p : places_) p.field.guessed |= is_assumed(p.field);
  }

  std::vector<Place> places_;
  std::vector<std::pair<std::string, std::size_t>> tables_{{"", 0}};  ///< with the line after their last setting
  std::vector<Place> assumed_;                                        ///< the lists

 private:
  void take(std::string_view line) {
    if (const auto table = table_of(line)) {
      tables_.emplace_back(*table, at_ + 1);
      note_.clear();
    } else if (line.starts_with('#')) {
      take_comment(trimmed(line.substr(1)));
    } else if (auto setting = setting_of(line)) {
      add(std::move(*setting), false);
    }
  }

  void take_comment(std::string_view text) {
    auto setting = setting_of(text);
    // A sentence with an equals sign is no default.
    if (setting && setting->open == 0 && setting->key.find('.') == std::string::npos && !setting->value.empty())
      return add(std::move(*setting), true);
    note_ += (note_.empty() ? "" : "\n") + std::string(text);
  }

  void add(Setting setting, bool is_default) {
    Place place{{}, at_, at_};
    while (!is_default && setting.open > 0 && at_ + 1 < lines_.size()) {
      const std::string& next = lines_[++at_];
      const Scan found = scan(next);
      setting.value += "\n" + std::string(trimmed(std::string_view(next).substr(0, found.comment)));
      setting.open += found.open;
    }
    place.last = at_;
    JobField& field = place.field;
    field = {tables_.back().first, setting.key, setting.value, setting.comment, note_, place.first + 1, is_default};
    field.guessed = !is_default && (says_guess(setting.comment) || has_check(note_));
    note_.clear();
    if (!is_default) tables_.back().second = at_ + 1;
    (setting.key == kAssumed && !is_default ? assumed_ : places_).push_back(std::move(place));
  }

  bool is_assumed(const JobField& field) const {
    if (field.is_default) return false;
    return std::ranges::any_of(assumed_, [&](const Place& list) {
      return list.field.table == field.table && std::ranges::count(texts_of(list.field.value), field.key) > 0;
    });
  }

  const std::vector<std::string>& lines_;
  std::size_t at_ = 0;
  std::string note_;
};

std::string line_text(const std::string& key, const std::string& value, const std::string& comment) {
  constexpr std::size_t kColumn = 34;  // where camber init begins comments
  std::string out = key + " = " + value;
  if (comment.empty()) return out;
  return out + std::string(out.size() < kColumn ? kColumn - out.size() : 1, ' ') + "# " + comment;
}

void replace_lines(std::vector<std::string>& lines, const Place& place, std::vector<std::string> by) {
  const auto from = lines.begin() + static_cast<std::ptrdiff_t>(place.first);
  lines.erase(from, lines.begin() + static_cast<std::ptrdiff_t>(place.last + 1));
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(place.first), by.begin(), by.end());
}

void take_out_of_assumed(std::vector<std::string>& lines, const JobEdit& edit) {
  for (const Place& list : Reader(lines).assumed_) {
    if (list.field.table != edit.table) continue;
    std::vector<std::string> keys = texts_of(list.field.value);
    if (std::erase(keys, edit.key) == 0) continue;
    std::vector<std::string> by;
    if (!keys.empty())
      by.push_back(
          line_text(std::string(kAssumed), fmt::format("[\"{}\"]", fmt::join(keys, "\", \"")), list.field.comment));
    return replace_lines(lines, list, by);
  }
}

void add_line(std::vector<std::string>& lines, const JobEdit& edit) {
  const Reader reader(lines);
  const auto table = std::ranges::find(reader.tables_, edit.table, [](const auto& t) { return t.first; });
  std::string line = line_text(edit.key, edit.value, "");
  if (table != reader.tables_.end()) {
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(table->second), line);
    return;
  }
  lines.insert(lines.end(), {"", "[" + edit.table + "]", line});
}

void apply(std::vector<std::string>& lines, const JobEdit& edit) {
  const Reader reader(lines);
  const auto found = std::ranges::find_if(
      reader.places_, [&](const Place& p) { return p.field.table == edit.table && p.field.key == edit.key; });
  const bool there = found != reader.places_.end();
  if (edit.kind == JobEdit::Kind::set && !there) {
    add_line(lines, edit);
  } else if (there && edit.kind == JobEdit::Kind::remove) {
    replace_lines(lines, *found, {});
  } else if (there) {
    const JobField& field = found->field;
    const std::string value = edit.kind == JobEdit::Kind::set ? edit.value : field.value;
    const std::string comment = says_guess(field.comment) ? "" : field.comment;
    if (edit.kind == JobEdit::Kind::set || !field.is_default)
      replace_lines(lines, *found, {line_text(field.key, value, comment)});
  }
  take_out_of_assumed(lines, edit);
}

/// "CHECK: no file names it." above a setting that somebody has given.
void drop_checks_above(std::vector<std::string>& lines, const JobEdit& edit) {
  const Reader reader(lines);
  const auto found = std::ranges::find_if(
      reader.places_, [&](const Place& p) { return p.field.table == edit.table && p.field.key == edit.key; });
  if (found == reader.places_.end()) return;
  for (std::size_t i = found->first; i-- > 0 && lines[i].starts_with("#");)
    if (lines[i].starts_with("# CHECK")) lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i));
}

}  // namespace

std::vector<JobField> job_fields(std::string_view text) {
  const std::vector<std::string> lines = lines_of(text);
  std::vector<JobField> out;
  for (Place& place : Reader(lines).places_) out.push_back(std::move(place.field));
  return out;
}

std::string with_edits(std::string text, std::span<const JobEdit> edits) {
  std::vector<std::string> lines = lines_of(text);
  for (const JobEdit& edit : edits) {
    apply(lines, edit);
    drop_checks_above(lines, edit);
  }
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

std::vector<std::string> texts_of(std::string_view value) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const char quote = value[i];
    if (quote != '"' && quote != '\'') continue;
    std::string text;
    for (++i; i < value.size() && value[i] != quote; ++i) {
      if (value[i] == '\\' && quote == '"' && i + 1 < value.size()) ++i;
      text += value[i];
    }
    out.push_back(std::move(text));
  }
  return out;
}

std::string field_text(std::span<const JobField> fields, std::string_view table, std::string_view key) {
  for (const JobField& f : fields) {
    if (f.table != table || f.key != key || f.is_default) continue;
    const std::vector<std::string> texts = texts_of(f.value);
    return texts.empty() ? f.value : texts.front();
  }
  return {};
}

}  // namespace camber::ui
