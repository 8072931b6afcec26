#include "simulate/load_probe.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "deflection/beam.h"
#include "deflection/teeth.h"
#include "deflection/tooth_pass.h"
#include "simulate/tooth_loads.h"

namespace camber::simulate {

using deflection::ToothPass;
using deflection::ToothPassModel;
using removal::ChipBlock;
using removal::EnvelopeBlocks;
using removal::Stamp;

namespace {

CutOptions cut_options(const LoadProbeOptions& options) {
  CutOptions out;
  out.coupling = machine::Coupling::rigid;
  out.envelope_step_mm = options.envelope_step_mm;
  out.rotation_step_rad = options.rotation_step_rad;
  out.axis_compliance_mm_per_N = options.axis_compliance_mm_per_N;
  out.drilling = options.drilling;
  return out;
}

/// Where every force is `factor` times as large.
StampLoad times(const StampLoad& load, double factor) {
  StampLoad out = load;
  out.force_max_N *= factor, out.force_mean_N *= factor, out.lateral_max_N *= factor;
  out.torque_max_Nmm *= factor, out.torque_mean_Nmm *= factor, out.work_Nmm *= factor;
  out.deflection_max_mm *= factor;
  return out;
}

}  // namespace

struct LoadProbe::Impl {
  LoadProbeOptions options;
  CutOptions cut;
  removal::Stock blank;
  double top_mm;
  removal::EnvelopeGrid envelope;
  deflection::Teeth teeth;
  ToothPassModel model;
  removal::StepEngager engager;
  removal::DeflectionTable row;  ///< of one stamp
  ToothPass pass{};
  std::vector<ChipBlock> weighted{};
  std::vector<double> factors{};  ///< [blocks][lanes]; 0: no chip
  std::vector<ProbedLoad> loads{};

  Impl(removal::Stock& stock, const machine::Tool& tool, const machine::Material& material, const removal::TipBox& tips,
       const LoadProbeOptions& options_)
      : options(options_),
        cut(cut_options(options_)),
        blank(stock),
        top_mm(engaged_top_mm(stock, tool, stock.max_mm().z() - tips.min_mm.z())),
        envelope(sampled_envelope(stock, tool, top_mm, cut)),
        teeth(tool),
        model(envelope, material, deflection::beam_of(tool),
              deflection::node_heights(top_mm,
                                       std::min(tool.overhang_mm, tool.flute_length_mm.value_or(tool.overhang_mm))),
              0.0, teeth, options_.axis_compliance_mm_per_N),
        engager(stock, blank, envelope, tips, options_.first_id,
                teeth.even() || options_.drilling ? 1 : envelope.flutes),
        row(1, deflection::kFine * model.steps(), model.node_height_mm(), model.axial()) {}

