#pragma once
// The deflected cutter through the stock, each tooth passing in its static equilibrium before the next one.
#include <array>
#include <span>
#include <vector>

#include "deflection/run_out_offsets.h"
#include "deflection/static_equilibrium.h"
#include "removal/engagement.h"

namespace camber::deflection {

/// Why a tooth passing has no static equilibrium that was found.
enum class NoEquilibrium {
  pulled_in,   ///< the force grows faster with the chip than the tool resists: it bends into the material without end
  pushed_out,  ///< the tool bends away by more than removal::DeflectedEngager::kMaxDeflection_mm
  swings,      ///< reading after reading asks for another bend
};

struct SettleOptions {
  int max_rounds = 40;     ///< readings of one stamp's chips
  double settle_um = 0.1;  ///< change of the deflection that the next reading may bring, rms over the cut, or ...
  double settle_fraction = 0.01;  ///< ... this share of its rms
};

/// What one tooth passing leaves alone decides the next: so each is brought to its equilibrium by readings of its chips
/// and solutions for them (StaticEquilibrium), then cut. Run-out of equally spaced teeth is an offset of the axis that
/// turns with the tool: the rows hold it beside the deflection, and what each tooth takes follows from what the ones
/// before have left.
class StaticCut {
 public:
  StaticCut(removal::Stock& stock, const removal::Stock& blank, const removal::EnvelopeGrid& envelope,
            const ToothPassModel& model, std::span<const removal::Stamp> stamps, std::int32_t first_id,
            const SettleOptions& options, const RunOutOffsets& run_out)
      : stamps_(stamps),
        options_(options),
        run_out_(run_out),
        envelope_(envelope),
        engager_(stock, blank, envelope, stamps, first_id),
        equilibrium_(envelope, model) {}

  /// Begins with stamps[from] ... stamps[from + count - 1]; row -1 of `deflections` is that of the stamp before. The
  /// rows are filled as their stamps are cut.
  void start(std::size_t from, std::size_t count, removal::DeflectionTable& deflections);

  struct Passing {
    int rounds = 0;
    bool settled = true;
    NoEquilibrium reason = NoEquilibrium::swings;  ///< where it has not
    std::span<const removal::ChipSample> chips;    ///< gone at the next call but one
  };
  /// Cuts stamps[from + k]. Where it finds no equilibrium, or one deflected beyond
  /// removal::DeflectedEngager::kMaxDeflection_mm, the cutter keeps the bend nearest to one, in the latter case that of
  /// the stamp before.
  Passing cut(std::size_t k);
  /// Leaves the stock as cut. Returns the volume that was taken since the last commit, mm^3.
  double commit() { return engager_.commit(); }

 private:
  NoEquilibrium beyond_reach(std::span<const float> row) const;
  void start_from_before(std::size_t k, std::span<float> row) const;
  bool rests(std::span<const float> row, const StaticEquilibrium::Step& step) const;

  std::span<const removal::Stamp> stamps_;
  SettleOptions options_;
  const RunOutOffsets& run_out_;
  const removal::EnvelopeGrid& envelope_;
  removal::DeflectedEngager engager_;
  StaticEquilibrium equilibrium_;
  std::size_t from_ = 0;
  removal::DeflectionTable* deflections_ = nullptr;
  std::vector<removal::DeflectedChipSample> read_;
  std::array<std::vector<removal::ChipSample>, 2> chips_;  ///< of this passing and of the one before, in turns
  std::vector<float> swing_;                               ///< the bend a few readings ago
};

}  // namespace camber::deflection
