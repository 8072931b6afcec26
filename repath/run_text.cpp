#include "repath/run_text.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/arcs.h"
#include "nc/emit/arc_rounding.h"
#include "nc/emit/block_writer.h"
#include "nc/language.h"
#include "repath/plain_blocks.h"

namespace camber::repath {
namespace {

constexpr int kMaxDecimals = 6;
constexpr double kMinFeedFactor = 0.005;
constexpr char kAxis[] = "XYZ", kCentre[] = "IJK";

std::string_view written(const nc::Program& program, const nc::Word& word) {
  return std::string_view(program.source.text()).substr(word.offset, word.length);
}

const nc::Word* find(std::span<const nc::Word> words, char letter) {
  for (const nc::Word& w : words)
    if (w.letter == letter) return &w;
  return nullptr;
}

/// G codes of the motion group.
bool is_motion(const nc::Word& w) {
  if (w.letter != 'G') return false;
  const double g = w.value;
  return (g >= 0 && g <= 3) || (g >= 33 && g < 34) || (g >= 38 && g < 39) || (g >= 73 && g <= 89);
}

/// Writes the blocks of a run, with what they have in common.
class RunBlockWriter {
 public:
  RunBlockWriter(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run,
                 const TextStyle& style)
      : program_(program), style_(style) {
    const nc::Move& first = moves.moves[run.first_move];
    const nc::ModalState& state = moves.state_of(first);
    first_block_ = first.block;
    last_block_ = moves.moves[run.last_move].block;
    unit_mm_ = state.inch ? kMmPerInch : 1;
    feed_mm_per_min_ = 60 * first.feed_mm_per_s;
    incremental_ = state.incremental;
    absolute_centre_ = state.absolute_arc_centre;
    plane_g_ = state.plane_g;
    says_mode_first_ = first.kind == nc::MoveKind::arc || says_g1(first_block_);
    says_mode_always_ = says_g1(last_block_) && says_g1(last_block_ - 1);
  }

 protected:
  bool says_g1(std::uint32_t block) const {
    return std::ranges::any_of(program_.words_of(block),
                               [](const nc::Word& w) { return w.letter == 'G' && w.value == 1; });
  }

  std::string code(int g) const { return fmt::format("G{}{}", style_.two_digit_codes ? "0" : "", g); }

  std::string joined(const std::vector<std::string>& words) const {
    return fmt::format("{}", fmt::join(words, style_.numbers.blanks ? " " : ""));
  }

  /// More than the program's most where those are not enough to say the place.
  int decimals_for(double value_mm) const {
    const double value = value_mm / unit_mm_;
    int decimals = style_.decimals;
    while (decimals < kMaxDecimals && std::abs(nc::rounded(value, decimals) - value) * unit_mm_ > 2e-7) ++decimals;
    return decimals;
  }
  std::string number(char letter, double value_mm) const {
    return letter + nc::format_number(value_mm / unit_mm_, decimals_for(value_mm), style_.numbers);
  }

  std::string feed(double factor) const {
    const double value = factor * feed_mm_per_min_ / unit_mm_;
    return 'F' + nc::format_number(value, unit_mm_ == 1 ? 1 : 2, style_.numbers);
  }

  /// Codes of the run's first block that stand before its motion. `plane`: those of the plane among them.
  void add_codes(std::vector<std::string>& words, bool plane) const {
    for (const nc::Word& w : further_words_of(program_.words_of(first_block_)))
      if (w.letter == 'G' && (plane || w.value < 17 || w.value > 19)) words.emplace_back(written(program_, w));
  }
  /// Its other words: S, M and, where it is to be the old one, F.
  void add_further(std::vector<std::string>& words, bool feed) const {
    for (const nc::Word& w : further_words_of(program_.words_of(first_block_)))
      if (w.letter != 'G' && (feed || w.letter != 'F')) words.emplace_back(written(program_, w));
  }

  const nc::Program& program_;
  const TextStyle& style_;
  std::uint32_t first_block_ = 0, last_block_ = 0;
  double unit_mm_ = 1, feed_mm_per_min_ = 0;
  bool incremental_ = false, absolute_centre_ = false, says_mode_first_ = false, says_mode_always_ = false;
  int plane_g_ = 17;
};

class PointWriter : RunBlockWriter {
 public:
  using RunBlockWriter::RunBlockWriter;

