#include "nc/emit/emitted_text.h"

#include <algorithm>

#include "nc/emit.h"
#include "nc/emit/text_rules.h"

namespace camber::nc {

std::string_view usual_line_end(const SourceText& source) {
  if (source.line_end() == '\r') return "\r";
  const std::size_t first = source.text().find('\n');
  return first != std::string::npos && first > 0 && source.text()[first - 1] == '\r' ? "\r\n" : "\n";
}

EmittedText::EmittedText(const Program& program, const TextRules& rules) : program_(program), rules_(rules) {
  const std::string& text = program.source.text();
  line_end_ = usual_line_end(program.source);
  out_.reserve(text.size() + 64);
}

void EmittedText::replace(std::uint32_t block, std::string text) { replaced_.emplace_back(block, std::move(text)); }

void EmittedText::add_line_behind(std::uint32_t block, const std::string& line) {
  const std::string more = line_end_of(block) + line;
  for (auto r = replaced_.rbegin(); r != replaced_.rend(); ++r)
    if (r->first == block) {
      r->second += more;
      return;
    }
  const Block& b = program_.blocks[block];
  replace(block, program_.source.text().substr(b.offset, b.length) + more);
}

std::string EmittedText::line_end_of(std::uint32_t block) const {
  const auto& text = program_.source.text();
  const std::size_t end = program_.blocks[block].offset + program_.blocks[block].length;
  const std::size_t next = text.find(program_.source.line_end(), end);
  return next == std::string::npos ? line_end_ : text.substr(end, next + 1 - end);
}

std::string EmittedText::text(const std::string& header) {
  add_header(header);
  std::stable_sort(replaced_.begin(), replaced_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [block, text] : replaced_) {
    copy_until(program_.blocks[block].offset);
    out_ += text.find(program_.source.line_end()) == std::string::npos ? text : rules_.numbered(text);
    copied_ = program_.blocks[block].offset + program_.blocks[block].length;
  }
  copy_until(program_.source.text().size());
  return std::move(out_);
}

void EmittedText::copy_until(std::size_t offset) {
  if (offset <= copied_) return;
  out_.append(program_.source.text(), copied_, offset - copied_);
  copied_ = offset;
}

void EmittedText::add_header(const std::string& header) {
  if (header.empty()) return;
  const auto& text = program_.source.text();
  const std::size_t block = rules_.header_block();
  const std::size_t at = block < program_.blocks.size() ? program_.blocks[block].offset : text.size();
  copy_until(at);
  if (!out_.empty() && out_.back() != program_.source.line_end()) out_ += line_end_;
  std::size_t from = 0;
  while (from < header.size()) {
    const std::size_t end = std::min(header.find('\n', from), header.size());
    out_ += rules_.comment(std::string_view(header).substr(from, end - from)) + line_end_;
    from = end + 1;
    ++header_lines_;
  }
  header_before_ = block;
}

/// The header, then every block's own lines.
std::vector<std::uint32_t> EmittedText::block_of_lines() const {
  std::vector<std::uint32_t> out;
  std::size_t next = 0;
  for (std::uint32_t block = 0; block < program_.blocks.size(); ++block) {
    if (block == header_before_) out.insert(out.end(), header_lines_, Emission::kNoBlock);
    std::size_t lines = 1;
    for (; next < replaced_.size() && replaced_[next].first == block; ++next)
      lines += static_cast<std::size_t>(
          std::count(replaced_[next].second.begin(), replaced_[next].second.end(), program_.source.line_end()));
    out.insert(out.end(), lines, block);
  }
  return out;
}

}  // namespace camber::nc
