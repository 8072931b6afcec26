#pragma once
// The files that a command writes: looked at before the work, and each of them tried after it.
#include <functional>
#include <string>
#include <vector>

#include "base/diagnostics.h"

namespace camber::cli {

/// Throws InputError where an output cannot be written [file-unwritable], is one of the files that are read
/// [output-is-input], or is named twice [output-twice]: said before the work, not after it. Empty paths do not count.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// The same for a folder that is made where it is not there.
void check_output_folder(const std::string& path);

/// Makes it where it is not there. Throws InputError [file-unwritable].
void make_folder(const std::string& path);

/// Runs `write` and adds to `failed` what it could not write: when a disk is full, what still can be written is, and
/// the figures are printed.
void try_to_write(const std::function<void()>& write, Diagnostics& failed);

}  // namespace camber::cli