  std::vector<std::string> write(const SpacePath& path, const Layout& layout, const LayoutFeeds& feeds) const {
    std::vector<std::string> lines;
    double feed_now = 1;
    std::uint32_t before = 0;  // the old point whose block ended last
    for (std::size_t k = 1; k < layout.points.size(); ++k) {
      std::vector<std::string> words;
      std::uint32_t old = layout.old_point[k];
      while (path.block[old] == SpacePath::kInside) --old;
      if (old > before)
        if (const nc::Word* n = find(program_.words_of(path.block[old]), 'N'))
          words.emplace_back(written(program_, *n));
      before = old;
      if (lines.empty()) add_codes(words, true);
      if (says_mode_always_ || (lines.empty() && says_mode_first_)) words.push_back(code(1));
      const Vec3 &from = layout.points[k - 1], &to = layout.points[k];
      for (int a = 0; a < 3; ++a)
        if (from[a] != to[a])
          words.push_back(number(kAxis[static_cast<std::size_t>(a)], incremental_ ? to[a] - from[a] : to[a]));
      const double factor = feed_factor(layout, k, feeds);
      if (factor != feed_now) words.push_back(feed(factor));
      if (lines.empty()) add_further(words, factor == feed_now);
      feed_now = factor;
      lines.push_back(joined(words));
    }
    if (feed_now != 1) lines.push_back(feed(1));
    return lines;
  }

  double feed_factor(const Layout& layout, std::size_t k, const LayoutFeeds& feeds) const {
    double out = feeds.factor;
    if (layout.place.empty()) return out;
    const SegmentPlace& place = layout.place[k];
    if (place.near_corner) out *= feeds.corners.fraction;
    if (place.between_corners_mm > 0 && feeds.corners.settle_s > 0)
      out = std::min(out, 60 * place.between_corners_mm / feeds.corners.settle_s / feed_mm_per_min_);
    return std::max(out, kMinFeedFactor);
  }
};

class RunWriter : RunBlockWriter {
 public:
  RunWriter(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run, const RunPath& path,
            const TextStyle& style)
      : RunBlockWriter(program, moves, run, style),
        path_(path),
        run_(run),
        axes_(nc::axes_of(run.normal == 2   ? nc::Plane::xy
                          : run.normal == 1 ? nc::Plane::zx
                                            : nc::Plane::yz)) {}

  RunLines write(const std::vector<Primitive>& chain, bool says_mode) {
    RunLines out;
    std::vector<std::string>& lines = out.lines;
    const bool arcs = std::any_of(chain.begin(), chain.end(), [](const Primitive& p) { return p.arc; });
    const bool other_plane = arcs && !run_.current_plane;
    int mode = says_mode_first_ || says_mode ? -1 : 1;
    for (const Primitive& p : chain) {
      std::vector<std::string> words;
      if (const nc::Word* n = find(program_.words_of(path_.block[p.last]), 'N'))
        words.emplace_back(written(program_, *n));
      if (lines.empty() && other_plane)
        words.push_back(fmt::format("G{}", run_.normal == 2 ? 17 : run_.normal == 1 ? 18 : 19));
      if (lines.empty()) add_codes(words, !other_plane);
      const int now = !p.arc ? 1 : p.sweep_rad < 0 ? 2 : 3;
      if (now != mode || says_mode_always_) words.push_back(code(now));
      mode = now;
      add_coordinates(p, words);
      if (lines.empty()) add_further(words, true);
      out.line_of.push_back(lines.size());
      lines.push_back(joined(words));
    }
    const bool restores = mode != 1 && mode_is_used_behind(program_, last_block_);
    if (other_plane)
      lines.push_back(joined(restores ? std::vector{fmt::format("G{}", plane_g_), code(1)}
                                      : std::vector{fmt::format("G{}", plane_g_)}));
    else if (restores)
      out.mode_behind = code(1);
    return out;
  }

