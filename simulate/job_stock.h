#pragma once
// The stock that a job describes.
#include <functional>

#include "machine/job_file.h"
#include "removal/stock.h"

namespace camber::simulate {

/// Box, cylinder, mesh or field of [stock], with the job's voxels; an allowance is not removed from it. `about_to` is
/// called with the stock's corners before memory is taken for a box, a cylinder or a mesh, and after a field is read;
/// it may throw. `within` (null: everywhere) bounds what is read of it: elsewhere its surface has no field, which takes
/// most of a stock's memory. Throws InputError [stock-missing] and those of the readers.
removal::Stock job_stock(const machine::Job& job, double band_voxels,
                         const std::function<void(const Vec3& min_mm, const Vec3& max_mm)>& about_to,
                         const removal::Region* within = nullptr);

}  // namespace camber::simulate
