// ToothPassModel on chips in blocks: the same sums as one chip at a time, four rotation steps side by side.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/vector_clones.h"
#include "deflection/chip_ends.h"
#include "deflection/tool_frame.h"
#include "deflection/tooth_pass.h"
#include "machine/force_law.h"
#include "removal/engagement.h"

namespace camber::deflection {

using removal::EnvelopeBlocks;

namespace {

constexpr int kSteps = EnvelopeBlocks::kSteps;

/// Forces of four chips of one ring, N, in the components of edge_force.
struct EdgeForces {
  std::array<double, kSteps> tangential, radial, axial;
};

/// Places of four chips, and the sums that their forces are added to.
struct Sums {
  const float *cosine_phi, *sine_phi;
  double sine, cosine;  ///< of the ring's normal angle
  double radius_mm;
  const double* compliance;  ///< [nodes] of the ring, mm/N
  double axis_x, axis_y;     ///< compliance of the machine's axes, mm/N
  int nodes, row;            ///< of deflection: steps, filled up
  const double* gathering;   ///< [heights] of the ring: shares of the force that the part takes at its heights
  int heights;               ///< 0: the part does not yield
  double *fx, *fy, *fz, *torque, *deflection, *gathered;
};

CAMBER_VECTOR_CLONES
void add_four(const EdgeForces& e, const Sums& s) {
  std::array<double, kSteps> x, y;
  for (std::size_t l = 0; l < kSteps; ++l) {
    const LoadComponents f = load_components(e.tangential[l], e.radial[l], e.axial[l], s.sine, s.cosine, s.sine_phi[l],
                                             s.cosine_phi[l], s.radius_mm);
    x[l] = f.x, y[l] = f.y;
    s.fx[l] += f.x;
    s.fy[l] += f.y;
    s.fz[l] += f.z;
    s.torque[l] += f.torque;
  }
  for (int n = 0; n < s.nodes; ++n) {
    const double wx = s.compliance[n] + s.axis_x, wy = s.compliance[n] + s.axis_y;
    double *dx = s.deflection + 2 * n * s.row, *dy = dx + s.row;
    for (std::size_t l = 0; l < kSteps; ++l) dx[l] += wx * x[l];
    for (std::size_t l = 0; l < kSteps; ++l) dy[l] += wy * y[l];
  }
  for (int i = 0; i < s.heights; ++i) {
    const double share = s.gathering[i];
    double *gx = s.gathered + 2 * i * s.row, *gy = gx + s.row;
    for (std::size_t l = 0; l < kSteps; ++l) gx[l] += share * x[l];
    for (std::size_t l = 0; l < kSteps; ++l) gy[l] += share * y[l];
  }
}

/// Writes to `e` the forces by an affine law (K h + K_e) without an edge ramp.
inline void affine_forces(const EdgeForce& k_MPa, const machine::Material& m, const float* h,
                          const std::uint8_t* cut_255, double width, EdgeForces& e) {
  const double width_255 = width / 255;
  for (std::size_t l = 0; l < kSteps; ++l) {
    const double thickness = h[l], cuts = h[l] > 0 ? cut_255[l] * width_255 : 0.0;
    e.tangential[l] = (k_MPa.tangential_N * thickness + m.kte_N_per_mm) * cuts;
    e.radial[l] = (k_MPa.radial_N * thickness + m.kre_N_per_mm) * cuts;
    e.axial[l] = (k_MPa.axial_N * thickness + m.kae_N_per_mm) * cuts;
  }
}

}  // namespace

/// Adds the end of a chip to the sums, which count every sample whole: the chip fades linearly to the next step.
void ToothPassModel::add_end(const ChipEnd& e, double* sums, std::size_t row, std::span<float> fine_mm,
                             std::span<double> fine_N) const {
  const auto& ring = envelope_.rings[static_cast<std::size_t>(e.ring)];
  const int pitch = envelope_.steps_per_pitch, turn = pitch * kFine;
  const double width = e.width_fraction * ring.width_mm;
  const double half = std::max(e.ramp, 1.0 / kFine) / 2;
  const double c = envelope_.cos_phi[e.point], sn = envelope_.sin_phi[e.point];
  const double sine = ring.sine, cosine = ring.cosine;
  const std::size_t nodes = node_height_mm_.size();
  const double* compliance = compliance_.data() + static_cast<std::size_t>(e.ring) * nodes;
  const bool affine = machine::is_affine(material_.law) && edge_ramp_mm_ == 0;
  const auto on_tool = [&](const EdgeForce& f) {
    const LoadComponents on =
        load_components(f.tangential_N, f.radial_N, f.axial_N, sine, cosine, sn, c, ring.profile.radius_mm);
    return std::array<double, 4>{on.x, on.y, on.z, on.torque};
  };
  // Affine: a millimetre of thickness, and the edge.
  const EdgeForce k = affine ? edge_force_slope(material_, 1) : EdgeForce{};
  const auto per_mm = on_tool({k.tangential_N * width, k.radial_N * width, k.axial_N * width});
  const auto edge =
      on_tool({material_.kte_N_per_mm * width, material_.kre_N_per_mm * width, material_.kae_N_per_mm * width});
  const int first = static_cast<int>(std::ceil(std::min(0.0, e.at - half) * kFine));
  const int last = static_cast<int>(std::floor(std::max(1.0, e.at + half) * kFine));
  for (int j = first; j <= last; ++j) {
    const double u = static_cast<double>(j) / kFine;
    const double share = std::clamp((e.at - u) / (2 * half) + 0.5, 0.0, 1.0);
    if ((u <= 0 && share == 1) || (u >= 1 && share == 0)) continue;
    // On the way back from the sample, steps: the line to the sample before.
    const double back = std::max(0.0, -u), drawn = e.thickness_mm + back * (e.inside_mm - e.thickness_mm);
    // Over the part of the ring that is in the cut the chip falls evenly to nothing. Nowhere is it thicker than the
    // chip that it is the end of, however steep the fall.
    const double most = std::max(e.thickness_mm, e.inside_mm) + back * std::max(0.0, e.inside_mm - e.thickness_mm);
    const double thickness =
        e.fall_mm > 0
            ? std::min(most, e.fall_mm * (std::max(0.0, e.at + half - u) + std::max(0.0, e.at - half - u)) / 2)
            : drawn;
    const double left = std::clamp(1 - u, 0.0, 1.0);  // of the line to the sample that is out of the cut
    std::array<double, 4> f;
    if (affine) {
      const double h = share * thickness - left * drawn, b = share - left;
      for (std::size_t i = 0; i < 4; ++i) f[i] = h * per_mm[i] + b * edge[i];
    } else {
      const auto is = on_tool(edge_force(material_, share > 0 ? thickness : 0, share * width, edge_ramp_mm_));
      const auto was = on_tool(edge_force(material_, drawn, left * width, edge_ramp_mm_));
      for (std::size_t i = 0; i < 4; ++i) f[i] = is[i] - was[i];
    }
    int at = e.step * kFine + e.side * j;
    at += at < 0 ? turn : at >= turn ? -turn : 0;
    if (!fine_mm.empty()) {
      float* d = fine_mm.data() + 2 * at;
      for (std::size_t n = 0; n < nodes; ++n, d += 2 * turn) {
        d[0] += static_cast<float>((compliance[n] + axis_compliance_.x()) * f[0]);
        d[1] += static_cast<float>((compliance[n] + axis_compliance_.y()) * f[1]);
      }
      if (axial()) {
        const auto z = static_cast<float>(axial_compliance_mm_per_N_ * f[2]);
        d[0] += z;
        d[at > 0 ? -1 : 2 * turn - 1] += z;  // of the step before: the next one's
      }
    }
    if (!fine_N.empty()) {
      const HeightWeight w = part_weight_[static_cast<std::size_t>(e.ring)];
      double* g = fine_N.data() + 2 * w.lower * static_cast<std::size_t>(turn) + static_cast<std::size_t>(at);
      g[0] += w.of_lower() * f[0], g[turn] += w.of_lower() * f[1];
      g[2 * turn] += w.upper_fraction * f[0], g[3 * turn] += w.upper_fraction * f[1];
      fine_N[2 * part_->heights() * static_cast<std::size_t>(turn) + static_cast<std::size_t>(at)] += f[2];
    }
    if (j % kFine == 0)
      for (std::size_t i = 0; i < 4; ++i) sums[i * row + static_cast<std::size_t>(at / kFine)] += f[i];
  }
}

namespace {

/// Deflections along x and y, [count] each, with straight lines between the steps.
void draw_between_steps(const double* x, const double* y, std::size_t count, float* fine) {
  for (std::size_t m = 0; m < count; ++m) {
    const std::size_t next = m + 1 < count ? m + 1 : 0;
    if (x[m] == 0 && y[m] == 0 && x[next] == 0 && y[next] == 0) {
      std::fill_n(fine, 2 * kFine, 0.0f);
      fine += 2 * kFine;
      continue;
    }
    const double dx = (x[next] - x[m]) / kFine, dy = (y[next] - y[m]) / kFine;
    for (int i = 0; i < kFine; ++i) {
      *fine++ = static_cast<float>(x[m] + i * dx);
      *fine++ = static_cast<float>(y[m] + i * dy);
    }
  }
}

/// Draws a row of values with straight lines between the steps.
void draw_row(const double* x, std::size_t count, double* fine) {
  for (std::size_t m = 0; m < count; ++m) {
    const double next = x[m + 1 < count ? m + 1 : 0];
    for (int i = 0; i < kFine; ++i) *fine++ = x[m] + i * (next - x[m]) / kFine;
  }
}

/// The same of axial deflections, compliance times force: of each fine step its own and the next one's.
void draw_axial(const double* force, double compliance, std::size_t count, float* fine) {
  const auto at = [&](std::size_t i) {
    const std::size_t m = i / kFine % count, next = m + 1 < count ? m + 1 : 0;
    const double u = static_cast<double>(i % kFine) / kFine;
    return static_cast<float>(compliance * (force[m] + u * (force[next] - force[m])));
  };
  for (std::size_t i = 0; i < count * kFine; ++i) {
    *fine++ = at(i);
    *fine++ = at(i + 1);
  }
}

}  // namespace

namespace {

/// Sums of one tooth passing: forces along x, y, z, torque, then deflections along x and y by nodes, then forces along
/// x and y by the part's heights; a row of each by rotation step, with room for a block on both sides of the pitch.
class PassSums {
 public:
  static constexpr int kAside = kSteps;
  PassSums(std::size_t steps, std::size_t nodes, std::size_t heights)
      : nodes_(static_cast<int>(nodes)),
        heights_(static_cast<int>(heights)),
        row_((steps + kSteps - 1) / kSteps * kSteps + 2 * kAside) {
    thread_local std::vector<double> room;
    room.assign((4 + 2 * (nodes + heights)) * row_, 0.0);
    values_ = room.data();
  }
  std::size_t row() const { return row_; }
  /// Row i from the first step of the pitch on.
  double* of(std::size_t i) const { return values_ + i * row_ + kAside; }
  Sums at(int step) const {
    Sums s{};
    s.nodes = nodes_, s.row = static_cast<int>(row_);
    s.fx = of(0) + step, s.fy = of(1) + step, s.fz = of(2) + step, s.torque = of(3) + step;
    s.deflection = of(4) + step;
    s.heights = heights_;
    s.gathered = of(4 + 2 * static_cast<std::size_t>(nodes_)) + step;
    return s;
  }

