#pragma once
// One file out of a zip file.
#include <string>

#include "base/diagnostics.h"

namespace camber::machine {

/// The text of the entry `name` of the zip file `path`, in whatever folder of it; messages about it name
/// "path/name". Throws InputError [file-missing] and, with `check`: no zip file, no such entry, over 64 MB, damaged.
SourceText read_zip_entry(const std::string& path, const std::string& name, const std::string& check);

}  // namespace camber::machine
