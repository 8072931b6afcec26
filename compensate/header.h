#pragma once
// Writes the header comment of the emitted program (--header, --header-hash).
#include <cstdint>
#include <string>
#include <string_view>

#include "compensate/compensate_path.h"
#include "machine/job_file.h"

namespace camber::compensate {

/// Lines of capitals, digits and blanks without brackets, for nc::EmitOptions::header_comment: what was done, with what
/// model. `version`: of the program that did it.
std::string header_lines(const machine::Job& job, const CompensationResult& result, const std::string& version);

/// 16 hexadecimal digits of a text (FNV-1a, 64 bits; distinguishes versions, not cryptographic).
std::string hash_of(std::string_view text);
/// Hashes a text that comes in pieces.
class RunningHash {
 public:
  RunningHash();
  void add(std::string_view text);
  std::string text() const;

 private:
  std::uint64_t hash_;
};

/// 16 hexadecimal digits over everything the result depends on: the contents of the program, the machine and of every
/// file that the job reads, and the job with every default (FNV-1a, 64 bits; distinguishes versions, not
/// cryptographic). Throws InputError where a file cannot be read.
std::string hash_of_inputs(const machine::Job& job);

}  // namespace camber::compensate
