#include "deflection/static_equilibrium.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <Eigen/LU>

#include "deflection/tool_frame.h"

namespace camber::deflection {

namespace {

constexpr int kMaxSteps = 8;
constexpr int kMaxDamped = 60;
constexpr double kExact_mm = 2e-5;  ///< of delta - C F, at any node
constexpr double kFar2_mm2 = 1e4;   ///< no tool bends that far and cuts
constexpr int kMaxHalvings = 5;
constexpr double kNothing_mm = 1e-8;  ///< of a deflection: rows are kept as floats

using Coarse = Eigen::Matrix4d;
using CoarseDeflection = Eigen::Vector4d;
using ByCoarse = Eigen::Matrix<double, 2, 4, Eigen::RowMajor>;

/// Calls f(from, end) for parts of 0 ... count, on all threads where `elements` are worth it.
template <class Function>
void for_all(std::size_t count, std::size_t elements, Function f) {
  constexpr std::size_t kWorthThreads = 1500, kParts = 8;
  if (elements < kWorthThreads) return f(std::size_t{0}, count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, count / kParts + 1),
                    [&](const auto& range) { f(range.begin(), range.end()); });
}

}  // namespace

StaticEquilibrium::StaticEquilibrium(const removal::EnvelopeGrid& envelope, const ToothPassModel& model)
    : envelope_(envelope),
      model_(model),
      steps_(static_cast<std::size_t>(model.steps())),
      nodes_(model.node_height_mm().size()) {
  const auto& heights = model.node_height_mm();
  for (const auto& ring : envelope.rings) {
    auto w = removal::node_weight(heights, ring.profile.height_mm);
    w.upper = std::min(w.lower + 1, static_cast<int>(nodes_) - 1);
    const auto sine = static_cast<double>(ring.sine);
    rings_.push_back({w, std::clamp(ring.profile.height_mm / heights.back(), 0.0, 1.0), sine,
                      sine > 0 ? ring.profile.parallel_curvature_per_mm / sine : 0.0});
  }
  for (auto* v : {&read_, &deflection_, &moved_, &side_, &left_, &step_}) v->assign(steps_ * nodes_ * 2, 0.0);
  for (auto* v : {&by_own_, &by_side_}) v->assign(steps_ * nodes_ * 8, 0.0);
  coarse_.assign(steps_ * 4, 0.0);
  norm_.assign(steps_, 0.0);
  damping_.assign(steps_, 0.0);
  stale_.assign(steps_, 1);
}

void StaticEquilibrium::place_elements(std::span<const removal::DeflectedChipSample> chips, std::size_t passing,
                                       const removal::Stamp& stamp) {
  const Vec3& feed = stamp.feed_per_tooth_mm;
  model_.edge_elements(chips, passing, feed, found_);
  first_.assign(steps_ + 1, 0);
  for (const EdgeElement& e : found_) ++first_[static_cast<std::size_t>(e.step) + 1];
  for (std::size_t m = 0; m < steps_; ++m) first_[m + 1] += first_[m];
  elements_.resize(found_.size());
  max_lean_mm_ = removal::kMaxTilt * feed.norm();
  first_stamp_ = stamp.first;
  std::vector<std::size_t> at(first_.begin(), first_.end() - 1);
  place_.resize(found_.size());
  for (std::size_t i = 0; i < found_.size(); ++i) place_[i] = at[static_cast<std::size_t>(found_[i].step)]++;
  for_all(found_.size(), found_.size(), [&](std::size_t from, std::size_t end) {
    for (std::size_t i = from; i < end; ++i) elements_[place_[i]] = element(found_[i], chips[found_[i].chip], feed);
  });
}