 private:
  void add_coordinates(const Primitive& p, std::vector<std::string>& words) const {
    const Vec2 from = path_.points[p.first], to = path_.points[p.last];
    const bool full_turn = p.arc && from == to;
    std::vector<std::string> place(3), centre(3);
    for (int i = 0; i < 2; ++i) {
      const auto axis = static_cast<std::size_t>(i == 0 ? axes_.first : axes_.second);
      if ((p.arc && !full_turn) || from[i] != to[i])
        place[axis] = number(kAxis[axis], incremental_ ? to[i] - from[i] : to[i]);
      if (p.arc) centre[axis] = number(kCentre[axis], p.center_from_start_mm[i] + (absolute_centre_ ? from[i] : 0));
    }
    if (!path_.heights.empty()) {
      const double from_height = path_.heights[p.first], to_height = path_.heights[p.last];
      const auto axis = static_cast<std::size_t>(axes_.normal);
      if (from_height != to_height)
        place[axis] = number(kAxis[axis], incremental_ ? to_height - from_height : to_height);
    }
    for (const auto* group : {&place, &centre})
      for (const std::string& word : *group)
        if (!word.empty()) words.push_back(word);
  }

  const RunPath& path_;
  const BlockRun& run_;
  nc::PlaneAxes axes_;
};

/// Blocks of languages in which each says how it moves, by the rules of the language.
class SayingBlockWriter : RunBlockWriter {
 public:
  SayingBlockWriter(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run,
                    const TextStyle& style)
      : RunBlockWriter(program, moves, run, style),
        rules_(*style.rules),
        block_(program, first_block_, style.numbers, rules_) {
    for (const nc::Word& w : program.words_of(first_block_))
      if (std::string_view("XYZN").find(w.letter) == std::string_view::npos) own_.push_back(w);
  }

  RunLines write(const RunPath& path, const BlockRun& run, const std::vector<Primitive>& chain) {
    const nc::Plane plane = run.normal == 2 ? nc::Plane::xy : run.normal == 1 ? nc::Plane::zx : nc::Plane::yz;
    const nc::PlaneAxes axes = nc::axes_of(plane);
    bool arcs = false;
    for (const Primitive& p : chain) {
      const Vec2 from = path.points[p.first], to = path.points[p.last];
      std::vector<nc::NewWord> words;
      const auto add = [&](int axis, double value) {
        words.push_back({kAxis[static_cast<std::size_t>(axis)], value / unit_mm_, decimals_for(value)});
      };
      for (int i = 0; i < 2; ++i)
        if (p.arc || from[i] != to[i]) add(i == 0 ? axes.first : axes.second, to[i]);
      if (!path.heights.empty() && path.heights[p.first] != path.heights[p.last])
        add(axes.normal, path.heights[p.last]);
      std::ranges::sort(words, {}, &nc::NewWord::letter);
      if (!p.arc) {
        put_line(words);
        out_.line_of.push_back(out_.lines.size() - 1);
        continue;
      }
      arcs = true;
      const Vec2 centre = from + p.center_from_start_mm;
      const nc::RoundedArc arc{centre.x(), centre.y(), 0};
      nc::WantedArc wanted;
      wanted.sweep_rad = p.sweep_rad, wanted.plane = plane;
      put(rules_.further_arc(block_, words, wanted, arc, unit_mm_, decimals_for(centre.x(), centre.y()), own()));
      out_.line_of.push_back(out_.lines.size() - 1);
    }
    if (arcs)
      for (const std::string& line : rules_.lines_behind(first_block_, last_block_)) put(line);
    return std::move(out_);
  }

  std::vector<std::string> write(const Layout& layout, const std::vector<double>& factors) {
    double now = 1;
    for (std::size_t k = 1; k < layout.points.size(); ++k) {
      std::vector<nc::NewWord> words;
      const Vec3 &from = layout.points[k - 1], &to = layout.points[k];
      for (int a = 0; a < 3; ++a)
        if (from[a] != to[a])
          words.push_back({kAxis[static_cast<std::size_t>(a)], to[a] / unit_mm_, decimals_for(to[a])});
      if (factors[k] != now) words.push_back(feed_word(factors[k]));
      if (factors[k] != 1) std::erase_if(own_, [](const nc::Word& w) { return w.letter == 'F'; });
      now = factors[k];
      put_line(words);
    }
    if (now != 1) put_line({feed_word(1)});
    return std::move(out_.lines);
  }

