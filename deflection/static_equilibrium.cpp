// Static equilibrium of one tooth passing: solves delta = C F(chip(delta)) for one reading of the stock.
//
// Overview
//
// Unknowns are the lateral deflections at every node of the axis and every rotation step, and of a tool that yields
// along its axis one axial deflection a step (mm). C is the compliance of tool and holder (mm/N); of a part that bends,
// C F of its heights is added (balance_part). One solve():
//
// 1. place_elements  lists the edge elements of each rotation step, with what the reading tells of their chip: its
//                    depth, the cap that the tool's motion sets, and how both change with the deflection. The chip is
//                    the smaller of the two; the tilt of the deflected envelope (lean_mm) lowers the cap and couples a
//                    step to the steps beside it.
// 2. balance         sums the forces of a step's elements and gives what is left, C F + run-out - delta, and its
//                    derivatives by the deflections at the first and the last node, of the step and of its neighbours.
// 3. solve_coarse    Newton's step: the derivatives at these two nodes stand for all between, so that a step has four
//                    unknowns (five with the axis) and the turn a cyclic block-tridiagonal system, solved by
//                    elimination with the last step as a border.
// 4. advance         gives the step of all nodes; it is halved until what is left falls. Rotation steps that are in
//                    balance to kExact_mm stay, and are not summed again unless a neighbour moves.
// 5. creep           where Newton's method swings about a corner of the force: damped steps, as of a tool that creeps.
//
// static_cut decides how often the stock is read again. Equations and checks: docs/engagement.md, Static coupling.
#include "deflection/static_cut.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <Eigen/LU>

#include "base/vector_clones.h"
#include "deflection/tool_frame.h"