StaticEquilibrium::Element StaticEquilibrium::element(const EdgeElement& f, const removal::DeflectedChipSample& bent,
                                                      const Vec3& feed) const {
  const double node_step = model_.node_height_mm()[1], per_rad = envelope_.steps / (4 * kPi);
  const std::uint32_t r = bent.chip.point / static_cast<std::uint32_t>(envelope_.steps);
  const Ring& ring = rings_[r];
  const EdgeDirections d = model_.direction(bent.chip.point, envelope_.rings[r]);
  Element e;
  e.normal = d.normal.head<2>();
  e.tangential = d.tangential.head<2>();
  e.meridian = d.meridian.head<2>();
  e.deeper = Vec2(static_cast<double>(bent.deeper[0]), static_cast<double>(bent.deeper[1]));
  e.depth_mm = static_cast<double>(bent.depth_mm);
  e.cap_mm = static_cast<double>(bent.cap_mm);
  e.thickness_mm = e.solved_mm = f.thickness_mm;
  e.width_mm = bent.chip.width_fraction() * envelope_.rings[r].width_mm;
  e.ring = r, e.chip = f.chip;
  // As removal/simd/upright_kernels_impl.h, read_points.
  constexpr double kLevel = 0.05;
  const double around = -feed.dot(d.tangential), up = feed.dot(d.meridian);
  const bool leans = ring.sine >= kLevel;
  e.by_step = leans ? per_rad * (around * ring.per_radius - up * ring.sine * envelope_.lag_per_mm) : 0;
  e.by_height = leans ? up * ring.sine / node_step : 0;
  e.lean_mm = lean_mm(e, static_cast<std::size_t>(f.step));
  return e;
}

/// What follows from deflection_.
void StaticEquilibrium::place_deflections() {
  const std::size_t row = 2 * nodes_;
  for (std::size_t m = 0; m < steps_; ++m) {
    const double* ahead = deflection_.data() + (m + 1 == steps_ ? 0 : m + 1) * row;
    const double* behind = deflection_.data() + (m == 0 ? steps_ - 1 : m - 1) * row;
    for (std::size_t i = 0; i < row; ++i) {
      moved_[m * row + i] = deflection_[m * row + i] - read_[m * row + i];
      side_[m * row + i] = ahead[i] - behind[i];
    }
  }
}

Vec2 StaticEquilibrium::at_ring(const std::vector<double>& deflection, const Ring& ring, std::size_t m) const {
  const double* lower = deflection.data() + 2 * (m * nodes_ + static_cast<std::size_t>(ring.weight.lower));
  const double* upper = deflection.data() + 2 * (m * nodes_ + static_cast<std::size_t>(ring.weight.upper));
  const auto share = static_cast<double>(ring.weight.upper_fraction);
  return {lower[0] + share * (upper[0] - lower[0]), lower[1] + share * (upper[1] - lower[1])};
}

double StaticEquilibrium::lean_mm(const Element& e, std::size_t m) const {
  const Ring& ring = rings_[e.ring];
  const double* lower = deflection_.data() + 2 * (m * nodes_ + static_cast<std::size_t>(ring.weight.lower));
  const double* upper = deflection_.data() + 2 * (m * nodes_ + static_cast<std::size_t>(ring.weight.upper));
  return e.by_step * e.normal.dot(at_ring(side_, ring, m)) +
         e.by_height * e.normal.dot(Vec2(upper[0] - lower[0], upper[1] - lower[1]));
}

