#pragma once
// One run of camber adapt. Private to adapt/.
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adapt/adapt.h"
#include "adapt/feed_cells.h"
#include "adapt/feed_chooser.h"
#include "adapt/judge.h"
#include "adapt/observed_loads.h"
#include "simulate/setup.h"

namespace camber::adapt {

class Adapter {
 public:
  /// Reads, times and checks; throws InputError. Everything passed must outlive the object.
  Adapter(const machine::Job& job, Diagnostics& diagnostics, const AdaptOptions& options);
  AdaptResult run();

 private:
  static constexpr double kAim = 0.97;  ///< aimed-at fraction of a limit: between kUnderLimit and kOverLimit

  const simulate::SimulatedProgram& given() const { return setup_ ? setup_->program : *program_; }
  const removal::Stock& blank() const { return setup_ ? setup_->target.blank : blank_->stock; }
  void progress(const std::string& what, double fraction) const {
    if (options_.progress) options_.progress(what, fraction);
  }
  Diagnostic at_line(Severity severity, std::size_t block, std::string message, std::string check) const;

  // adapter_setup.cpp
  void set_up();
  void check_cells();
  void check_limits();

  // adapt.cpp
  void observe_given(AdaptResult& out);
  std::vector<double> allowed(double factor) const;
  std::shared_ptr<Candidate> choose(double factor, int rounds) const;
  void find_time_limit(AdaptResult& out);
  ObservedLoads predict(const Candidate& candidate, std::vector<std::string>& doubts);
  void correct(AdaptResult& out);
  bool can_be_raised(const Candidate& candidate, std::span<const double> now) const;
  void lower_feeds(const Verdict& verdict, std::span<const double> now, std::vector<double>& feeds) const;

  // adapter_result.cpp
  std::size_t count_changed() const;
  void check_emitted();
  double constant_feed(double factor) const;
  void sweep(AdaptResult& out);
  void finish(AdaptResult& out);
  void trace(PathTrace& out) const;

  const machine::Job& job_;
  const machine::AdaptSettings& settings_;
  Diagnostics& diagnostics_;
  const AdaptOptions& options_;
  std::vector<LoadLimit> limits_;
  bool by_surface_ = false;
  std::optional<simulate::Setup> setup_;               ///< where the surface counts or another program is the target
  std::optional<simulate::SimulatedProgram> program_;  ///< else
  std::optional<simulate::Blank> blank_;               ///< else
  std::optional<FeedCells> cells_;
  std::vector<int> flutes_;  ///< by cell
  std::optional<FeedChooser> chooser_;
  std::vector<Contact> contacts_;
  ObservedLoads before_, loads_, best_loads_;
  std::vector<double> peaks_before_;  ///< by limit
  std::shared_ptr<Candidate> best_;
  Verdict verdict_;
  int predictions_ = 0;
};

/// The limits times a factor, but for chip_min.
std::vector<LoadLimit> scaled(std::span<const LoadLimit> limits, double factor);

}  // namespace camber::adapt
