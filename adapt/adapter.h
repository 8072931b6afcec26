#pragma once
// One run of camber adapt. Private to adapt/.
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adapt/adaptation.h"
#include "adapt/feed_cells.h"
#include "adapt/feed_chooser.h"
#include "adapt/observed_loads.h"
#include "simulate/chatter.h"
#include "simulate/setup.h"

namespace camber::adapt {

// Which loads of an emitted program exceed their limits, and why.

struct Verdict {
  std::vector<OverLimit> over;      ///< by line
  std::vector<LoadFigure> figures;  ///< without max_before
  double excess = 0;                ///< greatest load / limit where the feed might have been lower
  double peak = 0;                  ///< greatest load / limit outside `over`
  std::vector<double> of_cell;      ///< greatest load / limit of each cell
};

/// Judges the observed loads of a candidate.
Verdict judge(const FeedCandidate& candidate, const ObservedLoads& loads, const FeedCells& cells,
              const simulate::SimulatedProgram& given, std::span<const LoadLimit> limits, const FeedBounds& bounds);

/// The greatest of each load at the observed feeds, by limit; of chip_min the greatest chip.
std::vector<double> peaks_of(const ObservedLoads& loads, std::span<const LoadLimit> limits);

class Adapter {
 public:
  /// Reads, times and checks; throws InputError. Everything passed must outlive the object.
  Adapter(const machine::Job& job, Diagnostics& diagnostics, const AdaptOptions& options);
  AdaptResult run();

 private:
  static constexpr double kAim = 0.97;  ///< aimed-at fraction of a limit: between kUnderLimit and kOverLimit

  /// With the spindle speeds that the limit on chatter asks for.
  const simulate::SimulatedProgram& given() const { return stable_ ? *stable_ : original(); }
  const simulate::SimulatedProgram& original() const { return setup_ ? setup_->program : *program_; }
  bool by_load() const { return !limits_.empty(); }
  const removal::Stock& blank() const { return setup_ ? setup_->target.blank : blank_->stock; }
  void progress(const std::string& what, double fraction) const {
    if (options_.progress) options_.progress(what, fraction);
  }
  Diagnostic at_line(Severity severity, std::size_t block, std::string message, std::string check) const;

  // adapter_setup.cpp
  void set_up();
  void check_cells();
  void check_limits();
  void change_speeds();

  // adapt.cpp
  void observe_given();
  std::vector<double> allowed(double factor) const;
  std::shared_ptr<FeedCandidate> choose(double factor, int rounds) const;
  void find_time_limit(AdaptResult& out);
  ObservedLoads predict(const FeedCandidate& candidate, std::vector<std::string>& doubts);
  void correct(AdaptResult& out);
  void keep_feeds(AdaptResult& out);
  bool can_be_raised(const FeedCandidate& candidate, std::span<const double> now) const;
  void lower_feeds(const Verdict& verdict, std::span<const double> now, std::vector<double>& feeds) const;

  // adapter_result.cpp
  std::size_t count_changed() const;
  void check_emitted();
  double constant_feed(double factor) const;
  void sweep(AdaptResult& out);
  std::vector<std::uint32_t> original_blocks() const;
  void finish_speeds(AdaptResult& out) const;
  void finish(AdaptResult& out);
  void trace(PathTrace& out) const;

  machine::Job job_;  ///< its operations are those of given()
  const machine::AdaptSettings& settings_;
  Diagnostics& diagnostics_;
  const AdaptOptions& options_;
  std::vector<LoadLimit> limits_;
  bool by_surface_ = false;
  std::optional<simulate::Setup> setup_;               ///< where the surface counts or another program is the target
  std::optional<simulate::SimulatedProgram> program_;  ///< else
  std::optional<simulate::Blank> blank_;               ///< else
  std::vector<SpeedChange> speeds_;
  std::optional<simulate::SimulatedProgram> stable_;  ///< with other spindle speeds, where there are any
  std::vector<std::uint32_t> stable_blocks_;          ///< of its lines in the original
  std::optional<FeedCells> cells_;
  std::vector<int> flutes_;  ///< by cell
  std::optional<FeedChooser> chooser_;
  std::vector<Contact> contacts_;
  ObservedLoads before_, loads_, best_loads_;
  std::vector<double> peaks_before_;  ///< by limit
  std::shared_ptr<FeedCandidate> best_;
  Verdict verdict_;
  simulate::CriticalDepths depths_;
  simulate::ChatterMargins chatter_, best_chatter_;
  int predictions_ = 0;
};

/// The limits times a factor, but for chip_min.
std::vector<LoadLimit> scaled(std::span<const LoadLimit> limits, double factor);

}  // namespace camber::adapt
