#pragma once
// The files that a command writes: looked at before the work.
#include <string>
#include <vector>

namespace camber::cli {

/// Throws InputError where an output cannot be written [file-unwritable], is one of the files that are read
/// [output-is-input], or is named twice [output-twice]: said before the work, not after it. Empty paths do not count.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// The same for a folder that is made where it is not there.
void check_output_folder(const std::string& path);

}  // namespace camber::cli