  Vec3 middle_mm(const Stamp& stamp, std::span<const ChipBlock> chips) const;
  StampLoad expected(const Stamp& stamp, std::span<const ChipBlock> chips);
  StampLoad felt(const Stamp& stamp, std::span<const ChipBlock> chips, const StampLoad& without);
  StampLoad evaluate(const Stamp& stamp, std::span<const ChipBlock> chips);
};

StampLoad LoadProbe::Impl::evaluate(const Stamp& stamp, std::span<const ChipBlock> chips) {
  const bool bends = options.deflections && !options.drilling;
  const std::span<float> fine(row.row(0), bends ? row.row_size() : 0);
  model.evaluate(engager.blocks(), chips, engager.count(), removal::motion_in_tool({&stamp, 1}, 0), pass, fine);
  StampLoad load = summarize(pass);
  if (bends) load.deflection_max_mm = tip_deflection_mm(row, row.row(0));
  return load;
}

StampLoad LoadProbe::Impl::expected(const Stamp& stamp, std::span<const ChipBlock> chips) {
  StampLoad load = evaluate(stamp, chips);
  load.chip_mm3 = removal::chip_volume_mm3(envelope, engager.blocks(), chips);
  return load;
}

Vec3 LoadProbe::Impl::middle_mm(const Stamp& stamp, std::span<const ChipBlock> chips) const {
  Vec3 sum = Vec3::Zero();
  double weight = 0;
  for (const ChipBlock& chip : chips) {
    float thickness = 0;
    for (const float h : chip.thickness_mm) thickness += std::max(0.0f, h);
    if (!(thickness > 0)) continue;  // a block is small: any of its points tells where it is
    sum += static_cast<double>(thickness) * model.place_mm(engager.blocks().point(chip.block, 0));
    weight += static_cast<double>(thickness);
  }
  return weight > 0 ? Vec3(stamp.pose.tip_mm + sum / weight) : stamp.pose.tip_mm;
}

/// Forces are proportional to the width of a chip: each chip has the share of its width that its factor is of the
/// greatest one.
StampLoad LoadProbe::Impl::felt(const Stamp& stamp, std::span<const ChipBlock> chips, const StampLoad& without) {
  const Vec3 around(envelope.shape.radius_mm, envelope.shape.radius_mm, 0), tip = stamp.pose.tip_mm;
  if (!options.regions || !options.regions->meet(tip - around, tip + around + Vec3(0, 0, top_mm))) return without;
  constexpr std::size_t kLanes = EnvelopeBlocks::kLanes;
  factors.assign(chips.size() * kLanes, 0.0);
  double least = ForceRegions::kGreatestFactor, greatest = 0;
  for (std::size_t b = 0; b < chips.size(); ++b)
    for (std::size_t l = 0; l < kLanes; ++l) {
      if (!(chips[b].thickness_mm[l] > 0)) continue;
      const double f =
          options.regions->factor_at(tip + model.place_mm(engager.blocks().point(chips[b].block, static_cast<int>(l))));
      factors[b * kLanes + l] = f;
      least = std::min(least, f), greatest = std::max(greatest, f);
    }
  if (greatest == 0) return without;
  if (least == greatest) return times(without, greatest);
  weighted.assign(chips.begin(), chips.end());
  for (std::size_t b = 0; b < chips.size(); ++b)
    for (std::size_t l = 0; l < kLanes; ++l)
      if (const double f = factors[b * kLanes + l]; f > 0)
        weighted[b].cut_255[l] = static_cast<std::uint8_t>(std::lround(chips[b].cut_255[l] * f / greatest));
  StampLoad load = times(evaluate(stamp, weighted), greatest);
  load.chip_mm3 = without.chip_mm3, load.chip_area_mm2 = without.chip_area_mm2;
  return load;
}

LoadProbe::LoadProbe(removal::Stock& stock, const machine::Tool& tool, const machine::Material& material,
                     const removal::TipBox& tips, const LoadProbeOptions& options)
    : impl_(std::make_unique<Impl>(stock, tool, material, tips, options)) {}
LoadProbe::~LoadProbe() = default;

std::span<const ProbedLoad> LoadProbe::append(std::span<const Stamp> stamps) {
  Impl& m = *impl_;
  m.loads.clear();
  for (const Stamp& stamp : stamps) {
    const std::span<const ChipBlock> chips = m.engager.read(stamp);
    ProbedLoad load;
    load.chips_at_mm = m.middle_mm(stamp, chips);
    if (!chips.empty()) {
      load.expected = m.expected(stamp, chips);
      load.felt = m.felt(stamp, chips, load.expected);
    }
    m.engager.cut(stamp);
    m.loads.push_back(load);
  }
  return m.loads;
}

StampLoad LoadProbe::look(const Stamp& stamp) {
  const std::span<const ChipBlock> chips = impl_->engager.read(stamp);
  return chips.empty() ? StampLoad{} : impl_->expected(stamp, chips);
}

LoadProbe::Look LoadProbe::look_at_two_feeds(const Stamp& stamp) {
  Impl& m = *impl_;
  const std::span<const ChipBlock> chips = m.engager.read(stamp);
  Look out;
  out.chips_at_mm = m.middle_mm(stamp, chips);
  if (chips.empty()) return out;
  out.at_feed = m.expected(stamp, chips);
  Stamp half = stamp;
  half.feed_per_tooth_mm *= 0.5;
  out.at_half = m.expected(half, m.engager.read(half));
  return out;
}

void LoadProbe::approach(const Vec3& tip_mm, int most) { impl_->engager.approach(tip_mm, most); }

double LoadProbe::distance_mm(const Vec3& place_mm) const { return impl_->engager.distance_mm(place_mm); }
double LoadProbe::flush() { return impl_->engager.flush(); }
std::int32_t LoadProbe::next_id() const {
  return impl_->options.first_id + static_cast<std::int32_t>(impl_->engager.count());
}

}  // namespace camber::simulate