/// C F + run-out - displacement at rotation step m, and how C F changes.
void StaticEquilibrium::balance(std::size_t m) {
  const std::size_t from = 2 * m * nodes_;
  double* left = left_.data() + from;
  const Vec2 run_out = run_out_.empty() ? Vec2(Vec2::Zero()) : run_out_[m];
  for (std::size_t i = 0; i < 2 * nodes_; ++i) left[i] = run_out[i % 2 == 0 ? 0 : 1] - deflection_[from + i];
  std::fill_n(by_own_.data() + 4 * from, 8 * nodes_, 0.0);
  std::fill_n(by_side_.data() + 4 * from, 8 * nodes_, 0.0);
  const machine::Material& material = model_.material();
  const double ramp = model_.edge_ramp_mm();
  const double nodes_apart = model_.node_height_mm()[1] / model_.node_height_mm().back();
  const auto bounded = [&](double v) { return std::clamp(v, -max_lean_mm_, max_lean_mm_); };
  for (std::size_t i = first_[m]; i < first_[m + 1]; ++i) {
    Element& e = elements_[i];
    const Ring& ring = rings_[e.ring];
    const Vec2 moved = at_ring(moved_, ring, m);
    const double depth = e.depth_mm + e.deeper.dot(moved), lean = lean_mm(e, m);
    const double cap = e.cap_mm + (first_stamp_ ? 0.0 : e.normal.dot(moved)) - (bounded(lean) - bounded(e.lean_mm));
    const bool by_cap = cap < depth;
    const double h = e.thickness_mm + std::min(depth, cap) - std::min(e.depth_mm, e.cap_mm);
    e.solved_mm = h;
    if (h <= 0) continue;
    const EdgeForce f = edge_force(material, h, e.width_mm, ramp);
    const EdgeForce k = edge_force_slope(material, h, ramp);
    const Vec2 force = lateral_on_tool(f, e.tangential, e.normal, e.meridian);
    const Vec2 slope = e.width_mm * lateral_on_tool(k, e.tangential, e.normal, e.meridian);
    // Thickness by the deflections at the first and the last node, of this rotation step and of those beside it.
    const Vec2 own = !by_cap ? e.deeper : first_stamp_ ? Vec2(Vec2::Zero()) : e.normal;
    const double up = ring.height_fraction;
    std::array<double, 4> by_own{(1 - up) * own.x(), (1 - up) * own.y(), up * own.x(), up * own.y()}, by_side{};
    const bool leans = by_cap && std::abs(lean) < max_lean_mm_;
    if (leans) {
      const double along = e.by_height * nodes_apart;
      for (std::size_t a = 0; a < 2; ++a) {
        const double n = e.normal[static_cast<Eigen::Index>(a)];
        by_own[a] += along * n;
        by_own[2 + a] -= along * n;
        by_side[a] = -e.by_step * (1 - up) * n;
        by_side[2 + a] = -e.by_step * up * n;
      }
    }
    for (std::size_t n = 0; n < nodes_; ++n) {
      const Vec2 c = model_.compliance_mm_per_N(e.ring, n);
      for (int a = 0; a < 2; ++a) {
        const std::size_t row = 2 * n + static_cast<std::size_t>(a);
        left[row] += c[a] * force[a];
        const double change = c[a] * slope[a];
        double* of_own = by_own_.data() + 4 * (from + row);
        double* of_side = by_side_.data() + 4 * (from + row);
        for (std::size_t b = 0; b < 4; ++b) of_own[b] += change * by_own[b];
        if (leans)
          for (std::size_t b = 0; b < 4; ++b) of_side[b] += change * by_side[b];
      }
    }
  }
}

/// (1 - own_m) x_m - side_m (x_(m+1) - x_(m-1)) = left_m around the turn, for the deflections x at the first and last
/// node: elimination with the last step's deflection kept as a border.
void StaticEquilibrium::solve_coarse() {
  const std::size_t n = steps_;
  const auto block = [&](const std::vector<double>& v, std::size_t m) {
    Coarse out;
    for (int half = 0; half < 2; ++half) {
      const std::size_t node = half == 0 ? 0 : nodes_ - 1;
      out.middleRows<2>(2 * half) = Eigen::Map<const ByCoarse>(v.data() + 8 * (m * nodes_ + node));
    }
    return out;
  };
  // x_m = value_m - ahead_m x_(m+1) - border_m x_last.
  static thread_local std::vector<Coarse> ahead, border;
  static thread_local std::vector<CoarseDeflection> value;
  ahead.resize(n), border.resize(n), value.resize(n);
  const auto right = [&](std::size_t m) {
    CoarseDeflection out;
    const double* first = left_.data() + 2 * m * nodes_;
    const double* last = first + 2 * (nodes_ - 1);
    out << first[0], first[1], last[0], last[1];
    return out;
  };
  for (std::size_t m = 0; m + 1 < n; ++m) {
    if (first_[m] == first_[m + 1]) {  // out of the cut
      value[m] = right(m) / (1 + damping_[m]);
      ahead[m].setZero(), border[m].setZero();
      continue;
    }
    const Coarse side = block(by_side_, m);
    Coarse own = (1 + damping_[m]) * Coarse::Identity() - block(by_own_, m);
    CoarseDeflection r = right(m);
    Coarse b = Coarse::Zero();
    if (m == 0) {
      b = side;
    } else {
      own -= side * ahead[m - 1];
      r -= side * value[m - 1];
      b = -side * border[m - 1];
    }
    Coarse a = -side;
    if (m + 2 == n) b += a, a.setZero();
    const Coarse inverse = own.inverse();
    value[m] = inverse * r;
    ahead[m] = inverse * a;
    border[m] = inverse * b;
  }
  // The first step's deflection by the last one's.
  CoarseDeflection first_value = value[n - 2];
  Coarse first_border = border[n - 2];
  const CoarseDeflection before_value = first_value;
  const Coarse before_border = first_border;
  for (std::size_t m = n - 2; m-- > 0;) {
    first_value = value[m] - ahead[m] * first_value;
    first_border = border[m] - ahead[m] * first_border;
  }
  const Coarse side = block(by_side_, n - 1);
  const Coarse own =
      (1 + damping_[n - 1]) * Coarse::Identity() - block(by_own_, n - 1) + side * first_border - side * before_border;
  CoarseDeflection x = own.partialPivLu().solve(right(n - 1) + side * first_value - side * before_value);
  const CoarseDeflection last = x;
  Eigen::Map<CoarseDeflection>(coarse_.data() + 4 * (n - 1)) = x;
  for (std::size_t m = n - 1; m-- > 0;) {
    x = value[m] - (m + 2 == n ? CoarseDeflection(CoarseDeflection::Zero()) : CoarseDeflection(ahead[m] * x)) -
        border[m] * last;
    Eigen::Map<CoarseDeflection>(coarse_.data() + 4 * m) = x;
  }
}

