#include "repath/compress/shorten_lines.h"

#include <algorithm>
#include <array>
#include <limits>

#include "repath/compress/chain_window.h"

namespace camber::repath {
namespace {

/// Primitives beside a joint that are laid out anew with it, and ends that are tried along each.
struct Effort {
  std::size_t beside = 0;
  std::uint32_t ends = 0;
  double fraction = 1;  ///< of the bound; see Joints::give_away
};
constexpr std::array kEfforts{Effort{4, 12, 1.0}, Effort{4, 12, 0.9}, Effort{8, 12, 0.8}, Effort{8, 32, 0.9}};
constexpr std::size_t kMaxPrimitives = 40;  ///< of one stretch

class Smoother {
 public:
  Smoother(const Polyline& path, const FitOptions& options, const Fitter& fitter, const std::vector<bool>& corners)
      : options_(options),
        corners_(corners),
        joints_(path, options, corners),
        window_(path, options, fitter, joints_) {}

  void run(std::vector<Primitive>& chain) {
    if (!joints_.bounded()) return;
    for (const Effort& effort : kEfforts) {
      joints_.give_away(effort.fraction);
      chain = smoothed(chain, effort);
    }
    give_way(joints_, chain);
  }

 private:
  /// First and last primitive of the stretch about the joint behind `k`: up to corners, and no further than asked for.
  std::pair<std::size_t, std::size_t> stretch(const std::vector<Primitive>& chain, std::size_t k, std::size_t least,
                                              std::size_t beside) const {
    std::size_t first = k, last = k + 1;
    while (first > least && k - first + 1 < beside && !corners_[chain[first].first]) --first;
    while (last + 1 < chain.size() && last - k < beside && !corners_[chain[last].last]) ++last;
    return {first, last};
  }

  std::vector<Primitive> smoothed(const std::vector<Primitive>& chain, const Effort& effort) {
    std::vector<Primitive> out;
    for (std::size_t k = 0; k < chain.size(); ++k) {
      if (k + 1 == chain.size() || joints_.keep(chain[k], chain[k + 1])) {
        out.push_back(chain[k]);
        continue;
      }
      // What stands in `out` behind the last stretch is as in the chain: the begin of this one is taken back from it.
      auto [first, last] = stretch(chain, k, done_of(out, chain, k), effort.beside);
      for (std::size_t next = last; next + 1 < chain.size() && next < last + effort.beside; ++next) {
        if (last - first >= kMaxPrimitives || corners_[chain[next].last] || joints_.keep(chain[next], chain[next + 1]))
          continue;
        last = stretch(chain, next, first, effort.beside).second;
      }
      out.resize(out.size() - (k - first));
      const std::vector<Primitive> old(chain.begin() + static_cast<std::ptrdiff_t>(first),
                                       chain.begin() + static_cast<std::ptrdiff_t>(last) + 1);
      const std::vector<Primitive> better =
          relaid(out, old, last + 1 < chain.size() ? &chain[last + 1] : nullptr, effort.ends);
      const auto& taken = better.empty() ? old : better;
      out.insert(out.end(), taken.begin(), taken.end());
      k = last;
    }
    return out;
  }

  /// The first of the primitives before `k` that `out` still holds as they were.
  static std::size_t done_of(const std::vector<Primitive>& out, const std::vector<Primitive>& chain, std::size_t k) {
    std::size_t first = k, at = out.size();
    while (first > 0 && at > 0 && out[at - 1].first == chain[first - 1].first &&
           out[at - 1].last == chain[first - 1].last && out[at - 1].sweep_rad == chain[first - 1].sweep_rad)
      --first, --at;
    return first;
  }

  std::vector<Primitive> relaid(const std::vector<Primitive>& out, const std::vector<Primitive>& old,
                                const Primitive* behind, std::uint32_t ends_each) {
    const std::uint32_t begin = old.front().first;
    const Primitive before = out.empty() ? Primitive{.first = begin, .last = begin} : out.back();
    ends_.clear();
    for (const Primitive& p : old) {
      const std::uint32_t count = p.last - p.first, parts = std::min(count, ends_each);
      for (std::uint32_t i = 1; i <= parts; ++i) ends_.push_back(p.first + count * i / parts);
    }
    ChainCost cost;
    std::vector<Primitive> chain = window_.best(
        before, behind, ends_, {options_.tolerance_mm + 1e-9, std::numeric_limits<std::size_t>::max()}, cost);
    if (chain.empty()) return {};
    return kinks_too_large(before, chain, behind) < kinks_too_large(before, old, behind) ? chain
                                                                                         : std::vector<Primitive>{};
  }

  std::size_t kinks_too_large(const Primitive& before, const std::vector<Primitive>& chain,
                              const Primitive* behind) const {
    std::size_t count = joints_.keep(before, chain.front()) ? 0 : 1;
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) count += joints_.keep(chain[k], chain[k + 1]) ? 0 : 1;
    return count + (behind == nullptr || joints_.keep(chain.back(), *behind) ? 0 : 1);
  }

  const FitOptions& options_;
  const std::vector<bool>& corners_;
  PieceJoints joints_;
  ChainWindow window_;
  std::vector<std::uint32_t> ends_;
};

}  // namespace

void smooth_joints(const Polyline& path, const FitOptions& options, const Fitter& fitter,
                   const std::vector<bool>& corners, std::vector<Primitive>& chain) {
  Smoother(path, options, fitter, corners).run(chain);
}

}  // namespace camber::repath
