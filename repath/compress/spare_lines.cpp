#include "repath/compress/shorten_lines.h"

#include <algorithm>
#include <limits>

#include "repath/compress/chain_window.h"

namespace camber::repath {
namespace {

constexpr std::size_t kBeside = 3;      ///< primitives at either side of a line that are laid out anew with it
constexpr std::uint32_t kMaxEnds = 64;  ///< of a window
constexpr double kExact = 0.25;         ///< of the tolerance: so near lies only what was drawn so
constexpr double kTimesNearer = 4;
constexpr std::size_t kMaxInstead = 3;  ///< of a line with many points

class LineSparer {
 public:
  LineSparer(const Polyline& path, const FitOptions& options, const Fitter& fitter, const std::vector<bool>& corners)
      : path_(path),
        options_(options),
        ends_at_(ends_of(path, corners)),
        joints_(path, options, corners),
        window_(path, options, fitter, joints_) {}

  void run(std::vector<Primitive>& chain) {
    std::vector<bool> straight;
    for (const Primitive& p : chain) straight.push_back(is_straight(p));
    std::vector<Primitive> out;
    std::vector<bool> out_straight;
    for (std::size_t k = 0; k < chain.size(); ++k) {
      out.push_back(chain[k]);
      out_straight.push_back(straight[k]);
      if (chain[k].arc || straight[k]) continue;
      std::size_t first = out.size() - 1, last = k;
      while (first > 0 && out.size() - 1 - first < kBeside && !ends_at_[out[first].first] && !out_straight[first - 1])
        --first;
      while (last + 1 < chain.size() && last - k < kBeside && !ends_at_[chain[last].last] && !straight[last + 1])
        ++last;
      std::vector<Primitive> old(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
      old.insert(old.end(), chain.begin() + static_cast<std::ptrdiff_t>(k) + 1,
                 chain.begin() + static_cast<std::ptrdiff_t>(last) + 1);
      const Primitive before =
          first > 0 ? out[first - 1] : Primitive{.first = old.front().first, .last = old.front().first};
      const std::vector<Primitive> better = relaid(before, old, last + 1 < chain.size() ? &chain[last + 1] : nullptr);
      if (better.empty()) continue;
      out.resize(first);
      out.insert(out.end(), better.begin(), better.end());
      out_straight.resize(first);
      out_straight.resize(out.size(), false);
      k = last;
    }
    chain = std::move(out);
  }

 private:
  double exact_mm() const { return std::max(options_.increment_mm, kExact * options_.tolerance_mm); }

  void lay_ends(std::uint32_t begin, std::uint32_t end) {
    const std::uint32_t count = end - begin, parts = std::min(count, kMaxEnds);
    ends_.clear();
    for (std::uint32_t i = 1; i <= parts; ++i)
      ends_.push_back(begin + static_cast<std::uint32_t>(std::uint64_t{count} * i / parts));
  }

  bool is_straight(const Primitive& p) {
    if (p.arc || is_block(p)) return false;
    if (p.deviation_mm <= options_.increment_mm) return true;
    if (p.last - p.first + 1 < options_.arc_points) return false;
    lay_ends(p.first, p.last);
    ChainCost cost;
    const ChainWindow::Limits limits{std::max(options_.increment_mm, p.deviation_mm / kTimesNearer), kMaxInstead,
                                     options_.primitives_per_line_mm};
    return window_.best({.first = p.first, .last = p.first}, nullptr, ends_, limits, cost).empty();
  }

  ChainCost cost_of(const std::vector<Primitive>& chain) const {
    ChainCost cost{.primitives_per_line_mm = options_.primitives_per_line_mm};
    for (const Primitive& p : chain) cost = cost.with(path_, p);
    return cost;
  }

  std::vector<Primitive> relaid(const Primitive& before, const std::vector<Primitive>& old, const Primitive* behind) {
    if (std::all_of(old.begin(), old.end(), [&](const Primitive& p) { return p.deviation_mm <= exact_mm(); }))
      return {};
    lay_ends(old.front().first, old.back().last);
    ChainCost cost;
    std::vector<Primitive> chain = window_.best(
        before, behind, ends_,
        {options_.tolerance_mm + 1e-9, std::numeric_limits<std::size_t>::max(), options_.primitives_per_line_mm}, cost);
    if (chain.empty() || !(cost < cost_of(old))) return {};
    std::vector<Primitive> joined{before};
    if (is_empty(before)) joined.clear();
    joined.insert(joined.end(), chain.begin(), chain.end());
    if (behind != nullptr) joined.push_back(*behind);
    return joints_.keep(joined) ? chain : std::vector<Primitive>{};
  }

  static bool is_empty(const Primitive& p) { return p.first == p.last; }

  const Polyline path_;
  const FitOptions& options_;
  const std::vector<bool> ends_at_;
  PieceJoints joints_;
  ChainWindow window_;
  std::vector<std::uint32_t> ends_;
};

}  // namespace

void spare_lines(const Polyline& path, const FitOptions& options, const Fitter& fitter,
                 const std::vector<bool>& corners, std::vector<Primitive>& chain) {
  LineSparer(path, options, fitter, corners).run(chain);
}

}  // namespace camber::repath
