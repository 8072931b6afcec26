#pragma once
// Static coupling: cuts the stock with the deflected cutter. Each tooth passing is brought to its static equilibrium of
// force and deflection before the next one is cut.
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "deflection/reading_pace.h"
#include "deflection/run_out_offsets.h"
#include "deflection/static_equilibrium.h"
#include "removal/engagement.h"

namespace camber::deflection {

/// Why no static equilibrium was found for a tooth passing.
enum class NoEquilibrium {
  pulled_in,   ///< the force grows faster with the chip than the restoring force: the deflection into the material
               ///< diverges
  pushed_out,  ///< the tool deflects away by more than removal::DeflectedEngager::kMaxDeflection_mm
  swings,      ///< the deflection alternates from reading to reading
};

struct SettleOptions {
  int max_rounds = 40;     ///< maximum number of readings of the chips of a stamp
  double settle_um = 0.1;  ///< converged if the next reading changes the deflection by less than this, rms over the
                           ///< cut, or by less than ...
  double settle_fraction = 0.01;                    ///< ... this fraction of its rms
  double follow_um = 0.1, follow_fraction = 0.02;   ///< permitted error of an extrapolated deflection, likewise
  std::size_t longest_gap = ReadingPace::kLongest;  ///< largest number of passings from reading to reading
};

/// The surface left by one tooth passing determines the next one. Each is brought to its equilibrium by reading its
/// chips and solving for them (StaticEquilibrium), repeatedly, and then cut. Run-out of equally spaced teeth is an
/// offset of the axis that turns with the tool: the rows contain deflection plus offset, and the chip of each tooth
/// follows from the surface left by the previous ones. Where the cut changes slowly, only some passings are read, and
/// the deflections of the others are extrapolated (ReadingPace). These are glanced at together, before the passing that
/// was read is carved, and carved together with it.
class StaticCut {
 public:
  StaticCut(removal::Stock& stock, const removal::Stock& blank, const removal::EnvelopeGrid& envelope,
            const ToothPassModel& model, std::span<const removal::Stamp> stamps, std::int32_t first_id,
            const SettleOptions& options, const RunOutOffsets& run_out, std::size_t different_teeth = 1,
            const removal::KnownRun* known = nullptr)
      : stamps_(stamps),
        options_(options),
        run_out_(run_out),
        envelope_(envelope),
        engager_(stock, blank, envelope, stamps, first_id, known),
        equilibrium_(envelope, model),
        pace_(different_teeth, options.longest_gap) {}

  /// See removal::DeflectedEngager::remember.
  void remember(std::size_t from, std::span<const float> rows, std::size_t row_size, double largest_mm) {
    engager_.remember(from, rows, row_size, largest_mm);
  }
  /// Starts the stretch stamps[from] ... stamps[from + count - 1]. Row -1 of `deflections` belongs to the stamp before;
  /// the other rows are filled as their stamps are cut. `must_read(k)`: true for passings that have to be read.
  void start(std::size_t from, std::size_t count, removal::DeflectionTable& deflections,
             std::function<bool(std::size_t k)> must_read);

  struct Passing {
    int rounds = 0;  ///< 0: not read; the deflection was extrapolated
    bool settled = true;
    NoEquilibrium reason = NoEquilibrium::swings;  ///< why it has not settled
    std::span<const removal::ChipSample> chips;    ///< as they were read; valid until the call after the next reading
  };
  /// Cuts stamps[from + k], for k = 0, 1 ... in order. If the static deflection does not converge, the closest
  /// approximation is used; if it exceeds removal::DeflectedEngager::kMaxDeflection_mm, that of the previous stamp.
  Passing cut(std::size_t k);
  /// Returns the errors of the extrapolated deflections, as the readings after them show.
  const ReadingPace::Errors& extrapolation_errors() const { return pace_.errors(); }
  /// Writes the cut to the stock. Returns the volume removed since the last commit, mm^3.
  double commit() { return engager_.commit(); }

 private:
  NoEquilibrium beyond_reach(std::span<const float> row) const;
  void start_from_before(std::size_t k, std::span<float> row) const;
  bool follow(std::size_t k);
  std::size_t followers(std::size_t k);
  void carve_to(std::size_t end);
  bool rests(std::span<const float> row, const StaticEquilibrium::Step& step) const;

  std::span<const removal::Stamp> stamps_;
  SettleOptions options_;
  const RunOutOffsets& run_out_;
  const removal::EnvelopeGrid& envelope_;
  removal::DeflectedEngager engager_;
  StaticEquilibrium equilibrium_;
  ReadingPace pace_;
  std::size_t from_ = 0, count_ = 0;
  std::function<bool(std::size_t)> must_read_;
  std::size_t carved_ = 0;     ///< number of stamps of the stretch that are carved
  std::size_t reglanced_ = 0;  ///< where the last glance found other material than predicted
  removal::DeflectionTable* deflections_ = nullptr;
  std::vector<removal::DeflectedChipSample> read_;
  std::array<std::vector<removal::ChipSample>, 2> chips_;  ///< this reading's and the previous one's, alternating
  std::size_t readings_ = 0;
  int unsettled_in_a_row_ = 0;  ///< number of readings
  std::vector<float> swing_;    ///< the deflection a few readings ago
};

}  // namespace camber::deflection