 private:
  using RunBlockWriter::decimals_for;
  int decimals_for(double a_mm, double b_mm) const { return std::max(decimals_for(a_mm), decimals_for(b_mm)); }

  nc::NewWord feed_word(double factor) const {
    return {'F', factor * feed_mm_per_min_ / unit_mm_, unit_mm_ == 1 ? 1 : 2, &style_.feeds};
  }

  /// Words of the run's first block that stay: in the first new one.
  std::span<const nc::Word> own() const {
    return out_.lines.empty() ? std::span<const nc::Word>(own_) : std::span<const nc::Word>();
  }

  void put_line(const std::vector<nc::NewWord>& words) { put(block_.further_block(words, own())); }

  void put(const std::string& lines) {
    for (std::size_t at = 0; at < lines.size();) {
      const std::size_t end = std::min(lines.find_first_of("\r\n", at), lines.size());
      out_.lines.push_back(rules_.new_line(lines.substr(at, end - at)));
      at = std::min(lines.find_first_not_of("\r\n", end), lines.size());
    }
  }

  nc::TextRules& rules_;
  nc::BlockWriter block_;
  std::vector<nc::Word> own_;
  RunLines out_;
};

}  // namespace

bool mode_is_used_behind(const nc::Program& program, std::size_t block) {
  for (std::size_t b = block + 1; b < program.blocks.size(); ++b) {
    if (program.blocks[b].flow) return true;
    const auto words = program.words_of(b);
    if (words.empty()) continue;
    if (program.blocks[b].skip == 0 && std::any_of(words.begin(), words.end(), is_motion)) return false;
    for (const nc::Word& w : words) {
      if ((w.letter >= 'X' && w.letter <= 'Z') || (w.letter >= 'I' && w.letter <= 'K') || w.letter == 'R') return true;
      if (w.letter == 'M' && (w.value == 2 || w.value == 30)) return false;
    }
  }
  return false;
}

TextStyle text_style_of(const nc::Program& program, const nc::Interpretation& moves) {
  TextStyle style;
  style.numbers = nc::style_of(program);
  const bool inch = std::any_of(moves.states.begin(), moves.states.end(), [](const auto& s) { return s.inch; });
  style.decimals = inch ? 4 : 3;
  for (const nc::Word& w : program.words) {
    const std::string_view text = written(program, w);
    if (w.letter == 'G' && text.size() - w.value_at == 2 && text[w.value_at] == '0') style.two_digit_codes = true;
    if (w.letter >= 'X' && w.letter <= 'Z' && !std::isnan(w.value))
      style.decimals = std::max(style.decimals, nc::decimals_of(text.substr(w.value_at)));
  }
  style.decimals = std::min(style.decimals, kMaxDecimals);
  if (moves.whole_numbers_are_increments) style.numbers.whole = nc::WholeStyle::point;
  style.rules = nc::language_of(program).text_rules(program);
  style.rules->adapt(style.numbers);
  style.feeds = nc::feed_style_of(program);
  return style;
}

RunLines text_of(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run, const RunPath& path,
                 const std::vector<Primitive>& chain, const TextStyle& style, bool says_mode) {
  if (!style.rules->motion_is_modal()) return SayingBlockWriter(program, moves, run, style).write(path, run, chain);
  return RunWriter(program, moves, run, path, style).write(chain, says_mode);
}

std::vector<std::string> text_of(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run,
                                 const SpacePath& path, const Layout& layout, const TextStyle& style,
                                 const LayoutFeeds& feeds) {
  const PointWriter points(program, moves, run, style);
  if (style.rules->motion_is_modal()) return points.write(path, layout, feeds);
  std::vector<double> factors(layout.points.size(), 1);
  for (std::size_t k = 1; k < factors.size(); ++k) factors[k] = points.feed_factor(layout, k, feeds);
  return SayingBlockWriter(program, moves, run, style).write(layout, factors);
}

}  // namespace camber::repath
