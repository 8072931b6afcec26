#pragma once
// A reader of NC text for judging what was emitted: lines and arcs of a three-axis program as straight pieces. It takes
// nothing from Camber, so that a fault of Camber's own reader shows.
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace judge {

struct Point {
  double x = 0, y = 0, z = 0;
};
inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Point operator*(double s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Point& a) { return std::sqrt(dot(a, a)); }

/// A straight piece of a move.
struct Piece {
  Point from, to;
  int tool = 0, line = 0;  ///< line of the text, from 1
  bool rapid = false;
};

/// G0 to G3, G17, G90, G91, G91.1 (centres counted from the start, as is the default), I J or R, T with M6. Codes that
/// do not change the path are passed over; any other code throws std::runtime_error.
class ProgramReader {
 public:
  /// `chord_mm`: how far straight pieces lie from an arc.
  explicit ProgramReader(double chord_mm = 1e-4) : chord_(chord_mm) {}

  std::vector<Piece> read(const std::string& text) {
    std::size_t from = 0;
    for (int line = 1; from < text.size(); ++line) {
      const std::size_t end = std::min(text.find('\n', from), text.size());
      read_line(text.substr(from, end - from), line);
      from = end + 1;
    }
    return pieces_;
  }

 private:
  [[noreturn]] static void fail(int line, const std::string& what) {
    throw std::runtime_error("line " + std::to_string(line) + ": " + what);
  }

  void read_line(const std::string& text, int line) {
    std::map<char, double> word;
    for (std::size_t i = 0; i < text.size();) {
      const char c = static_cast<char>(std::toupper(static_cast<unsigned char>(text[i])));
      if (c == ';' || c == '%') break;
      if (c == '(') {
        i = std::min(text.find(')', i), text.size() - 1) + 1;
        continue;
      }
      if (std::isspace(static_cast<unsigned char>(c)) || c == '/') {
        ++i;
        continue;
      }
      char* end = nullptr;
      const double value = std::strtod(text.c_str() + i + 1, &end);
      if (!std::isalpha(static_cast<unsigned char>(c)) || end == text.c_str() + i + 1) {
        if (c == 'O') break;  // a name
        fail(line, "a word was expected at \"" + text.substr(i) + "\"");
      }
      i = static_cast<std::size_t>(end - text.c_str());
      if (c == 'G')
        code(value, line);
      else if (c == 'T')
        next_tool_ = static_cast<int>(value);
      else if (c == 'M' && value == 6)
        tool_ = next_tool_;
      else
        word[c] = value;
    }
    if (word.contains('X') || word.contains('Y') || word.contains('Z')) move(word, line);
  }

  void code(double g, int line) {
    static const std::set<double> kNoMatter{4,  17, 21, 40, 43, 49, 54, 55,  56,   57,   58, 59,
                                            61, 64, 80, 94, 97, 98, 99, 5.1, 91.1, 61.1, 50, 90.3};
    if (g == 0 || g == 1 || g == 2 || g == 3)
      mode_ = static_cast<int>(g);
    else if (g == 90 || g == 91)
      absolute_ = g == 90;
    else if (!kNoMatter.contains(g))
      fail(line, "G" + std::to_string(g) + " is not known to the judge");
  }

  void move(std::map<char, double>& word, int line) {
    Point to = at_;
    const auto take = [&](char axis, double& value) {
      if (word.contains(axis)) value = absolute_ ? word[axis] : value + word[axis];
    };
    take('X', to.x), take('Y', to.y), take('Z', to.z);
    if (mode_ == 2 || mode_ == 3)
      arc(to, word, line);
    else
      pieces_.push_back({at_, to, tool_, line, mode_ == 0});
    at_ = to;
  }

  void arc(const Point& to, std::map<char, double>& word, int line) {
    constexpr double kPi = 3.14159265358979323846;
    const double turn = mode_ == 3 ? 1 : -1;
    Point centre = at_;
    if (word.contains('R')) {
      const double r = word['R'], dx = to.x - at_.x, dy = to.y - at_.y, chord = std::hypot(dx, dy);
      if (chord == 0) fail(line, "an arc with R begins where it ends");
      const double aside = std::sqrt(std::max(0.0, r * r - chord * chord / 4)) * (r > 0 ? turn : -turn);
      centre.x += dx / 2 - aside * dy / chord, centre.y += dy / 2 + aside * dx / chord;
    } else {
      centre.x += word['I'], centre.y += word['J'];
    }
    const double r = std::hypot(at_.x - centre.x, at_.y - centre.y),
                 r_end = std::hypot(to.x - centre.x, to.y - centre.y);
    if (!(r > 0) || std::abs(r - r_end) > 0.01) fail(line, "the radii of an arc's ends differ");
    const double begin = std::atan2(at_.y - centre.y, at_.x - centre.x);
    double sweep = turn * (std::atan2(to.y - centre.y, to.x - centre.x) - begin);
    while (sweep <= 1e-9) sweep += 2 * kPi;
    const int n = std::max(1, static_cast<int>(std::ceil(sweep / (2 * std::acos(1 - std::min(1.0, chord_ / r))))));
    Point before = at_;
    for (int k = 1; k <= n; ++k) {
      const double s = static_cast<double>(k) / n, angle = begin + turn * s * sweep, radius = r + s * (r_end - r);
      const Point next = k == n ? to
                                : Point{centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle),
                                        at_.z + s * (to.z - at_.z)};
      pieces_.push_back({before, next, tool_, line, false});
      before = next;
    }
  }

  double chord_;
  Point at_{0, 0, 1e3};
  int mode_ = 0, tool_ = 0, next_tool_ = 0;
  bool absolute_ = true;
  std::vector<Piece> pieces_;
};

}  // namespace judge
