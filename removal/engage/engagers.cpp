#include <cassert>

#include "removal/engage/engaged_path.h"
#include "removal/engagement.h"
#include "removal/known_run.h"

namespace camber::removal {

struct RigidEngager::Impl {
  EnvelopeBlocks blocks;
  std::unique_ptr<RigidPath> path{};
};

RigidEngager::RigidEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope,
                           std::span<const Stamp> stamps, std::int32_t first_id, int pitches, const KnownRun* known)
    : impl_(new Impl{EnvelopeBlocks(envelope, stock.voxel_mm(), stock.band_mm())}) {
  const EngagedRun run{stock, blank, envelope, stamps, first_id, known};
  impl_->path = upright_run(stamps, known) ? upright::rigid_path(run, impl_->blocks, pitches)
                                           : tilted::rigid_path(run, impl_->blocks, pitches);
}
RigidEngager::~RigidEngager() = default;

const EnvelopeBlocks& RigidEngager::blocks() const { return impl_->blocks; }

void RigidEngager::engage(std::size_t from, std::size_t count, const ChipSink& sink) {
  impl_->path->engage(from, count, sink);
}

void RigidEngager::engage(std::size_t from, std::size_t count, const SparseChipSink& sink) {
  impl_->path->engage(from, count, sink);
}

double RigidEngager::commit() { return impl_->path->commit(); }

DeflectedEngager::DeflectedEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope,
                                   std::span<const Stamp> stamps, std::int32_t first_id, const KnownRun* known) {
  assert(!envelope.patches.empty());
  const EngagedRun run{stock, blank, envelope, stamps, first_id, known};
  path_ = upright_run(stamps, known) ? upright::deflected_path(run) : tilted::deflected_path(run);
}
DeflectedEngager::~DeflectedEngager() = default;

void DeflectedEngager::remember(std::size_t from, std::span<const float> rows, std::size_t row_size,
                                double largest_mm) {
  path_->remember(from, rows, row_size, largest_mm);
}

void DeflectedEngager::start(std::size_t from, std::size_t count, const DeflectionTable& deflections) {
  path_->start(from, count, deflections);
}

std::span<const DeflectedChipSample> DeflectedEngager::read(std::size_t k) { return path_->read(k); }

std::span<const double> DeflectedEngager::glance(std::size_t k, std::size_t count) { return path_->glance(k, count); }

double DeflectedEngager::glance_of(std::span<const DeflectedChipSample> chips) const { return path_->glance_of(chips); }

void DeflectedEngager::cut(std::size_t k, std::size_t count) { path_->cut(k, count); }

double DeflectedEngager::commit() { return path_->commit(); }

}  // namespace camber::removal