namespace camber::deflection {

namespace {

constexpr int kMaxSteps = 8;
constexpr int kMaxDamped = 60;
constexpr double kExact_mm = 2e-5;  ///< of delta - C F, at any node
constexpr double kFar2_mm2 = 1e4;   ///< no tool bends that far and cuts
constexpr int kMaxHalvings = 5;
constexpr double kNothing_mm = 1e-8;  ///< of a deflection: rows are kept as floats

/// Unknowns of a rotation step: the lateral deflections at the first and at the last node, and of a tool that yields
/// along its axis the axial one.
constexpr int kLateral = 4, kWithAxial = 5;
template <int kUnknowns>
using Coarse = Eigen::Matrix<double, kUnknowns, kUnknowns>;
template <int kUnknowns>
using CoarseDeflection = Eigen::Matrix<double, kUnknowns, 1>;
using LateralDeflection = CoarseDeflection<kLateral>;
using ByCoarse = Eigen::Matrix<double, 2, 4, Eigen::RowMajor>;

Coarse<kLateral> inverse_of(const Coarse<kLateral>& m) { return m.inverse(); }

/// Inverts by blocks: for four unknowns Eigen has a fast inverse.
Coarse<kWithAxial> inverse_of(const Coarse<kWithAxial>& m) {
  const Coarse<kLateral> lateral = Coarse<kLateral>(m.topLeftCorner<4, 4>()).inverse();
  const LateralDeflection from_axial = lateral * m.topRightCorner<4, 1>();
  const Eigen::RowVector4d to_axial = m.bottomLeftCorner<1, 4>() * lateral;
  const double rest = 1 / (m(4, 4) - m.bottomLeftCorner<1, 4>().dot(from_axial.transpose()));
  Coarse<kWithAxial> out;
  out.topLeftCorner<4, 4>() = lateral + rest * from_axial * to_axial;
  out.topRightCorner<4, 1>() = -rest * from_axial;
  out.bottomLeftCorner<1, 4>() = -rest * to_axial;
  out(4, 4) = rest;
  return out;
}

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
      nodes_(model.node_height_mm().size()),
      axial_(model.axial()),
      part_(model.part()) {
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
  for (auto* v :
       {&axial_read_, &axial_deflection_, &axial_moved_, &axial_side_, &axial_left_, &axial_step_, &axial_coarse_})
    v->assign(steps_, 0.0);
  if (axial_) {
    for (auto* v : {&axial_by_own_, &axial_by_side_}) v->assign(steps_ * 5, 0.0);
    for (auto* v : {&by_own_axial_, &by_side_axial_}) v->assign(steps_ * nodes_ * 2, 0.0);
  }
  if (part_) {
    for (const auto& ring : envelope.rings) part_ring_.push_back(height_weight(*part_, ring.profile.height_mm));
    for (auto* v : {&part_N_, &part_mm_}) v->assign(steps_ * part_->size(), 0.0);
    for (auto* v : {&part_by_own_, &part_by_side_}) v->assign(5 * steps_ * part_->size(), 0.0);
  }
  norm_.assign(steps_, 0.0);
  damping_.assign(steps_, 0.0);
  stale_.assign(steps_, 1);
}

void StaticEquilibrium::place_elements(std::span<const removal::DeflectedChipSample> chips, std::size_t passing,
                                       const Motion& motion) {
  model_.edge_elements(chips, passing, motion.of_tool, found_);
  first_.assign(steps_ + 1, 0);
  for (const EdgeElement& e : found_) ++first_[static_cast<std::size_t>(e.step) + 1];
  for (std::size_t m = 0; m < steps_; ++m) first_[m + 1] += first_[m];
  elements_.resize(found_.size());
  max_lean_mm_ = removal::kMaxTilt * motion.of_tool.tip_mm.norm();
  first_stamp_ = motion.first;
  std::vector<std::size_t> at(first_.begin(), first_.end() - 1);
  place_.resize(found_.size());
  for (std::size_t i = 0; i < found_.size(); ++i) place_[i] = at[static_cast<std::size_t>(found_[i].step)]++;
  for_all(found_.size(), found_.size(), [&](std::size_t from, std::size_t end) {
    for (std::size_t i = from; i < end; ++i)
      elements_[place_[i]] = element(found_[i], chips[found_[i].chip], motion.of_tool);
  });
}

StaticEquilibrium::Element StaticEquilibrium::element(const EdgeElement& f, const removal::DeflectedChipSample& bent,
                                                      const removal::ToothMotion& motion) const {
  const Vec3 feed = motion.at(model_.place_mm(bent.chip.point));
  const double node_step = model_.node_height_mm()[1], per_rad = envelope_.steps / (4 * kPi);
  const std::uint32_t r = bent.chip.point / static_cast<std::uint32_t>(envelope_.steps);
  const Ring& ring = rings_[r];
  const EdgeDirections d = model_.direction(bent.chip.point, envelope_.rings[r]);
  Element e;
  e.normal = d.normal.head<2>();
  e.tangential = d.tangential.head<2>();
  e.meridian = d.meridian.head<2>();
  e.deeper = Vec2(static_cast<double>(bent.deeper[0]), static_cast<double>(bent.deeper[1]));
  e.normal_z = d.normal.z(), e.meridian_z = d.meridian.z();
  e.deeper_z = static_cast<double>(bent.deeper[2]);
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

/// Derives from deflection_, at every node, the motion since the reading and the difference of the steps beside it.
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
  if (axial_) place_axial();
}

void StaticEquilibrium::place_axial() {
  for (std::size_t m = 0; m < steps_; ++m) {
    axial_moved_[m] = axial_deflection_[m] - axial_read_[m];
    axial_side_[m] = axial_deflection_[m + 1 == steps_ ? 0 : m + 1] - axial_deflection_[m == 0 ? steps_ - 1 : m - 1];
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
  return e.by_step * (e.normal.dot(at_ring(side_, ring, m)) + e.normal_z * axial_side_[m]) +
         e.by_height * e.normal.dot(Vec2(upper[0] - lower[0], upper[1] - lower[1]));
}

/// C F + run-out - displacement at rotation step m, and how C F changes.
CAMBER_VECTOR_CLONES
void StaticEquilibrium::balance(std::size_t m) {
  const std::size_t from = 2 * m * nodes_;
  double* left = left_.data() + from;
  const Vec2 run_out = run_out_.empty() ? Vec2(Vec2::Zero()) : run_out_[m];
  for (std::size_t i = 0; i < 2 * nodes_; ++i) left[i] = run_out[i % 2 == 0 ? 0 : 1] - deflection_[from + i];
  std::fill_n(by_own_.data() + 4 * from, 8 * nodes_, 0.0);
  std::fill_n(by_side_.data() + 4 * from, 8 * nodes_, 0.0);
  if (axial_) {
    axial_left_[m] = -axial_deflection_[m];
    for (auto* v : {&axial_by_own_, &axial_by_side_}) std::fill_n(v->data() + 5 * m, 5, 0.0);
    for (auto* v : {&by_own_axial_, &by_side_axial_}) std::fill_n(v->data() + from, 2 * nodes_, 0.0);
  }
  if (part_) {
    const std::size_t size = part_->size();
    std::fill_n(part_N_.data() + m * size, size, 0.0);
    for (auto* v : {&part_by_own_, &part_by_side_}) std::fill_n(v->data() + 5 * m * size, 5 * size, 0.0);
  }
  const machine::Material& material = model_.material();
  const double ramp = model_.edge_ramp_mm();
  const double nodes_apart = model_.node_height_mm()[1] / model_.node_height_mm().back();
  const auto bounded = [&](double v) { return std::clamp(v, -max_lean_mm_, max_lean_mm_); };
  for (std::size_t i = first_[m]; i < first_[m + 1]; ++i) {
    Element& e = elements_[i];
    const Ring& ring = rings_[e.ring];
    const Vec2 moved = at_ring(moved_, ring, m);
    const double depth = e.depth_mm + e.deeper.dot(moved) + e.deeper_z * axial_moved_[m], lean = lean_mm(e, m);
    const double cap = e.cap_mm + (first_stamp_ ? 0.0 : e.normal.dot(moved) + e.normal_z * axial_moved_[m]) -
                       (bounded(lean) - bounded(e.lean_mm));
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
    ThicknessChange by{.own = {(1 - up) * own.x(), (1 - up) * own.y(), up * own.x(), up * own.y()}};
    const bool leans = by_cap && std::abs(lean) < max_lean_mm_;
    if (leans) {
      const double along = e.by_height * nodes_apart;
      for (std::size_t a = 0; a < 2; ++a) {
        const double n = e.normal[static_cast<Eigen::Index>(a)];
        by.own[a] += along * n;
        by.own[2 + a] -= along * n;
        by.side[a] = -e.by_step * (1 - up) * n;
        by.side[2 + a] = -e.by_step * up * n;
      }
    }
    if (axial_) {
      by.own_axial = !by_cap ? e.deeper_z : first_stamp_ ? 0.0 : e.normal_z;
      by.side_axial = leans ? -e.by_step * e.normal_z : 0.0;
      const auto along = [&](const EdgeForce& of) { return -(of.radial_N * e.normal_z + of.axial_N * e.meridian_z); };
      balance_axial(m, along(f), e.width_mm * along(k), by);
      if (part_) gather_part(e, m, force, along(f), slope, e.width_mm * along(k), by);
    }
    for (std::size_t n = 0; n < nodes_; ++n) {
      const Vec2 c = model_.compliance_mm_per_N(e.ring, n);
      for (int a = 0; a < 2; ++a) {
        const std::size_t row = 2 * n + static_cast<std::size_t>(a);
        left[row] += c[a] * force[a];
        const double change = c[a] * slope[a];
        double* of_own = by_own_.data() + 4 * (from + row);
        double* of_side = by_side_.data() + 4 * (from + row);
        for (std::size_t b = 0; b < 4; ++b) of_own[b] += change * by.own[b];
        if (leans)
          for (std::size_t b = 0; b < 4; ++b) of_side[b] += change * by.side[b];
        if (!axial_) continue;
        by_own_axial_[from + row] += change * by.own_axial;
        by_side_axial_[from + row] += change * by.side_axial;
      }
    }
  }
}

void StaticEquilibrium::balance_axial(std::size_t m, double force_z, double slope_z, const ThicknessChange& by) {
  const double c = model_.axial_compliance_mm_per_N(), change = c * slope_z;
  axial_left_[m] += c * force_z;
  for (std::size_t b = 0; b < 4; ++b) {
    axial_by_own_[5 * m + b] += change * by.own[b];
    axial_by_side_[5 * m + b] += change * by.side[b];
  }
  axial_by_own_[5 * m + 4] += change * by.own_axial;
  axial_by_side_[5 * m + 4] += change * by.side_axial;
}

/// Adds the force of an element to what the part's heights take.
void StaticEquilibrium::gather_part(const Element& e, std::size_t m, const Vec2& force, double force_z,
                                    const Vec2& slope, double slope_z, const ThicknessChange& by) {
  const std::size_t size = part_->size();
  const auto add = [&](std::size_t i, double f, double change) {
    const std::size_t at = m * size + i;
    part_N_[at] += f;
    double *own = part_by_own_.data() + 5 * at, *side = part_by_side_.data() + 5 * at;
    for (std::size_t b = 0; b < 4; ++b) own[b] += change * by.own[b], side[b] += change * by.side[b];
    own[4] += change * by.own_axial, side[4] += change * by.side_axial;
  };
  const HeightWeight& w = part_ring_[e.ring];
  for (std::size_t a = 0; a < 2; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    add(2 * w.lower + a, w.of_lower() * force[i], w.of_lower() * slope[i]);
    add(2 * w.lower + 2 + a, w.upper_fraction * force[i], w.upper_fraction * slope[i]);
  }
  add(size - 1, force_z, slope_z);
}

/// Enters in the balance the motion of the part at rotation step m, and its derivatives.
void StaticEquilibrium::balance_part(std::size_t m) {
  const auto size = static_cast<Eigen::Index>(part_->size());
  const auto first = static_cast<std::ptrdiff_t>(m) * size;
  using Changes = Eigen::Matrix<double, Eigen::Dynamic, 5, Eigen::RowMajor>;
  const Eigen::VectorXd moved = part_mm_per_N_ * Eigen::Map<const Eigen::VectorXd>(part_N_.data() + first, size);
  const Changes own = part_mm_per_N_ * Eigen::Map<const Changes>(part_by_own_.data() + 5 * first, size, 5),
                side = part_mm_per_N_ * Eigen::Map<const Changes>(part_by_side_.data() + 5 * first, size, 5);
  Eigen::Map<Eigen::VectorXd>(part_mm_.data() + first, size) = moved;
  for (std::size_t n = 0; n < nodes_; ++n) {
    const HeightWeight w = height_weight(*part_, model_.node_height_mm()[n]);
    for (std::size_t a = 0; a < 2; ++a) {
      const std::size_t at = 2 * (m * nodes_ + n) + a;
      const auto lower = static_cast<Eigen::Index>(2 * w.lower + a);
      const auto mix = [&](const auto& of) { return w.of_lower() * of(lower) + w.upper_fraction * of(lower + 2); };
      left_[at] += mix([&](Eigen::Index i) { return moved[i]; });
      for (Eigen::Index b = 0; b < 4; ++b) {
        by_own_[4 * at + static_cast<std::size_t>(b)] += mix([&](Eigen::Index i) { return own(i, b); });
        by_side_[4 * at + static_cast<std::size_t>(b)] += mix([&](Eigen::Index i) { return side(i, b); });
      }
      by_own_axial_[at] += mix([&](Eigen::Index i) { return own(i, 4); });
      by_side_axial_[at] += mix([&](Eigen::Index i) { return side(i, 4); });
    }
  }
  axial_left_[m] += moved[size - 1];
  for (Eigen::Index b = 0; b < 5; ++b) {
    axial_by_own_[5 * m + static_cast<std::size_t>(b)] += own(size - 1, b);
    axial_by_side_[5 * m + static_cast<std::size_t>(b)] += side(size - 1, b);
  }
}

/// Goes `share` of the way to the part's deflection in the second half of a row.
void StaticEquilibrium::keep_part(double share, std::span<float> row) const {
  const std::span<float> part = row.last(row.size() / 2);
  const removal::AxialRow axial(part.last(2 * steps_));
  const auto towards = [&](double was, double is) { return was + share * (is - was); };
  for (std::size_t m = 0; m < steps_; ++m) {
    const Eigen::VectorXd moved = Eigen::Map<const Eigen::VectorXd>(part_mm_.data() + m * part_->size(),
                                                                    static_cast<Eigen::Index>(part_->size()));
    for (std::size_t n = 0; n < nodes_; ++n) {
      const Vec2 at = lateral_at(*part_, model_.node_height_mm()[n], moved);
      for (std::size_t a = 0; a < 2; ++a) {
        float& v = part[2 * (n * steps_ + m) + a];
        v = static_cast<float>(towards(static_cast<double>(v), at[static_cast<Eigen::Index>(a)]));
      }
    }
    axial.set(m, towards(axial.at(m), moved[moved.size() - 1]));
  }
}

/// (1 - own_m) x_m - side_m (x_(m+1) - x_(m-1)) = left_m around the turn, for the deflections x at the first and last
/// node, and along the axis: elimination with the last step's deflection kept as a border.
template <int kUnknowns>
void StaticEquilibrium::solve_coarse() {
  using Block = Coarse<kUnknowns>;
  using Deflection = CoarseDeflection<kUnknowns>;
  const std::size_t n = steps_;
  const auto block = [&](bool of_side, std::size_t m) {
    const std::vector<double>& v = of_side ? by_side_ : by_own_;
    Block out;
    for (int half = 0; half < 2; ++half) {
      const std::size_t node = half == 0 ? 0 : nodes_ - 1;
      out.template block<2, 4>(2 * half, 0) = Eigen::Map<const ByCoarse>(v.data() + 8 * (m * nodes_ + node));
      if constexpr (kUnknowns == kWithAxial)
        out.template block<2, 1>(2 * half, 4) =
            Eigen::Map<const Vec2>((of_side ? by_side_axial_ : by_own_axial_).data() + 2 * (m * nodes_ + node));
    }
    if constexpr (kUnknowns == kWithAxial)
      out.row(4) =
          Eigen::Map<const Eigen::Matrix<double, 1, 5>>((of_side ? axial_by_side_ : axial_by_own_).data() + 5 * m);
    return out;
  };
  // x_m = value_m - ahead_m x_(m+1) - border_m x_last.
  static thread_local std::vector<Block> ahead, border;
  static thread_local std::vector<Deflection> value;
  ahead.resize(n), border.resize(n), value.resize(n);
  const auto right = [&](std::size_t m) {
    Deflection out;
    const double* first = left_.data() + 2 * m * nodes_;
    const double* last = first + 2 * (nodes_ - 1);
    out.template head<4>() << first[0], first[1], last[0], last[1];
    if constexpr (kUnknowns == kWithAxial) out[4] = axial_left_[m];
    return out;
  };
  const auto keep = [&](std::size_t m, const Deflection& x) {
    Eigen::Map<LateralDeflection>(coarse_.data() + 4 * m) = x.template head<4>();
    if constexpr (kUnknowns == kWithAxial) axial_coarse_[m] = x[4];
  };
  for (std::size_t m = 0; m + 1 < n; ++m) {
    if (first_[m] == first_[m + 1]) {  // out of the cut
      value[m] = right(m) / (1 + damping_[m]);
      ahead[m].setZero(), border[m].setZero();
      continue;
    }
    const Block side = block(true, m);
    Block own = (1 + damping_[m]) * Block::Identity() - block(false, m);
    Deflection r = right(m);
    Block b = Block::Zero();
    if (m == 0) {
      b = side;
    } else {
      own -= side * ahead[m - 1];
      r -= side * value[m - 1];
      b = -side * border[m - 1];
    }
    Block a = -side;
    if (m + 2 == n) b += a, a.setZero();
    const Block inverse = inverse_of(own);
    value[m] = inverse * r;
    ahead[m] = inverse * a;
    border[m] = inverse * b;
  }
  // The first step's deflection by the last one's.
  Deflection first_value = value[n - 2];
  Block first_border = border[n - 2];
  const Deflection before_value = first_value;
  const Block before_border = first_border;
  for (std::size_t m = n - 2; m-- > 0;) {
    first_value = value[m] - ahead[m] * first_value;
    first_border = border[m] - ahead[m] * first_border;
  }
  const Block side = block(true, n - 1);
  const Block own =
      (1 + damping_[n - 1]) * Block::Identity() - block(false, n - 1) + side * first_border - side * before_border;
  Deflection x = own.partialPivLu().solve(right(n - 1) + side * first_value - side * before_value);
  const Deflection last = x;
  keep(n - 1, x);
  for (std::size_t m = n - 1; m-- > 0;) {
    x = value[m] - (m + 2 == n ? Deflection(Deflection::Zero()) : Deflection(ahead[m] * x)) - border[m] * last;
    keep(m, x);
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
      if (part_) balance_part(m);
      norm_[m] = Eigen::Map<const Eigen::VectorXd>(left_.data() + 2 * m * nodes_, row).lpNorm<Eigen::Infinity>();
      if (axial_) norm_[m] = std::max(norm_[m], std::abs(axial_left_[m]));
    }
  });
  const auto squares = [](const std::vector<double>& v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())).squaredNorm();
  };
  return axial_ ? squares(left_) + squares(axial_left_) : squares(left_);
}

