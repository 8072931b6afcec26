#pragma once
// One file out of a zip file.
#include <string>

#include "base/diagnostics.h"

namespace camber::machine {

/// The text of the first entry of the zip file `path` whose name ends with `ending`; messages about it name
/// "path/entry". Throws InputError [file-missing] and, with `check`: no zip file, no such entry, over 64 MB, damaged.
SourceText read_zip_entry(const std::string& path, const std::string& ending, const std::string& check);

}  // namespace camber::machine
