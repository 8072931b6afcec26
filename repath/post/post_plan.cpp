#include "repath/post/post_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/units.h"

namespace camber::repath {
namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kSlack = 1e-9;  ///< rad, mm: as kinematics::Chain::outside_travel
constexpr double kMaxTurns = 8;  ///< either way, that are looked at
// Costs, in degrees of rotary motion: the order of what is worse is all that matters.
constexpr double kInAir = 100, kBesideRapid = 200, kInCut = 1e6, kBarrier = 1e5, kWrongPose = 1e9, kOutside = 1e10;

class Planner {
 public:
  Planner(std::span<const TipMotion> motions, std::span<const Barrier> before, const MotionFrame& frame,
          const machine::Machine& machine)
      : motions_(motions), before_(before), frame_(frame), machine_(machine) {
    base_.push_back({});
    if (auto mirrored = mirrored_choice(machine, frame.chain())) base_.push_back(*mirrored);
  }

  std::vector<PlannedStretch> run() {
    make_choices();
    for (std::size_t i = 0; i < motions_.size(); ++i) add_stretches(i);
    return shortest();
  }

 private:
  struct Stretch {
    std::size_t motion;
    double from, to;
  };

  const std::array<double, 2>& travel(Eigen::Index axis) const {
    return machine_.rotary[static_cast<std::size_t>(axis)].travel_rad;
  }

  /// Whole turns of one axis that bring some of the program into travel.
  std::vector<double> turns_of(const RotaryChoice& base, Eigen::Index axis) const {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const TipMotion& m : motions_)
      for (const Vec3& rad : {m.start_rad, m.end_rad}) {
        least = std::min(least, base.of(rad)[axis]);
        most = std::max(most, base.of(rad)[axis]);
      }
    const auto& range = travel(axis);
    if (std::isinf(range[0]) && std::isinf(range[1])) return {0};
    std::vector<double> out;
    for (double k = -kMaxTurns; k <= kMaxTurns; ++k)
      if (most + k * kTurn >= range[0] - kSlack && least + k * kTurn <= range[1] + kSlack) out.push_back(k);
    if (out.empty()) out.push_back(0);
    return out;
  }

  void make_choices() {
    choices_.push_back({});  // as programmed, in any case
    const std::string& letters = frame_.chain().rotary_axes();
    for (const RotaryChoice& base : base_) {
      std::vector<RotaryChoice> now{base};
      for (const char letter : letters) {
        std::vector<RotaryChoice> next;
        for (const double k : turns_of(base, letter - 'a'))
          for (RotaryChoice choice : now) {
            choice.offset_rad[letter - 'a'] += k * kTurn;
            next.push_back(choice);
          }
        now = std::move(next);
      }
      for (const RotaryChoice& choice : now)
        if (!choice.as_programmed()) choices_.push_back(choice);
    }
  }

  bool within(const RotaryChoice& choice, const TipMotion& m, double from, double to) const {
    for (const char letter : frame_.chain().rotary_axes())
      for (const double u : {from, (from + to) / 2, to}) {
        if (u < to && !m.start_known) continue;
        const double angle = choice.of(m.rotary_rad(u))[letter - 'a'];
        const auto& range = travel(letter - 'a');
        if (angle < range[0] - kSlack || angle > range[1] + kSlack) return false;
      }
    return true;
  }

