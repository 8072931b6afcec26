// The marks of a cutter on the surface, and its deflection at the contacts.
#include <algorithm>

#include "base/tool_pose.h"
#include "simulate/cut_parts.h"

namespace camber::simulate {

using removal::DeflectionTable;
using removal::EnvelopeGrid;
using removal::Stamp;

namespace {

Vec3 deflection_at(const EnvelopeGrid& envelope, const DeflectionTable& deflections, const float* row,
                   const Contact& c) {
  const double step = deflections.step_at(c.angle_rad, c.height_mm, envelope.lag_per_mm, envelope.flutes);
  return deflections.at(row, c.height_mm, step);
}

void tell_contacts(const EnvelopeGrid& envelope, std::span<const Stamp> stamps, const DeflectionTable& deflections,
                   std::span<const Contact> contacts, std::span<StampLoad> loads) {
  for (std::size_t k = 0; k < contacts.size(); ++k)
    loads[k].contact_deflection_mm = direction_in_part(
        stamps[k].pose,
        deflection_at(envelope, deflections, deflections.row(static_cast<std::ptrdiff_t>(k)), contacts[k]));
}

/// The marks of even teeth.
class EvenMarks : public Marks {
 public:
  explicit EvenMarks(const CutTool& tool) : tool_(tool) {}

  void leave(const CutStretch& stretch, std::span<const Contact> contacts,
             removal::SurfaceMap* surface) const override {
    if (surface) surface->mark(tool_.envelope, stretch.stamps(), stretch.deflections, stretch.id());
    if (contacts.empty()) return;
    tell_contacts(tool_.envelope, stretch.stamps(),
                  tool_.run_out.none() ? stretch.deflections : without_run_out(stretch), contacts, stretch.loads);
  }

 private:
  DeflectionTable without_run_out(const CutStretch& stretch) const {
    DeflectionTable out = stretch.deflections;
    for (std::size_t k = 0; k < out.stamps; ++k)
      tool_.run_out.add(stretch.from + k, -1, out.nodes(), {out.row(static_cast<std::ptrdiff_t>(k)), out.row_size()});
    return out;
  }

  const CutTool& tool_;
};

/// The marks of teeth that are not even. Rows are as many times as long as there are teeth, and as many times fewer at
/// once.
class UnevenMarks : public Marks {
 public:
  explicit UnevenMarks(const CutTool& tool) : tool_(tool) {}

  void leave(const CutStretch& stretch, std::span<const Contact> contacts,
             removal::SurfaceMap* surface) const override {
    if (contacts.empty() && !surface) return;
    const deflection::ToothMarks& teeth = *tool_.tooth_marks;
    const std::span<StampLoad> loads = stretch.loads;
    const std::size_t stamps = loads.size(), part = stamps / static_cast<std::size_t>(tool_.envelope.flutes) + 1;
    for (std::size_t from = 0; from < stamps; from += part) {
      const std::size_t count = std::min(part, stamps - from), passings = stretch.from + from;
      const std::span<const Stamp> some = stretch.stamps().subspan(from, count);
      DeflectionTable own = teeth.bending(stretch.deflections, from, count, passings);
      if (!contacts.empty())
        tell_contacts(teeth.envelope(), some, own, contacts.subspan(from, count), loads.subspan(from, count));
      if (!surface) continue;
      teeth.add_run_out(own, passings);
      surface->mark(teeth.envelope(), some, own, stretch.id() + static_cast<std::int32_t>(from));
    }
  }

 private:
  const CutTool& tool_;
};

/// The mark of a drill: the deepest stamp of a hole says all of it.
class HoleMarks : public Marks {
 public:
  explicit HoleMarks(const CutTool& tool) : tool_(tool) {}

  void leave(const CutStretch& stretch, std::span<const Contact> contacts,
             removal::SurfaceMap* surface) const override {
    const std::span<const Stamp> stamps = stretch.stamps();
    if (surface) mark(*surface, stamps, stretch.id());
    if (!contacts.empty()) tell_contacts(tool_.envelope, stamps, stretch.deflections, contacts, stretch.loads);
  }

 private:
  void mark(removal::SurfaceMap& surface, std::span<const Stamp> stamps, std::int32_t first_id) const {
    const DeflectionTable straight(1, tool_.model.steps(), tool_.model.node_height_mm());
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      const bool deeper = k + 1 < stamps.size() &&
                          stamps[k + 1].pose.tip_mm.head<2>() == stamps[k].pose.tip_mm.head<2>() &&
                          stamps[k + 1].move >= stamps[k].move;
      if (!deeper)
        surface.mark(tool_.envelope, stamps.subspan(k, 1), straight, first_id + static_cast<std::int32_t>(k));
    }
  }

  const CutTool& tool_;
};

}  // namespace

std::unique_ptr<Marks> marks_of(const CutTool& tool) {
  if (tool.options.drilling) return std::make_unique<HoleMarks>(tool);
  if (tool.tooth_marks) return std::make_unique<UnevenMarks>(tool);
  return std::make_unique<EvenMarks>(tool);
}

}  // namespace camber::simulate
