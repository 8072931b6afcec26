#include "plan/compensated_program.h"

#include <fmt/format.h>

#include "base/output_file.h"
#include "base/temporary_folder.h"
#include "compensate/compensate.h"
#include "kinematics/control_options.h"

namespace camber::plan {
namespace {

CompensatedProgram kept(const std::string& text, const std::string& why) { return {text, "not compensated: " + why}; }

}  // namespace

CompensatedProgram compensated(const machine::Job& job, const std::string& stock_vdb, const std::string& text) {
  const TemporaryFolder folder;
  machine::Job of = job;
  of.program = folder.path() + "/finish" + std::string(kinematics::dialect_of(job.machine.control.kind).file_extension);
  of.stock = {};
  of.stock.vdb = stock_vdb;
  write_file(of.program, text);
  try {
    Diagnostics ignored;  // of a program that is not the one that is written
    const compensate::CompensationResult done = compensate::compensate(of, ignored, {});
    const double before = done.figures.before_um.p95, after = done.figures.after_um.p95;
    if (!done.verdict.better)
      return kept(text, fmt::format("its form error, {:.1f} um (p95), does not become less", before));
    return {done.emitted.text,
            fmt::format("compensated: form error {:.1f} um (p95) without, {:.1f} um with it, both predicted", before,
                        after)};
  } catch (const BeyondModel& beyond) {
    return kept(text, beyond.what());
  } catch (const InputError& error) {
    return kept(text, error.diagnostics().front().message);
  }
}

}  // namespace camber::plan
