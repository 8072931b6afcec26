#include "calib/stretch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "base/numbers.h"

namespace camber::calib {
namespace {

constexpr double kCopyLengthFraction = 0.09;  // copies at other offsets differ by so much in their lengths, on average
constexpr double kCopyCornerRad = 0.05;       // and so much in their corners
constexpr double kContextMm = 50;             // the way in which an axis brakes, and more
constexpr double kTimeFloor = 0.02;           // s; an adapter's clock and median
constexpr double kNormalP10P90 = 2.563;       // distance of the 10th and 90th percentile of a normal distribution
constexpr std::size_t kPartsOfMove = 64;      // pieces that end within the same one are copies
constexpr double kMedianFraction = 1.253;     // error of a median over that of a mean

bool is_feed(const nc::Move& move) { return move.kind == nc::MoveKind::linear || move.kind == nc::MoveKind::arc; }

/// The shape of a stretch, the same for turned and mirrored copies: lengths of the moves and angles between them.
struct Shape {
  std::vector<double> length_mm, corner_rad;  ///< sorted
  double programmed_s = 0;
};

Shape shape_of(const nc::Interpretation& program, const FeedStretch& s) {
  Shape shape;
  for (std::size_t i = s.move_first; i < s.move_end; ++i) {
    shape.length_mm.push_back(length_mm(program, program.moves[i]));
    shape.programmed_s += shape.length_mm.back() / program.moves[i].feed_mm_per_s;
    if (i == s.move_first) continue;
    const Vec3 from = direction_at(program, program.moves[i - 1], 1.0),
               to = direction_at(program, program.moves[i], 0.0);
    shape.corner_rad.push_back(std::acos(std::clamp(from.dot(to), -1.0, 1.0)));
  }
  std::sort(shape.length_mm.begin(), shape.length_mm.end());
  std::sort(shape.corner_rad.begin(), shape.corner_rad.end());
  return shape;
}

double mean_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return a.empty() ? 0 : sum / static_cast<double>(a.size());
}

double mean(const std::vector<double>& values) { return mean_difference(values, std::vector<double>(values.size())); }

bool is_copy(const Shape& a, const Shape& b) {
  return a.length_mm.size() == b.length_mm.size() &&
         mean_difference(a.length_mm, b.length_mm) < kCopyLengthFraction * mean(a.length_mm) &&
         std::abs(a.programmed_s - b.programmed_s) < kCopyLengthFraction * a.programmed_s &&
         mean_difference(a.corner_rad, b.corner_rad) < kCopyCornerRad;
}

void number_geometries(const nc::Interpretation& program, std::vector<FeedStretch>& stretches) {
  struct First {
    Shape shape;
    std::int64_t geometry = 0;
  };
  std::map<std::size_t, std::vector<First>> by_count;
  std::int64_t geometries = 0;
  for (FeedStretch& s : stretches) {
    auto& firsts = by_count[s.move_end - s.move_first];
    Shape shape = shape_of(program, s);
    const auto same =
        std::find_if(firsts.begin(), firsts.end(), [&](const First& f) { return is_copy(f.shape, shape); });
    s.geometry = same != firsts.end() ? same->geometry : geometries++;
    if (same == firsts.end()) firsts.push_back({std::move(shape), s.geometry});
  }
}

std::vector<std::string_view> fields_of(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

class TableReader {
 public:
  TableReader(const SourceText& source, const nc::Interpretation& program)
      : source_(source), program_(program), stretches_(feed_stretches(program)) {
    header_ = fields_of(source_.line(1));
  }

  std::vector<TimedStretch> run() {
    const auto plain_time = optional_column("time_s");
    const std::size_t first = column("first_line"), last = column("last_line"),
                      time = plain_time ? *plain_time : column("t_measured_median_s");
    const auto p10 = optional_column("t_p10"), p90 = optional_column("t_p90"), parts = optional_column("n_parts");
    std::vector<TimedStretch> table;
    for (std::size_t line = 2; line <= source_.line_count(); ++line) {
      const auto fields = fields_of(source_.line(line));
      if (fields.size() == 1 && fields[0].empty()) continue;
      TimedStretch row;
      row.stretch = stretch_of(line, number(fields, first, line), number(fields, last, line));
      row.time_s = number(fields, time, line);
      if (row.time_s <= 0)
        fail(line, fmt::format("the time is {} s; more than 0 was expected", row.time_s), "stretch-number");
      double scatter = 0;
      if (p10 && p90) {
        const double n = parts ? std::max(1.0, number(fields, *parts, line)) : 1.0;
        scatter =
            kMedianFraction * (number(fields, *p90, line) - number(fields, *p10, line)) / kNormalP10P90 / std::sqrt(n);
      }
      row.sigma_s = std::hypot(kTimeFloor, scatter);
      table.push_back(row);
    }
    return table;
  }

 private:
  [[noreturn]] void fail(std::size_t line, std::string message, std::string check) const {
    throw InputError({{.severity = Severity::error,
                       .location = {source_.name(), line, 1},
                       .message = std::move(message),
                       .check = std::move(check),
                       .source_line = std::string(source_.line(line))}});
  }

  std::optional<std::size_t> optional_column(std::string_view name) const {
    const auto at = std::find(header_.begin(), header_.end(), name);
    return at == header_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(at - header_.begin()));
  }

  std::size_t column(std::string_view name) const {
    if (const auto at = optional_column(name)) return *at;
    fail(1, fmt::format("the header has no column {}", name), "stretch-column");
  }

  double number(const std::vector<std::string_view>& fields, std::size_t column, std::size_t line) const {
    const auto value = column < fields.size() ? parse_number(fields[column]) : std::nullopt;
    if (!value)
      fail(line,
           fmt::format("{} is \"{}\"; a number is expected", header_[column],
                       column < fields.size() ? fields[column] : std::string_view()),
           "stretch-number");
    return *value;
  }

  FeedStretch stretch_of(std::size_t line, double first, double last) const {
    for (const FeedStretch& s : stretches_)
      if (s.line_first == first && s.line_last == last) return s;
    for (const FeedStretch& s : stretches_) {
      if (first < s.line_first || last > s.line_last || first > last) continue;
      const auto line_of = [&](std::size_t m) { return program_.moves[m].block + 1; };
      std::size_t from = s.move_first, end = s.move_end;
      while (from < end && line_of(from) < first) ++from;
      while (end > from && line_of(end - 1) > last) --end;
      if (from < end) return piece_of(s, program_, from, end);
    }
    fail(line,
         fmt::format("lines {} to {} of the program are not within one run of feed moves between rapids", first, last),
         "stretch-lines");
  }

  const SourceText& source_;
  const nc::Interpretation& program_;
  std::vector<FeedStretch> stretches_;
  std::vector<std::string_view> header_;
};

}  // namespace

