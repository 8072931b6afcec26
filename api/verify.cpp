#include "camber/verify.h"

#include <filesystem>

#include <fmt/format.h>

#include "api/prediction.h"
#include "base/output_file.h"
#include "compensate/verify_program.h"
#include "machine/assumptions.h"
#include "report/figures_json.h"
#include "report/verdict_text.h"

namespace camber {
namespace {

/// An emitted program and its record.
struct EmittedProgram {
  EmittedFiles files;
  compensate::Record record;
};

EmittedProgram find_emitted(const std::string& place) {
  EmittedProgram out;
  out.files.record = compensate::find_record(place);
  out.record = compensate::read_record(out.files.record);
  compensate::check_record(out.record, out.files.record);
  const std::filesystem::path program = std::filesystem::path(out.files.record).parent_path() / out.record.program;
  out.files.program = program.string();
  out.files.job = std::filesystem::path(program).replace_extension(".verify.toml").string();
  return out;
}

std::string printed_of(const EmittedFiles& files, const compensate::Verification& verification,
                       const report::VerdictText& verdict, double compute_s) {
  std::string out = fmt::format("{}\n{}", files.program, report::verify_text(verification, compute_s));
  if (verdict.success) out += verdict.headline + "\n";
  return out + fmt::format("the same, with forces and pictures: camber predict {} -o DIR\n", files.job);
}

}  // namespace

EmittedFiles v0::emitted_files(const std::string& place) { return find_emitted(place).files; }

VerifyResult v0::verify(const std::string& place, const RunOptions& run_options) {
  VerifyResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found;
    const EmittedProgram emitted = find_emitted(place);
    write_file(emitted.files.job, emitted.record.job);
    const machine::Job job = machine::read_job(emitted.files.job, found);
    compensate::Verification v;
    try {
      v = compensate::verify(job, emitted.record, found, run.progress());
    } catch (const BeyondModel&) {
      run.settle_first(found);
      throw;
    }
    run.settle_first(found);
    const double compute_s = run.seconds();
    const report::VerdictText verdict = report::verdict_text(v, job.compensation);
    const std::vector<std::string> assumed = machine::assumptions(job);
    result = {.program = emitted.files.program,
              .job = emitted.files.job,
              .success = verdict.success,
              .headline = verdict.headline,
              .reasons = verdict.reasons,
              .error_um = api::figures_of(v.plain.error_um),
              .deflection_um = api::figures_of(v.plain.deflection_um),
              .contour_um = api::figures_of(v.plain.contour_um),
              .gouge_depth_p999_um = v.depth.gouge_depth_p999_um,
              .depth_limit_um = v.depth_limit_um,
              .machine_time_s = v.machine_time_s,
              .diagnostics = found.all()};
    result.json = machine::with_assumptions(report::verify_json(v, job.compensation, compute_s), assumed);
    result.printed = machine::assumptions_text(assumed) + printed_of(emitted.files, v, verdict, compute_s);
  });
  return result;
}

}  // namespace camber