/// Returns the sum of squares of what is left.
double StaticEquilibrium::balance_all() {
  place_deflections();
  const auto row = static_cast<Eigen::Index>(2 * nodes_);
  for_all(steps_, elements_.size(), [&](std::size_t from, std::size_t end) {
    for (std::size_t m = from; m < end; ++m) {
      if (stale_[m] == 0) continue;
      balance(m);
      norm_[m] = Eigen::Map<const Eigen::VectorXd>(left_.data() + 2 * m * nodes_, row).lpNorm<Eigen::Infinity>();
    }
  });
  return Eigen::Map<const Eigen::VectorXd>(left_.data(), static_cast<Eigen::Index>(left_.size())).squaredNorm();
}

/// Newton's step of all nodes; rotation steps in balance stay.
void StaticEquilibrium::advance() {
  for (std::size_t m = 0; m < steps_; ++m) {
    const std::size_t ahead = m + 1 == steps_ ? 0 : m + 1, behind = m == 0 ? steps_ - 1 : m - 1;
    const Eigen::Map<const CoarseDeflection> own(coarse_.data() + 4 * m);
    const CoarseDeflection side = Eigen::Map<const CoarseDeflection>(coarse_.data() + 4 * ahead) -
                                  Eigen::Map<const CoarseDeflection>(coarse_.data() + 4 * behind);
    const bool stays = norm_[m] < kExact_mm && own.lpNorm<Eigen::Infinity>() < kExact_mm;
    for (std::size_t i = 2 * m * nodes_; i < 2 * (m + 1) * nodes_; ++i)
      step_[i] = stays ? 0.0
                       : (left_[i] + Eigen::Map<const Eigen::RowVector4d>(by_own_.data() + 4 * i).dot(own) +
                          Eigen::Map<const Eigen::RowVector4d>(by_side_.data() + 4 * i).dot(side)) /
                             (1 + damping_[m]);
    stale_[m] = stays ? 0 : 1;
  }
  const std::vector<char> moves = stale_;
  for (std::size_t m = 0; m < steps_; ++m)
    if (moves[m] != 0) stale_[m + 1 == steps_ ? 0 : m + 1] = stale_[m == 0 ? steps_ - 1 : m - 1] = 1;
}

