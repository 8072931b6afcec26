#pragma once
// A typed, checking reader of TOML tables. Every problem becomes a diagnostic at its key or value.
//
// A table is read key by key; finish() then names the keys that nobody asked for. The readers below return
// the fallback where a key is missing or its value is wrong, so that reading goes on and finds the next problem.
#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostics.h"
#include "machine/number_range.h"

namespace camber::machine {

/// One value of a file, with its place. The file must outlive it.
struct TomlNode {
  enum class Kind { table, array, text, number, boolean, other };
  struct Entry;
  Kind kind = Kind::other;
  const SourceText* source = nullptr;
  std::size_t offset = 0;       ///< offset of the value, bytes from the file's start
  std::string text;             ///< kind text
  double number = 0;            ///< kind number
  bool boolean = false;         ///< kind boolean
  std::vector<TomlNode> items;  ///< kind array
  std::vector<Entry> entries;   ///< kind table, in alphabetical order
};
struct TomlNode::Entry {
  std::string key;
  std::size_t key_offset = 0;
  TomlNode value;
};

/// A parsed file. Tables point into it: it must outlive them.
struct TomlFile {
  SourceText source;
  TomlNode root;
};

/// Syntax errors go to `diagnostics` [toml-syntax]; the file is empty then. An empty file is an error as well
/// [file-empty]; `contents` says what was expected ("a job description").
/// Throws InputError where the file cannot be read.
std::unique_ptr<TomlFile> read_toml(const std::string& path, const std::string& contents, Diagnostics& diagnostics);

/// The same of a text in memory; diagnostics name it by the text's name. Without `contents` it may be empty.
std::unique_ptr<TomlFile> parse_toml(SourceText source, const std::string& contents, Diagnostics& diagnostics);
std::unique_ptr<TomlFile> parse_toml(SourceText source, Diagnostics& diagnostics);

class TomlTable {
 public:
  /// `name` as in the file's brackets: "tool.1"; empty for the top of the file.
  TomlTable(const TomlNode& node, std::string name, Diagnostics& diagnostics);
  static TomlTable top(const TomlFile& file, Diagnostics& diagnostics);

  /// Keys that the table itself does not have are taken from `node`, a table of another file, say, "tool.17" of it.
  void fall_back_on(const TomlNode& node, std::string name);
  bool has_fallback() const { return fallback_ != nullptr; }

  bool has(std::string_view key) const { return find(key) != nullptr; }
  bool is_list(std::string_view key) const;
  double number(std::string_view key, const NumberRange& range, double fallback);
  double required_number(std::string_view key, const NumberRange& range);
  std::optional<double> optional_number(std::string_view key, const NumberRange& range);
  std::string text(std::string_view key, std::string fallback);
  std::string required_text(std::string_view key);
  bool boolean(std::string_view key, bool fallback);
  /// Index into `words` of the text at `key`; a word that is not in the list is an error that shows the list.
  std::size_t choice(std::string_view key, std::span<const std::string_view> words, std::size_t fallback);
  std::optional<std::size_t> required_choice(std::string_view key, std::span<const std::string_view> words);
  /// Array of exactly `count` numbers; `wanted` describes it: "two numbers [min, max]".
  std::optional<std::vector<double>> numbers(std::string_view key, std::size_t count, const NumberRange& range,
                                             std::string_view wanted);
  /// Array of any number of numbers.
  std::optional<std::vector<double>> number_list(std::string_view key, const NumberRange& range,
                                                 std::string_view wanted);
  /// Array of arrays of `columns` numbers; exactly `rows` rows unless rows is 0.
  std::optional<std::vector<std::vector<double>>> number_rows(std::string_view key, std::size_t rows,
                                                              std::size_t columns, const NumberRange& range,
                                                              std::string_view wanted);
  /// Array of any number of texts.
  std::optional<std::vector<std::string>> text_list(std::string_view key, std::string_view wanted);
  std::optional<TomlTable> table(std::string_view key);
  /// List of tables, [[key]]; empty where it is missing or wrong.
  std::vector<TomlTable> tables(std::string_view key);
  /// Kind of the value at `key`; nothing where it is missing.
  std::optional<TomlNode::Kind> kind_of(std::string_view key) const;
  /// Marks `key` as known without reading it.
  void ignore(std::string_view key) { known_.emplace(key); }
  /// Entries of this table itself.
  const std::vector<TomlNode::Entry>& entries() const { return node_->entries; }
  /// Keys of this table; reading them marks them as known.
  std::vector<std::string> keys() const;

  /// An error without a message at the value of `key`, or at the table where there is no such key.
  Diagnostic place_of(std::string_view key) const;
  /// An error at the value of `key`, or at the table where there is no such key.
  void error_at(std::string_view key, std::string message, std::string check);
  void warning_at(std::string_view key, std::string message, std::string check);
  /// True where an error was found in this table or elsewhere in what was read.
  bool found_errors() const { return diagnostics_->has_errors(); }
  /// An error at the name of `key`.
  void error_at_name(std::string_view key, std::string message, std::string check);
  void missing(std::string_view key, std::string_view wanted);
  /// Every key that was not asked for is an error with the nearest known key as a suggestion.
  void finish();

 private:
  const TomlNode::Entry* find(std::string_view key) const;
  const TomlNode* use(std::string_view key);
  void report(Severity severity, const TomlNode& at, std::string message, std::string check);
  void report(Severity severity, const TomlNode& file, std::size_t offset, std::string message, std::string check);
  void refuse_unknown(const TomlNode& node, const std::string& where);
  void wrong_type(std::string_view key, const TomlNode& value, std::string_view wanted);
  bool number_ok(const std::string& key, const TomlNode& value, const NumberRange& range, std::string_view wanted);
  /// " in [tool.1]", or nothing at the top of the file.
  std::string where() const;

  const TomlNode* node_;
  std::string name_;
  const TomlNode* fallback_ = nullptr;
  std::string fallback_name_;
  Diagnostics* diagnostics_;
  std::set<std::string, std::less<>> known_;
};

/// At most `count` words of `known`, those that are most like `word` first.
std::vector<std::string> nearest_words(std::string_view word, std::vector<std::string> known, std::size_t count);

/// The word of `known` that is most like `word`; empty where none is near.
std::string nearest_word(std::string_view word, std::span<const std::string> known);

}  // namespace camber::machine