 private:
  int nodes_, heights_;
  std::size_t row_;
  double* values_;
};

}  // namespace

void ToothPassModel::add_part(std::size_t passing, std::span<const double> fine_N, std::span<float> fine) const {
  const std::size_t size = part_->size(), count = fine_N.size() / size, nodes = node_height_mm_.size();
  const Eigen::MatrixXd compliance = part_->at(passing);
  const std::span<float> whole = fine.first(fine.size() / 2), part = fine.last(fine.size() / 2);
  std::fill(part.begin(), part.end(), 0.0f);
  const removal::AxialRow axial_whole(whole.last(2 * count)), axial_part(part.last(2 * count));
  Eigen::VectorXd force(static_cast<Eigen::Index>(size));
  for (std::size_t j = 0; j < count; ++j) {
    for (std::size_t i = 0; i < size; ++i) force[static_cast<Eigen::Index>(i)] = fine_N[i * count + j];
    if (force.isZero(0)) continue;
    const Eigen::VectorXd moved = compliance * force;
    for (std::size_t n = 0; n < nodes; ++n) {
      const Vec2 at = lateral_at(*part_, node_height_mm_[n], moved);
      for (std::size_t a = 0; a < 2; ++a)
        part[2 * (n * count + j) + a] = static_cast<float>(at[static_cast<Eigen::Index>(a)]);
    }
    axial_part.set(j, moved[static_cast<Eigen::Index>(size) - 1]);
  }
  std::transform(whole.begin(), whole.end(), part.begin(), whole.begin(), std::plus<>());
}

removal::ChipBlock ToothPassModel::tooth_block(int j, const EnvelopeBlocks& blocks, const removal::ChipBlock& even,
                                               const removal::ToothMotion& of_tool) const {
  removal::ChipBlock own = even;
  for (int lane = 0; lane < EnvelopeBlocks::kLanes; ++lane) {
    const auto l = static_cast<std::size_t>(lane);
    const std::uint32_t p = blocks.point(even.block, lane);
    if (even.thickness_mm[l] == 0 || p == EnvelopeBlocks::kNoPoint) continue;
    const auto& ring = envelope_.rings[p / static_cast<std::uint32_t>(envelope_.steps)];
    const MotionChip motion = motion_chip(direction(p, ring), ring, of_tool.at(place_mm(p)));
    const double thickness = even.thickness_mm[l];
    // Where even teeth would not cut, only what the teeth before have left is as near as the motion tells.
    constexpr double kSame_mm = 1e-4;
    const bool after_tooth =
        (even.after_tooth >> lane & 1u) != 0 || (thickness < 0 && thickness > motion.even_mm - kSame_mm);
    const double room =
        teeth_.room_mm(j, after_tooth ? thickness : motion.even_mm, ring.sine, ring.lag_rad, motion.bulge_mm);
    own.thickness_mm[l] = static_cast<float>(
        after_tooth ? room : std::min(room, thickness + deeper_mm(j, (even.own_surface >> lane & 1u) != 0, ring)));
  }
  return own;
}

void ToothPassModel::evaluate(const EnvelopeBlocks& blocks, std::span<const removal::ChipBlock> chips,
                              std::size_t passing, const removal::ToothMotion& motion, ToothPass& out,
                              std::span<float> fine) const {
  const int turn = envelope_.steps, pitch = envelope_.steps_per_pitch;
  const auto steps = static_cast<std::size_t>(pitch);
  const std::size_t all_nodes = node_height_mm_.size(), nodes = fine.empty() ? 0 : all_nodes;
  const int last = static_cast<int>(envelope_.rings.size()) - 1;
  const std::size_t heights = part_ && !fine.empty() ? part_->heights() : 0;
  const PassSums sums(steps, nodes, heights);
  thread_local std::vector<double> gathering;
  gathering.resize(heights);
  out.chip_max_mm = out.chip_area_mm2 = 0;
  const bool affine = machine::is_affine(material_.law) && edge_ramp_mm_ == 0;
  const EdgeForce k = affine ? edge_force_slope(material_, 1) : EdgeForce{};
  float thickest = 0;
  const auto add_block = [&](const removal::ChipBlock& chip, int step) {
    Sums s = sums.at(step);
    s.axis_x = axis_compliance_.x(), s.axis_y = axis_compliance_.y();
    const int first_ring = blocks.block(chip.block).ring;
    for (int half = 0; half < EnvelopeBlocks::kRings; ++half) {
      const float* h = chip.thickness_mm.data() + half * kSteps;
      const std::uint8_t* cut_255 = chip.cut_255.data() + half * kSteps;
      int cut_of_all = 0;
      for (int l = 0; l < kSteps; ++l) {
        cut_of_all += h[l] > 0 ? cut_255[l] : 0;
        thickest = std::max(thickest, h[l]);
      }
      if (cut_of_all == 0) continue;
      const int r = std::min(first_ring + half, last);
      const auto& ring = envelope_.rings[static_cast<std::size_t>(r)];
      EdgeForces e;
      if (affine) {
        affine_forces(k, material_, h, cut_255, ring.width_mm, e);
      } else {
        for (std::size_t l = 0; l < kSteps; ++l) {
          const EdgeForce f = edge_force(material_, h[l], cut_255[l] / 255.0 * ring.width_mm, edge_ramp_mm_);
          e.tangential[l] = f.tangential_N, e.radial[l] = f.radial_N, e.axial[l] = f.axial_N;
        }
      }
      out.chip_area_mm2 += cut_of_all / 255.0 * ring.width_mm * 2 * kPi * ring.profile.radius_mm / turn;
      s.cosine_phi = blocks.cos_phi(chip.block) + half * kSteps;
      s.sine_phi = blocks.sin_phi(chip.block) + half * kSteps;
      s.sine = ring.sine, s.cosine = ring.cosine;
      s.radius_mm = ring.profile.radius_mm;
      s.compliance = compliance_.data() + static_cast<std::size_t>(r) * all_nodes;
      if (heights > 0) {
        const HeightWeight w = part_weight_[static_cast<std::size_t>(r)];
        std::fill(gathering.begin(), gathering.end(), 0.0);
        gathering[w.lower] = w.of_lower(), gathering[w.lower + 1] = w.upper_fraction;
        s.gathering = gathering.data();
      }
      add_four(e, s);
    }
  };
  thread_local ChipEnds finder;
  thread_local std::vector<ChipEnd> uneven_ends;
  std::span<const ChipEnd> ends;
  if (teeth_.even()) {
    for (const removal::ChipBlock& chip : chips) add_block(chip, blocks.block(chip.block).step);
    ends = finder.find(envelope_, blocks, chips);
  } else {
    uneven_ends.clear();
    const int gone = static_cast<int>(passing % static_cast<std::size_t>(teeth_.count())) * pitch;
    thread_local std::vector<removal::ChipBlock> own;
    for (int j = 0; j < teeth_.count(); ++j) {
      // Rotation step at which the tooth is at a point.
      const int ahead = gone - tooth_step_[static_cast<std::size_t>(j)];
      const auto step_at = [&](std::uint32_t p) { return ((static_cast<int>(p) % turn + ahead) % turn + turn) % turn; };
      own.clear();
      for (const removal::ChipBlock& chip : chips) {
        // What lies beside the pitch tells where the chips in it end.
        int step = step_at(blocks.point(chip.block, 0));
        if (step >= pitch + kSteps) step -= turn;
        if (step < -2 * kSteps) continue;
        own.push_back(tooth_block(j, blocks, chip, motion));
        removal::ChipBlock in_pitch = own.back();
        for (int lane = 0; lane < EnvelopeBlocks::kLanes; ++lane)
          if (const int m = step + lane % kSteps; m < 0 || m >= pitch)
            in_pitch.thickness_mm[static_cast<std::size_t>(lane)] = 0;
        if (step > -kSteps && step < pitch) add_block(in_pitch, step);
      }
      for (ChipEnd e : finder.find(envelope_, blocks, own)) {
        e.step = step_at(e.point);
        if (e.step < pitch) uneven_ends.push_back(e);
      }
    }
    ends = uneven_ends;
  }
  out.chip_max_mm = thickest;
  for (std::size_t n = 0; n < nodes; ++n) {
    const double* x = sums.of(4 + 2 * n);
    draw_between_steps(x, x + sums.row(), steps, fine.data() + 2 * n * steps * kFine);
  }
  if (axial() && !fine.empty())
    draw_axial(sums.of(2), axial_compliance_mm_per_N_, steps, fine.data() + 2 * nodes * steps * kFine);
  thread_local std::vector<double> fine_N;
  fine_N.resize(heights > 0 ? (2 * heights + 1) * steps * kFine : 0);
  for (std::size_t i = 0; i < 2 * heights; ++i)
    draw_row(sums.of(4 + 2 * nodes + i), steps, fine_N.data() + i * steps * kFine);
  if (heights > 0) draw_row(sums.of(2), steps, fine_N.data() + 2 * heights * steps * kFine);
  for (const ChipEnd& e : ends) add_end(e, sums.of(0), sums.row(), fine, fine_N);
  if (heights > 0) add_part(passing, fine_N, fine);
  out.force_N.resize(steps);
  out.torque_Nmm.assign(sums.of(3), sums.of(3) + steps);
  out.work_Nmm = 0;
  for (std::size_t m = 0; m < steps; ++m) {
    out.force_N[m] = {sums.of(0)[m], sums.of(1)[m], sums.of(2)[m]};
    out.work_Nmm += out.torque_Nmm[m] * 2 * kPi / turn;
  }
  out.deflection_mm.clear();
}

}  // namespace camber::deflection