std::vector<FeedStretch> feed_stretches(const nc::Interpretation& program) {
  std::vector<FeedStretch> stretches;
  bool open = false;
  for (std::size_t i = 0; i < program.moves.size(); ++i) {
    const nc::Move& move = program.moves[i];
    const int tool = program.state_of(move).tool;
    if (!is_feed(move) || move.canned || move.reference) {
      open = false;
      continue;
    }
    if (!open || stretches.back().tool != tool)
      stretches.push_back({.line_first = move.block + 1, .move_first = i, .tool = tool});
    stretches.back().line_last = move.block + 1;
    stretches.back().move_end = i + 1;
    open = true;
  }
  for (FeedStretch& s : stretches) {
    s.run_first = s.move_first;
    s.run_end = s.move_end;
  }
  number_geometries(program, stretches);
  return stretches;
}

FeedStretch piece_of(const FeedStretch& run, const nc::Interpretation& program, std::size_t move_first,
                     std::size_t move_end, double first_u, double last_u) {
  FeedStretch piece = run;
  piece.first_u = first_u;
  piece.last_u = last_u;
  piece.move_first = move_first;
  piece.move_end = move_end;
  piece.line_first = program.moves[move_first].block + 1;
  piece.line_last = program.moves[move_end - 1].block + 1;
  if (!piece.begins_in_motion() && !piece.ends_in_motion()) return run;
  // Below those of whole stretches, which are no copies of it.
  const auto part = [](double u) { return static_cast<std::size_t>(kPartsOfMove * u); };
  const std::size_t moves = move_first * (program.moves.size() + 1) + move_end;
  piece.geometry =
      -1 - static_cast<std::int64_t>((moves * kPartsOfMove + part(first_u)) * kPartsOfMove + part(1 - last_u));
  return piece;
}

StretchContext context_of(const FeedStretch& stretch, const nc::Interpretation& program) {
  StretchContext context{stretch.move_first, stretch.move_end};
  double before_mm = 0, after_mm = 0;
  while (context.first > stretch.run_first && before_mm < kContextMm)
    before_mm += length_mm(program, program.moves[--context.first]);
  while (context.end < stretch.run_end && after_mm < kContextMm)
    after_mm += length_mm(program, program.moves[context.end++]);
  return context;
}