/// Where Newton's method swings about a corner of the force: a tool that creeps towards the balance, as a damped one
/// would, comes to rest at a balance that is stable. Rotation steps that come nearer creep faster.
void StaticEquilibrium::creep(Step& out) {
  constexpr double kFirst = 0.5, kMax = 4, kFaster = 0.4, kSlower = 2;
  std::vector<double> least(steps_, 0.0);
  for (std::size_t m = 0; m < steps_; ++m) damping_[m] = norm_[m] < kExact_mm ? 0 : kFirst;
  for (int step = 0; step < kMaxDamped; ++step, ++out.steps) {
    const std::vector<double> before = norm_;
    solve_coarse();
    advance();
    for (std::size_t i = 0; i < deflection_.size(); ++i) deflection_[i] += step_[i];
    if (!(balance_all() < kFar2_mm2)) break;
    out.solved = *std::ranges::max_element(norm_) < kExact_mm;
    if (out.solved) break;
    for (std::size_t m = 0; m < steps_; ++m) {
      if (norm_[m] < kExact_mm) continue;
      const bool nearer = norm_[m] < before[m];
      damping_[m] =
          nearer ? std::max(least[m], kFaster * damping_[m]) : std::clamp(kSlower * damping_[m], kFirst, kMax);
      if (!nearer) least[m] = 0.5 * damping_[m];
    }
  }
  std::fill(damping_.begin(), damping_.end(), 0.0);
}

StaticEquilibrium::Step StaticEquilibrium::solve(std::span<removal::DeflectedChipSample> chips, std::size_t passing,
                                                 const removal::Stamp& stamp, double share,
                                                 std::span<const Vec2> run_out, std::span<float> row) {
  run_out_ = run_out;
  for (std::size_t m = 0; m < steps_; ++m)
    for (std::size_t i = 0; i < nodes_; ++i)
      for (std::size_t a = 0; a < 2; ++a)
        read_[2 * (m * nodes_ + i) + a] = static_cast<double>(row[2 * (i * steps_ + m) + a]);
  deflection_ = read_;
  place_deflections();
  std::fill(stale_.begin(), stale_.end(), 1);
  place_elements(chips, passing, stamp);
  Step out;
  out.solved = false;
  double left2 = balance_all();
  for (; out.steps < kMaxSteps; ++out.steps) {
    out.solved = *std::ranges::max_element(norm_) < kExact_mm;
    if (out.solved || !(left2 < kFar2_mm2)) break;
    solve_coarse();
    advance();
    const std::vector<double> from = deflection_;
    double way = 1, next2 = 0;
    for (int half = 0;; ++half, way /= 2) {
      for (std::size_t i = 0; i < deflection_.size(); ++i) deflection_[i] = from[i] + way * step_[i];
      next2 = balance_all();
      if (next2 < (1 - 0.1 * way) * left2 || half == kMaxHalvings) break;
    }
    left2 = next2;
  }
  if (!out.solved) creep(out);
  double change2 = 0, size2 = 0;
  std::size_t count = 0;
  for (std::size_t m = 0; m < steps_; ++m) {
    const Vec2 offset = run_out.empty() ? Vec2(Vec2::Zero()) : run_out[m];
    const Vec2 was = Vec2(read_[2 * nodes_ * m], read_[2 * nodes_ * m + 1]) - offset,
               is = Vec2(deflection_[2 * nodes_ * m], deflection_[2 * nodes_ * m + 1]) - offset;
    if (was.norm() < kNothing_mm && is.norm() < kNothing_mm) continue;
    change2 += (is - was).squaredNorm();
    size2 += is.squaredNorm();
    ++count;
  }
  if (count > 0) {
    out.rms_um = 1000 * std::sqrt(change2 / static_cast<double>(count));
    out.size_um = 1000 * std::sqrt(size2 / static_cast<double>(count));
  }
  for (const Element& e : elements_)
    chips[e.chip].chip.thickness_mm =
        static_cast<float>(std::min(e.depth_mm, e.cap_mm) + share * (e.solved_mm - e.thickness_mm));
  for (std::size_t m = 0; m < steps_; ++m)
    for (std::size_t i = 0; i < nodes_; ++i)
      for (std::size_t a = 0; a < 2; ++a) {
        const std::size_t j = 2 * (m * nodes_ + i) + a;
        row[2 * (i * steps_ + m) + a] = static_cast<float>(read_[j] + share * (deflection_[j] - read_[j]));
      }
  return out;
}

}  // namespace camber::deflection