  /// Where no choice holds for the whole motion: parts of it, cut where an axis comes to the end of its travel.
  void add_stretches(std::size_t i) {
    const TipMotion& m = motions_[i];
    const auto holds = [&](const RotaryChoice& c) { return within(c, m, 0, 1); };
    std::vector<double> cuts{0, 1};
    if (m.start_known && std::none_of(choices_.begin(), choices_.end(), holds))
      for (const RotaryChoice& c : choices_)
        for (const char letter : frame_.chain().rotary_axes()) {
          const double start = c.of(m.start_rad)[letter - 'a'], way = c.of(m.end_rad)[letter - 'a'] - start;
          for (const double limit : travel(letter - 'a')) {
            const double u = c.twist ? where_at(m, c, letter - 'a', limit) : (limit - start) / way;
            if (u > 1e-9 && u < 1 - 1e-9) cuts.push_back(u);
          }
        }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t k = 1; k < cuts.size(); ++k)
      if (cuts[k] - cuts[k - 1] > 1e-9 || k + 1 == cuts.size()) stretches_.push_back({i, cuts[k - 1], cuts[k]});
  }

  /// The place at which a twisted axis comes to a limit; negative: it does not.
  static double where_at(const TipMotion& m, const RotaryChoice& c, Eigen::Index axis, double limit_rad) {
    const auto beyond = [&](double u) { return c.of(m.rotary_rad(u))[axis] > limit_rad; };
    const bool first = beyond(0);
    if (std::isinf(limit_rad) || beyond(1) == first) return -1;
    double low = 0, high = 1;
    for (int i = 0; i < 50; ++i) {
      const double middle = (low + high) / 2;
      (beyond(middle) == first ? low : high) = middle;
    }
    return first ? high : low;  // within
  }

  bool linear_within(const RotaryChoice& choice, const Stretch& s) const {
    const TipMotion& m = motions_[s.motion];
    for (const double u : {s.from, (s.from + s.to) / 2, s.to}) {
      if (u < s.to && !m.start_known) continue;
      const Vec3 at = frame_.linear_mm(m, u, choice.of(m.rotary_rad(u)));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& range = machine_.axis[axis].travel_mm;
        const double x = at[static_cast<Eigen::Index>(axis)];
        if (x < range[0] - kSlack || x > range[1] + kSlack) return false;
      }
    }
    return true;
  }

  std::vector<double> costs_of(const Stretch& s, bool barrier_behind) const {
    std::vector<double> out;
    std::array<std::optional<bool>, 2> linear{};
    const Barrier at = s.from == 0 ? before_[s.motion] : Barrier::none;
    const Barrier behind = barrier_behind ? before_[s.motion + 1] : Barrier::none;
    for (const RotaryChoice& c : choices_) {
      double cost = within(c, motions_[s.motion], s.from, s.to) ? 0 : kOutside;
      auto& known = linear[c.mirrored ? 1 : 0];
      if (!known) known = linear_within(c, s);
      if (!*known) cost += kOutside;
      for (const Barrier b : {at, behind}) {
        if (b != Barrier::none && c.mirrored) cost += kWrongPose;
        if (b == Barrier::programmed && !c.as_programmed()) cost += kBarrier;
      }
      out.push_back(cost);
    }
    return out;
  }

  double turn_back_cost(std::size_t i) const {
    const TipMotion& m = motions_[stretches_[i].motion];
    const bool rapid_before = i > 0 && motions_[stretches_[i - 1].motion].rapid;
    if (m.rapid) return rapid_before || i == 0 ? kInAir : kBesideRapid;
    return rapid_before ? kBesideRapid : kInCut;
  }

  std::vector<PlannedStretch> shortest() const {
    const std::size_t n = choices_.size();
    std::vector<double> cost(n, std::numeric_limits<double>::infinity());
    std::vector<std::vector<std::uint16_t>> from(stretches_.size(), std::vector<std::uint16_t>(n));
    for (std::size_t i = 0; i < stretches_.size(); ++i) {
      const Stretch& s = stretches_[i];
      const bool last = i + 1 == stretches_.size() || stretches_[i + 1].motion != s.motion;
      const std::vector<double> here = costs_of(s, last);
      const bool free = i == 0 && !motions_[s.motion].start_known;
      if (i == 0) cost[0] = 0;
      const double change = turn_back_cost(i);
      const bool may_change = change < kInCut || *std::max_element(here.begin(), here.end()) > 0;
      std::vector<double> next(n);
      for (std::size_t c = 0; c < n; ++c) {
        std::size_t best = c;
        double least = cost[c];
        for (std::size_t b = 0; may_change && b < n; ++b) {
          const double turn = deg_from_rad((choices_[b].of(motions_[s.motion].rotary_rad(s.from)) -
                                            choices_[c].of(motions_[s.motion].rotary_rad(s.from)))
                                               .lpNorm<1>());
          const double sum = cost[b] + (free ? 0 : change) + turn;
          if (b != c && sum < least) least = sum, best = b;
        }
        from[i][c] = static_cast<std::uint16_t>(best);
        next[c] = least + here[c];
      }
      cost = std::move(next);
    }
    return backwards(cost, from);
  }

  std::vector<PlannedStretch> backwards(const std::vector<double>& cost,
                                        const std::vector<std::vector<std::uint16_t>>& from) const {
    std::vector<PlannedStretch> out(stretches_.size());
    std::size_t c = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    for (std::size_t i = stretches_.size(); i-- > 0;) {
      const Stretch& s = stretches_[i];
      const std::size_t b = from[i][c];
      const bool known = motions_[s.motion].start_known;
      out[i] = {s.motion, s.from, s.to, choices_[c], choices_[b], b != c && known, turn_back_cost(i) < kInCut};
      c = b;
    }
    return out;
  }

  std::span<const TipMotion> motions_;
  std::span<const Barrier> before_;
  const MotionFrame& frame_;
  const machine::Machine& machine_;
  std::vector<RotaryChoice> base_, choices_;
  std::vector<Stretch> stretches_;
};

}  // namespace

std::vector<PlannedStretch> plan_choices(std::span<const TipMotion> motions, std::span<const Barrier> before,
                                         const MotionFrame& frame, const machine::Machine& machine) {
  if (motions.empty()) return {};
  return Planner(motions, before, frame, machine).run();
}

}  // namespace camber::repath
