// The namespace plan comes before the function of that name: clang takes it in no other order.
#include "plan/setup_plan.h"

#include "camber/plan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "api/run.h"
#include "base/folders.h"
#include "base/output_file.h"
#include "kinematics/control_options.h"
#include "machine/machine_presets.h"
#include "nc/dialect.h"
#include "plan/programs.h"
#include "report/plan_summary.h"

namespace camber {
namespace {

struct Planned {
  plan::PlanResult result;
  std::vector<std::pair<std::string, std::string>> files;  ///< see camber::PlanResult
};

std::string extension_of(const plan::PlanInput& input) {
  const nc::Dialect& dialect = kinematics::dialect_of(input.machine.control.kind);
  return dialect.language == nc::LanguageId::iso ? ".nc" : std::string(dialect.file_extension);
}

/// "" for the only set-up, "-2" for the second one.
std::string suffix(const plan::PlanResult& result, std::size_t setup) {
  return result.setups.size() > 1 ? fmt::format("-{}", setup + 1) : std::string();
}

std::vector<std::pair<std::string, std::string>> files_of(const plan::PlanInput& input,
                                                          const plan::PlanResult& result) {
  std::vector<std::pair<std::string, std::string>> out;
  for (std::size_t i = 0; i < result.setups.size(); ++i) {
    const plan::SetupPlan& s = result.setups[i];
    const std::string end = suffix(result, i);
    out.emplace_back(fmt::format("operations{}.toml", end), plan::operations_toml(input, s, s.best));
    for (std::size_t p = 0; p < s.plans.size() && s.plans.size() > 1; ++p)
      out.emplace_back(fmt::format("plan-{}{}.toml", plan::to_string(s.plans[p].division), end),
                       plan::operations_toml(input, s, p));
  }
  return out;
}

std::string absolute(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).lexically_normal().string();
}

/// True where blank and part lie on the machine as in their files.
bool lies_as_given(const plan::PlanInput& input, const plan::SetupPlan& setup) {
  return setup.setup.turn.isIdentity() && input.mm_per_unit == 1;
}

/// The job of camber copy; solids that are turned or scaled are files beside it.
void add_copy_job(const plan::PlanInput& input, const plan::SetupPlan& setup, const std::string& end,
                  std::vector<std::pair<std::string, std::string>>& files) {
  const bool as_given = lies_as_given(input, setup), part_given = as_given && !plan::is_stock_file(input.part_path);
  const std::string part = fmt::format("part{}.stl", end), blank = fmt::format("blank{}.stl", end);
  if (!part_given) files.emplace_back(part, plan::stl_text(setup.part));
  if (!as_given) files.emplace_back(blank, plan::stl_text(setup.blank));
  machine::Job job = plan::copy_job(input, part_given ? absolute(input.part_path) : part, as_given ? "" : blank);
  if (!machine::is_preset(job.machine_path)) job.machine_path = absolute(job.machine_path);
  job.program = fmt::format("program{}{}", end, extension_of(input));
  if (as_given) job.stock.mesh = absolute(job.stock.mesh), job.stock.vdb = absolute(job.stock.vdb);
  files.emplace_back(fmt::format("job{}.toml", end),
                     plan::copy_job_toml(job, plan::copy_operations(input, setup.plans[setup.best])));
}

using Programs = std::vector<std::optional<plan::PlanProgram>>;  ///< programs of the plans of one set-up

/// Makes the programs of the plan that is taken, with `all` of every complete plan, and enters their times there.
Programs make_programs(const plan::PlanInput& input, plan::SetupPlan& setup, const std::string& end, bool all,
                       Diagnostics& diagnostics) {
  Programs out(setup.plans.size());
  const TemporaryFolder folder;  // of a part that is a stock
  machine::Job job = plan::copy_job(input, input.part_path, "");
  if (plan::is_stock_file(input.part_path)) {
    job.part.mesh = folder.path() + "/part.stl";
    write_file(job.part.mesh, plan::stl_text(setup.part));
  }
  std::map<std::string, std::size_t> by_operations;  // plans that come to the same share their program
  for (std::size_t p = 0; p < setup.plans.size(); ++p) {
    plan::PlannedDivision& of = setup.plans[p];
    if (p != setup.best && !(all && of.complete())) continue;
    const std::string operations = plan::copy_job_toml(job, plan::copy_operations(input, of));
    const auto [same, is_new] = by_operations.emplace(operations, p);
    const std::string name = all ? fmt::format("program-{}{}{}", plan::to_string(of.division), end, extension_of(input))
                                 : fmt::format("program{}{}", end, extension_of(input));
    out[p] = is_new ? plan::make_program(input, job, of, name, diagnostics) : out[same->second];
    of.program = out[p]->figures;
    for (std::size_t i = 0; i < of.operations.size(); ++i) {
      of.operations[i].time_s = out[p]->times_s[i];
      if (!out[p]->notes[i].empty()) of.operations[i].notes.push_back(out[p]->notes[i]);
    }
  }
  return out;
}

/// Returns the index of the plan that is best by the times of the programs.
std::size_t best_program(const plan::SetupPlan& setup) {
  std::vector<plan::PlanFigures> figures;
  for (const plan::PlannedDivision& p : setup.plans)
    figures.push_back({p.complete() && p.program.has_value(), p.program ? p.program->time_s : p.nominal_time_s,
                       p.tool_changes, p.form_error_p95_mm});
  return plan::best_plan(figures);
}

/// program.nc and one an operation of the plan that is taken, program-<division>.nc of the others; .h, .mpf where the
/// control reads those.
void add_programs(const plan::SetupPlan& setup, const Programs& programs, const std::string& end,
                  const std::string& extension, std::vector<std::pair<std::string, std::string>>& files) {
  for (std::size_t p = 0; p < programs.size(); ++p)
    if (programs[p] && p != setup.best)
      files.emplace_back(fmt::format("program-{}{}{}", plan::to_string(setup.plans[p].division), end, extension),
                         programs[p]->whole);
  const plan::PlanProgram& taken = *programs[setup.best];
  for (std::size_t i = 0; i < taken.each.size(); ++i)
    if (!taken.each[i].empty())
      files.emplace_back(fmt::format("operation{}-{:02}{}", end, i + 1, extension), taken.each[i]);
  files.emplace_back(fmt::format("program{}{}", end, extension), taken.whole);
}

void warn_of_turned(const plan::PlanInput& input, const plan::SetupPlan& setup, const std::string& end,
                    Diagnostics& diagnostics) {
  diagnostics.add({Severity::warning,
                   {input.path, 0, 0},
                   fmt::format("{} is turned or in inches: its programs are made by camber copy from job{}.toml",
                               setup.setup.name, end),
                   "plan-programs",
                   {}});
}

bool same_conditions(const plan::Case& a, const plan::Case& b) {
  constexpr double kSame = 1e-3;
  return plan::to_toml(plan::Case{a.content}) == plan::to_toml(plan::Case{b.content}) &&
         std::abs(a.speed_m_per_min - b.speed_m_per_min) <= kSame * a.speed_m_per_min && a.feed_mm_per_min &&
         b.feed_mm_per_min && std::abs(*a.feed_mm_per_min - *b.feed_mm_per_min) <= kSame * *a.feed_mm_per_min;
}

Planned plan_and_files(const plan::PlanInput& input, const PlanOptions& options, Diagnostics& diagnostics) {
  Planned out{plan::make_plan(input, diagnostics), {}};
  if (!options.operations.empty())
    plan::read_operations(options.operations, input, out.result.setups.front(), diagnostics);
  std::vector<Programs> programs(out.result.setups.size());
  for (std::size_t i = 0; i < programs.size() && (options.programs || options.all_programs); ++i) {
    plan::SetupPlan& setup = out.result.setups[i];
    const std::string end = suffix(out.result, i);
    if (!lies_as_given(input, setup)) {
      warn_of_turned(input, setup, end, diagnostics);
      continue;
    }
    programs[i] = make_programs(input, setup, end, options.all_programs, diagnostics);
    if (options.all_programs && programs.size() == 1) setup.best = best_program(setup);
  }
  out.files = files_of(input, out.result);
  for (std::size_t i = 0; i < programs.size(); ++i) {
    const plan::SetupPlan& setup = out.result.setups[i];
    add_copy_job(input, setup, suffix(out.result, i), out.files);
    if (!programs[i].empty()) add_programs(setup, programs[i], suffix(out.result, i), extension_of(input), out.files);
  }
  return out;
}

LearnedCases learn_cases(const plan::PlanInput& input, const plan::PlanResult& result) {
  LearnedCases out{input.cases.path, SourceText::read(input.cases.path).text()};
  std::vector<plan::Case> known = input.cases.cases;
  for (const plan::SetupPlan& s : result.setups)
    for (const plan::PlanOperation& o : s.plans[s.best].operations) {
      const plan::PlanTool& t = input.tools.at(o.tool);
      plan::Case c{.content = {input.work_material, std::string(to_string(t.use)), t.material, t.coated,
                               o.kind == plan::OperationKind::finish && input.fine, input.fast, t.tool.diameter_mm},
                   .speed_m_per_min = kPi * t.tool.diameter_mm * o.conditions.spindle_rpm / 1000,
                   .feed_mm_per_min = o.conditions.feed_mm_per_min};
      if (o.pattern != plan::Pattern::drilling) {
        c.axial_depth_mm = o.conditions.axial_mm;
        c.radial_depth_mm = o.conditions.radial_mm;
      }
      if (std::ranges::any_of(known, [&](const plan::Case& k) { return same_conditions(k, c); })) continue;
      known.push_back(c);
      out.text += (out.text.ends_with('\n') ? "" : "\n") + plan::to_toml(c);
      ++out.added;
    }
  return out;
}

PlannedOperation operation_of(const plan::PlanOperation& o, std::size_t setup) {
  const plan::Conditions& c = o.conditions;
  return {.setup = setup,
          .primitive = o.primitive,
          .feature = std::string(plan::to_string(o.feature)),
          .kind = std::string(plan::kOperationKinds[static_cast<std::size_t>(o.kind)]),
          .tool = o.tool,
          .mode = std::string(plan::kPatterns[static_cast<std::size_t>(o.pattern)]),
          .joined = o.joined,
          .spindle_rpm = c.spindle_rpm,
          .feed_mm_per_min = c.feed_mm_per_min,
          .radial_mm = c.radial_mm,
          .axial_mm = c.axial_mm,
          .nominal_time_s = o.nominal_time_s,
          .time_s = o.time_s,
          .limit = c.limit,
          .force_N = c.loads.force_N,
          .form_error_um = 1000 * c.loads.form_error_mm,
          .power_W = c.loads.power_W,
          .notes = o.notes};
}

PlanResult result_of(const plan::PlanResult& planned) {
  PlanResult out;
  out.unmachined = report::plan_failures(planned);
  out.success = out.unmachined.empty();
  out.removal_mm3 = planned.removal_mm3;
  const plan::SetupPlan& first = planned.setups.front();
  for (std::size_t i = 0; i < first.plans.size(); ++i) {
    const plan::PlannedDivision& p = first.plans[i];
    out.alternatives.push_back({std::string(plan::to_string(p.division)), p.nominal_time_s,
                                p.program ? p.program->time_s : 0, p.tool_changes, 1000 * p.form_error_p95_mm,
                                p.complete(), i == first.best});
  }
  for (std::size_t s = 0; s < planned.setups.size(); ++s)
    for (const plan::PlanOperation& o : planned.setups[s].plans[planned.setups[s].best].operations)
      out.operations.push_back(operation_of(o, s));
  return out;
}

}  // namespace

PlanResult v0::plan(const std::string& path, const PlanOptions& options, const RunOptions& run_options) {
  PlanResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found;
    const plan::PlanInput input = plan::read_plan_input(path, found);
    const Planned done = plan_and_files(input, options, found);
    run.settle_first(found);
    const double compute_s = run.seconds();
    result = result_of(done.result);
    result.files = done.files;
    result.diagnostics = found.all();
    result.translation = input.machine.translation;
    result.json = report::plan_json(input, done.result, compute_s);
    result.printed = report::plan_text(input, done.result, compute_s);
    if (options.page) result.page = report::plan_page(input, done.result, api::texts_of(found));
    if (options.learn) result.learned = learn_cases(input, done.result);
  });
  return result;
}

std::string v0::cases_error(const std::string& path, const RunOptions& run) {
  Diagnostics found;
  const plan::PlanInput input = plan::read_plan_input(path, found);
  api::Run(run).settle_first(found);
  return report::cases_error_text(input.cases);
}

}  // namespace camber