/// Newton's step of all nodes; rotation steps in balance stay.
void StaticEquilibrium::advance() {
  for (std::size_t m = 0; m < steps_; ++m) {
    const std::size_t ahead = m + 1 == steps_ ? 0 : m + 1, behind = m == 0 ? steps_ - 1 : m - 1;
    const Eigen::Map<const LateralDeflection> own(coarse_.data() + 4 * m);
    const LateralDeflection side = Eigen::Map<const LateralDeflection>(coarse_.data() + 4 * ahead) -
                                   Eigen::Map<const LateralDeflection>(coarse_.data() + 4 * behind);
    const bool stays =
        norm_[m] < kExact_mm && own.lpNorm<Eigen::Infinity>() < kExact_mm && std::abs(axial_coarse_[m]) < kExact_mm;
    for (std::size_t i = 2 * m * nodes_; i < 2 * (m + 1) * nodes_; ++i)
      step_[i] = stays ? 0.0
                       : (left_[i] + Eigen::Map<const Eigen::RowVector4d>(by_own_.data() + 4 * i).dot(own) +
                          Eigen::Map<const Eigen::RowVector4d>(by_side_.data() + 4 * i).dot(side)) /
                             (1 + damping_[m]);
    if (axial_) advance_axial(m, ahead, behind, stays);
    stale_[m] = stays ? 0 : 1;
  }
  const std::vector<char> moves = stale_;
  for (std::size_t m = 0; m < steps_; ++m)
    if (moves[m] != 0) stale_[m + 1 == steps_ ? 0 : m + 1] = stale_[m == 0 ? steps_ - 1 : m - 1] = 1;
}