StretchProgram::StretchProgram(const nc::Interpretation& whole, bool with_rapids)
    : whole_(whole), with_rapids_(with_rapids) {
  program_.arcs = whole.arcs;
  program_.states = whole.states;
}

std::pair<std::size_t, std::size_t> StretchProgram::add(const TimedStretch& timed) {
  const FeedStretch& s = timed.stretch;
  const std::vector<nc::Move>& moves = whole_.moves;
  const auto rapid_at = [&](std::size_t i) {
    return with_rapids_ && i < moves.size() && moves[i].kind == nc::MoveKind::rapid && !moves[i].reference;
  };
  const StretchContext context = context_of(s, whole_);
  std::size_t from = context.first;
  if (from > 0 && from == s.run_first && rapid_at(from - 1)) --from;
  const std::size_t to = context.end + (context.end == s.run_end && rapid_at(context.end) ? 1 : 0);
  const bool continues = s.run_first == run_first_ && timed.feed_factor == feed_factor_ && from <= end_;
  if (continues) {
    from = end_;
  } else {
    nc::Move rest = moves[from];
    rest.kind = nc::MoveKind::dwell;
    rest.end_mm = rest.start_mm;
    rest.arc = nc::Move::kNoArc;
    rest.feed_mm_per_s = 0;
    program_.moves.push_back(rest);
    shift_ = program_.moves.size() - from;
  }
  run_first_ = s.run_first;
  feed_factor_ = timed.feed_factor;
  if (from < to) {
    const auto added = moves_at_override(whole_, from, to, timed.feed_factor);
    program_.moves.insert(program_.moves.end(), added.begin(), added.end());
  }
  end_ = continues ? std::max(end_, to) : to;
  return {s.move_first + shift_, s.move_end + shift_};
}

bool is_stretch_table(const std::string& path) {
  const SourceText source = SourceText::read(path);
  const auto header = fields_of(source.line(1));
  return std::find(header.begin(), header.end(), "first_line") != header.end();
}

std::vector<TimedStretch> read_stretch_table(const std::string& path, const nc::Interpretation& program) {
  const SourceText source = SourceText::read(path);
  return TableReader(source, program).run();
}

double programmed_length_mm(const FeedStretch& stretch, const nc::Interpretation& program) {
  double length = 0;
  for (std::size_t i = stretch.move_first; i < stretch.move_end; ++i)
    length += stretch.fraction_of(i) * length_mm(program, program.moves[i]);
  return length;
}

double programmed_time_s(const FeedStretch& stretch, const nc::Interpretation& program) {
  double time = 0;
  for (std::size_t i = stretch.move_first; i < stretch.move_end; ++i)
    time += stretch.fraction_of(i) * length_mm(program, program.moves[i]) / program.moves[i].feed_mm_per_s;
  return time;
}

double programmed_time_s(const TimedStretch& timed, const nc::Interpretation& program) {
  return programmed_time_s(timed.stretch, program) / timed.feed_factor;
}

std::vector<nc::Move> moves_at_override(const nc::Interpretation& program, std::size_t first, std::size_t end,
                                        double feed_factor) {
  std::vector<nc::Move> moves(program.moves.begin() + static_cast<std::ptrdiff_t>(first),
                              program.moves.begin() + static_cast<std::ptrdiff_t>(end));
  for (nc::Move& move : moves) move.feed_mm_per_s *= feed_factor;
  return moves;
}

std::vector<TimedStretch> one_for_each_geometry(const std::vector<TimedStretch>& all,
                                                const nc::Interpretation& program) {
  struct Sum {
    const TimedStretch* first = nullptr;
    double weight = 0, ratio = 0;
  };
  std::map<std::pair<std::int64_t, double>, Sum> sums;
  for (const TimedStretch& t : all) {
    Sum& sum = sums[{t.stretch.geometry, t.feed_factor}];
    if (!sum.first) sum.first = &t;
    const double weight = 1.0 / (t.sigma_s * t.sigma_s);
    sum.weight += weight;
    sum.ratio += weight * t.time_s / programmed_time_s(t, program);
  }
  std::vector<TimedStretch> result;
  for (const auto& [geometry, sum] : sums) {
    TimedStretch t = *sum.first;
    t.time_s = sum.ratio / sum.weight * programmed_time_s(t, program);
    t.sigma_s = std::max(std::min(kTimeFloor, t.sigma_s), 1.0 / std::sqrt(sum.weight));
    result.push_back(t);
  }
  std::ranges::stable_sort(result, {},
                           [](const TimedStretch& t) { return std::pair(t.stretch.move_first, t.stretch.first_u); });
  return result;
}

}  // namespace camber::calib
