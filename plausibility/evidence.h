#pragma once
// What the rules look at, worked out once.
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "checks/height_survey.h"
#include "machine/job_file.h"
#include "machine/tool_proposal.h"
#include "simulate/predict.h"

namespace camber::plausibility {

/// Values with weights.
class Spread {
 public:
  void add(double value, double weight) {
    if (weight > 0) values_.emplace_back(value, weight), sorted_ = false, weight_ += weight;
  }
  bool empty() const { return values_.empty(); }
  double weight() const { return weight_; }
  /// The value below which this fraction of the weight lies.
  double at(double fraction) const;
  double median() const { return at(0.5); }

 private:
  mutable std::vector<std::pair<double, double>> values_;
  mutable bool sorted_ = true;
  double weight_ = 0;
};

/// One tool's work in the program.
struct ToolWork {
  int number = 0;
  const machine::Tool* tool = nullptr;          ///< tool of the job
  const machine::ToolProposal* said = nullptr;  ///< tool in the program's comments; null: not named
  bool mills = false;
  std::uint32_t first_move = 0;  ///< that cuts
  double milling_mm = 0;         ///< length of its milling moves
  double level_mm = 0;           ///< length of this at one height
  double sloping_mm = 0;         ///< length of this in lines that rise or fall by 2 to 80 degrees
  double rising_mm = 0;          ///< rising part of sloping_mm
  std::size_t holes = 0;         ///< moves that make holes
  Spread feed_per_tooth_mm, cutting_speed_m_per_min, spindle_rpm, feed_mm_per_min;  ///< in milling, by length
  checks::MoveCut cut;  ///< sum of its milling moves, where there is a survey
  std::uint32_t deepest_move = 0;
  Spread depth_mm;  ///< height of what each move removes, by length in material
  Spread power_W;   ///< for the chips alone, by length in material
};

struct Evidence {
  const machine::Job& job;
  const simulate::SimulatedProgram& program;
  std::vector<machine::ToolProposal> said;  ///< tools in the program's comments
  std::vector<ToolWork> tools;              ///< those that cut, ascending
  std::optional<machine::Box> stock;        ///< where it is not a .vdb
  std::optional<checks::HeightSurvey> survey;
  bool elsewhere = false;         ///< path and stock lie apart, or their units do (checks::check_places)
  double specific_force_MPa = 0;  ///< tangential, of chips of 0.1 mm
  std::map<std::string, std::vector<std::string>> assumed;  ///< keys by table (machine/assumptions.h)

  Evidence(const machine::Job& job, const simulate::SimulatedProgram& program);
  /// Evidence of a job whose program is yet to be made: all of its tools.
  explicit Evidence(const machine::Job& job);
  Evidence(const Evidence&) = delete;
  Evidence& operator=(const Evidence&) = delete;

  /// An error, but a warning where one of these keys of [tool.N] or, with `of_stock`, the blank is only assumed: what
  /// nobody gave refuses no program.
  Severity error_of(int tool, std::initializer_list<std::string_view> keys, bool of_stock) const;
  Diagnostic at_job(Severity severity, std::string message, std::string check) const;
  Diagnostic at_move(Severity severity, std::uint32_t move, std::string message, std::string check) const;
};

}  // namespace camber::plausibility