/// Newton's step of the axial deflection, and what that adds to the lateral one's.
void StaticEquilibrium::advance_axial(std::size_t m, std::size_t ahead, std::size_t behind, bool stays) {
  axial_step_[m] = stays ? 0.0 : axial_coarse_[m];
  if (stays) return;
  const double side = axial_coarse_[ahead] - axial_coarse_[behind];
  for (std::size_t i = 2 * m * nodes_; i < 2 * (m + 1) * nodes_; ++i)
    step_[i] += (by_own_axial_[i] * axial_coarse_[m] + by_side_axial_[i] * side) / (1 + damping_[m]);
}

void StaticEquilibrium::step_from(const std::vector<double>& from, const std::vector<double>& axial_from, double way) {
  for (std::size_t i = 0; i < deflection_.size(); ++i) deflection_[i] = from[i] + way * step_[i];
  if (!axial_) return;
  for (std::size_t m = 0; m < steps_; ++m) axial_deflection_[m] = axial_from[m] + way * axial_step_[m];
}

/// Where Newton's method swings about a corner of the force: a tool that creeps towards the balance, as a damped one
/// would, comes to rest at a balance that is stable. Rotation steps that come nearer creep faster.
void StaticEquilibrium::creep(Step& out) {
  constexpr double kFirst = 0.5, kMax = 4, kFaster = 0.4, kSlower = 2;
  std::vector<double> least(steps_, 0.0);
  for (std::size_t m = 0; m < steps_; ++m) damping_[m] = norm_[m] < kExact_mm ? 0 : kFirst;
  for (int step = 0; step < kMaxDamped; ++step, ++out.steps) {
    const std::vector<double> before = norm_;
    axial_ ? solve_coarse<kWithAxial>() : solve_coarse<kLateral>();
    advance();
    step_from(deflection_, axial_deflection_, 1);
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
                                                 const Motion& motion, double share, std::span<const Vec2> run_out,
                                                 std::span<float> row) {
  run_out_ = run_out;
  if (part_) part_mm_per_N_ = part_->at(passing);
  for (std::size_t m = 0; m < steps_; ++m)
    for (std::size_t i = 0; i < nodes_; ++i)
      for (std::size_t a = 0; a < 2; ++a)
        read_[2 * (m * nodes_ + i) + a] = static_cast<double>(row[2 * (i * steps_ + m) + a]);
  const removal::AxialRow axial_row(axial_ ? row.subspan(2 * steps_ * nodes_, 2 * steps_) : std::span<float>());
  for (std::size_t m = 0; axial_ && m < steps_; ++m) axial_read_[m] = axial_row.at(m);
  deflection_ = read_;
  axial_deflection_ = axial_read_;
  place_deflections();
  std::fill(stale_.begin(), stale_.end(), 1);
  place_elements(chips, passing, motion);
  Step out;
  out.solved = false;
  double left2 = balance_all();
  for (; out.steps < kMaxSteps; ++out.steps) {
    out.solved = *std::ranges::max_element(norm_) < kExact_mm;
    if (out.solved || !(left2 < kFar2_mm2)) break;
    axial_ ? solve_coarse<kWithAxial>() : solve_coarse<kLateral>();
    advance();
    const std::vector<double> from = deflection_, axial_from = axial_deflection_;
    double way = 1, next2 = 0;
    for (int half = 0;; ++half, way /= 2) {
      step_from(from, axial_from, way);
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
    const double axial_was = axial_read_[m], axial_is = axial_deflection_[m];
    if (was.norm() < kNothing_mm && is.norm() < kNothing_mm && std::abs(axial_was) < kNothing_mm &&
        std::abs(axial_is) < kNothing_mm)
      continue;
    change2 += (is - was).squaredNorm() + (axial_is - axial_was) * (axial_is - axial_was);
    size2 += is.squaredNorm() + axial_is * axial_is;
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
  for (std::size_t m = 0; axial_ && m < steps_; ++m)
    axial_row.set(m, axial_read_[m] + share * (axial_deflection_[m] - axial_read_[m]));
  if (part_) keep_part(share, row);
  return out;
}

}  // namespace camber::deflection
