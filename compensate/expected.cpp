#include "compensate/expected.h"

#include <algorithm>

#include "compensate/hidden_rows.h"
#include "removal/tool_path.h"

namespace camber::compensate {

std::vector<Vec3> nominal_bending(const machine::Job& job, const simulate::Setup& given,
                                  const std::function<void(double)>& progress) {
  machine::Job rigid = job;
  rigid.simulation.coupling = machine::Coupling::rigid;
  simulate::SimulatedProgram nominal = given.program;
  nominal.path = removal::nominal_path(nominal.moves_in_part(), nominal.selected, nominal.path, nominal.part_path());
  simulate::PredictOptions options;
  options.progress = progress;
  std::vector<Vec3> out;
  for (const simulate::StampLoad& load : given.predictor(rigid, given.target, nominal, options).cut.loads)
    out.push_back(load.contact_deflection_mm);
  return out;
}

double expected_error_mm(const machine::Job& job, const removal::SurfacePoint& point,
                         const ShiftPath::PointInterval& owner, std::span<const Vec3> offsets,
                         std::span<const Vec3> bending) {
  const double bent = point.normal.dot(bending[static_cast<std::size_t>(point.target_stamp)]);
  if (job.compensation.reference == machine::Reference::machine) return bent;
  return bent + point.normal.dot((1 - owner.upper_fraction) * offsets[owner.lower] +
                                 owner.upper_fraction * offsets[owner.lower + 1]);
}

void scale_bending(const ShiftPath& path, const machine::Job& job, const simulate::Setup& given,
                   const Observed& observed, const std::vector<removal::SurfacePoint>& surface,
                   std::vector<Vec3>& bending) {
  const std::vector<Vec3> offsets = path_offsets(path, given.program, given.program, {});
  const std::vector<Vec3> none(bending.size(), Vec3::Zero());
  double products = 0, squares = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Observation& o = observed.points[i];
    if (!observed.compensated[i] || o.foreign || surface[i].target_stamp < 0) continue;
    const double expected = o.normal.dot(bending[static_cast<std::size_t>(surface[i].target_stamp)]);
    const double rest = o.error_mm - expected_error_mm(job, surface[i], o.place, offsets, none);
    products += o.area_mm2 * expected * rest;
    squares += o.area_mm2 * expected * expected;
  }
  const double scale = squares > 0 ? std::clamp(products / squares, 0.0, 1.0) : 1.0;
  for (Vec3& b : bending) b *= scale;
}

std::vector<Observation> expected_errors(const ShiftPath& path, const machine::Job& job, const simulate::Setup& given,
                                         const Observed& observed, const std::vector<removal::SurfacePoint>& surface,
                                         std::span<const Vec3> bending) {
  const std::vector<Vec3> offsets = path_offsets(path, given.program, given.program, {});
  std::vector<Observation> out;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const auto owner = owner_place(path, given, surface[i]);
    if (!owner) continue;
    Observation o = observed.points[i];
    set_place(o, surface[i], *owner, path, job, given.program);
    o.error_mm = expected_error_mm(job, surface[i], *owner, offsets, bending);
    o.own = true;
    o.above = false;
    out.push_back(o);
  }
  return out;
}

}  // namespace camber::compensate
