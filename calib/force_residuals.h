#pragma once
// The parameters of fit-force, the values that they start from, and the residuals that they leave.
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calib/force_signal.h"
#include "deflection/steady_cut.h"
#include "machine/force_law.h"

namespace camber::calib {

/// One vector: coefficients that are fitted, then for every log of waveforms its run-out (x, y mm; only x, or none) and
/// the phase of each of its cuts (rad).
class ForceProblem {
 public:
  explicit ForceProblem(const std::vector<MeasuredLog>& logs);

  Eigen::Index size() const { return size_; }
  Eigen::Index residual_count() const { return residuals_; }
  std::size_t coefficient_count() const { return free_.size(); }
  const machine::Coefficient& coefficient(std::size_t i) const { return *free_[i]; }

  struct LogPlace {
    Eigen::Index run_out = 0;  ///< of its first component
    int run_out_size = 0;
    Eigen::Index phase = 0;  ///< of the first cut
  };
  const std::vector<LogPlace>& places() const { return places_; }
  const std::vector<MeasuredLog>& logs() const { return logs_; }
  const deflection::SteadyCutModel& model(std::size_t log, std::size_t cut) const { return models_[log][cut]; }

  machine::Material material_at(const Eigen::VectorXd& p) const;
  deflection::RunOut run_out_at(std::size_t log, const Eigen::VectorXd& p) const;

  /// Model minus measured, N; waveform steps weighted by the square root of their fraction of samples.
  Eigen::VectorXd residuals(const Eigen::VectorXd& p) const;
  /// By central differences; a phase touches its own cut only.
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& p) const;
  /// Root mean square of model minus the held-out turns, over all waveforms; 0 without.
  double held_out_rms_N(const Eigen::VectorXd& p) const;

 private:
  Eigen::VectorXd cut_residuals(std::size_t log, std::size_t cut, const Eigen::VectorXd& p) const;
  double step_of(Eigen::Index i, double value) const;

  const std::vector<MeasuredLog>& logs_;
  machine::Material base_;
  std::vector<const machine::Coefficient*> free_;
  std::vector<std::vector<deflection::SteadyCutModel>> models_;
  std::vector<std::vector<Eigen::Index>> first_residual_;
  std::vector<LogPlace> places_;
  Eigen::Index size_ = 0, residuals_ = 0;
};

/// Coefficients by linear least squares (with another law than the linear one: the law through the linear one's force
/// and slope at the mean chip of the first cut), each waveform turned to the phase within a pitch at which it fits
/// best. Run-out zero.
Eigen::VectorXd start_without_run_out(const ForceProblem& problem);

/// Starts with run-out, the most promising first: offsets of a quarter of the feed per tooth in several directions, the
/// teeth of each cut numbered as fits best. Empty where nothing has run-out to fit.
std::vector<Eigen::VectorXd> starts_with_run_out(const ForceProblem& problem, const Eigen::VectorXd& without);

}  // namespace camber::calib
