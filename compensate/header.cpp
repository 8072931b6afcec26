#include "compensate/header.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>

#include "machine/force_law.h"

namespace camber::compensate {
namespace {

constexpr std::uint64_t kBasis = 14695981039346656037ull, kPrime = 1099511628211ull;

constexpr std::string_view kEnd = "\xff";  // so that two files are not one

void mix(std::uint64_t& hash, std::string_view text) {
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= kPrime;
  }
}

void add(std::uint64_t& hash, std::string_view text) {
  mix(hash, text);
  mix(hash, kEnd);
}

/// Replaces characters that not every control accepts within a comment.
std::string plain(std::string text) {
  for (char& c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (c == '\n') continue;
    c = std::isalnum(u) || c == '.' || c == '-' || c == '+' || c == ',' || c == '/' ? static_cast<char>(std::toupper(u))
                                                                                    : ' ';
  }
  return text;
}

/// Paths say where a file lies, not what it holds.
machine::Job without_paths(machine::Job job) {
  for (std::string* path :
       {&job.program, &job.machine_path, &job.stock.mesh, &job.stock.vdb, &job.part.mesh, &job.part.program})
    if (!path->empty()) *path = std::filesystem::path(*path).filename().string();
  return job;
}

/// Symbols and values: a unit after the last one that has it, a comma before the edge terms.
std::string material_line(const machine::Material& m) {
  const machine::ForceLawDescription& law = machine::description(m.law);
  std::string out;
  const machine::Coefficient* last = nullptr;
  const auto end_unit = [&] {
    if (last->unit != "1") fmt::format_to(std::back_inserter(out), " {}", last->unit);
  };
  for (const auto& c : law.coefficients) {
    if (std::ranges::find(law.header_keys, c.key) == law.header_keys.end()) continue;
    if (last != nullptr) {
      if (c.unit != last->unit) end_unit();
      out += c.role != last->role && c.role == machine::CoefficientRole::edge ? ", " : " ";
    }
    fmt::format_to(std::back_inserter(out), "{} {:g}", c.symbol, m.*c.field);
    last = &c;
  }
  if (last != nullptr) end_unit();
  return out;
}

}  // namespace

std::string header_lines(const machine::Job& job, const CompensationResult& c, const std::string& version) {
  std::string out = fmt::format("CAMBER {} - PATH COMPENSATED FOR TOOL DEFLECTION\n", version);
  fmt::format_to(std::back_inserter(out),
                 "PREDICTED ERROR RMS {:.1f} UM BEFORE, {:.1f} UM AFTER, 95 PERCENT WITHIN {:.1f} UM\n",
                 c.figures.before_um.rms, c.figures.after_um.rms, c.figures.after_um.p95);
  fmt::format_to(std::back_inserter(out), "LARGEST SHIFT {:.4f} MM OF {:g} ALLOWED, TOLERANCE {:g} UM\n",
                 c.path.max_shift_mm, job.compensation.max_shift_mm, job.compensation.tolerance_um);
  for (const auto& o : c.scope.finishing.operations) {
    if (o.compensated_moves == 0) continue;
    const machine::Tool& t = job.tools.at(o.tool);
    fmt::format_to(std::back_inserter(out), "T{} D{:g} OVERHANG {:g} E {:g} GPA, {} FLUTES\n", t.number, t.diameter_mm,
                   t.overhang_mm, t.youngs_modulus_MPa / 1000, t.flutes);
  }
  return plain(out + material_line(job.material));
}

RunningHash::RunningHash() : hash_(kBasis) {}
void RunningHash::add(std::string_view text) { mix(hash_, text); }
std::string RunningHash::text() const {
  std::uint64_t whole = hash_;
  mix(whole, kEnd);
  return fmt::format("{:016X}", whole);
}

std::string hash_of(std::string_view text) {
  RunningHash hash;
  hash.add(text);
  return hash.text();
}

std::string hash_of_inputs(const machine::Job& job) {
  std::uint64_t hash = kBasis;
  const machine::Job plain_job = without_paths(job);
  add(hash, machine::to_toml(plain_job));
  add(hash, machine::to_toml(job.machine));
  for (const auto& path : {job.program, job.stock.mesh, job.stock.vdb, job.part.mesh, job.part.program})
    if (!path.empty()) add(hash, SourceText::read(path).text());
  return fmt::format("{:016X}", hash);
}

}  // namespace camber::compensate
