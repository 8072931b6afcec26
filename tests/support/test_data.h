#pragma once
// Files that tests read. tests/data/README.md lists them, with origin and licence.
#include <string>
#include <string_view>
#include <vector>

namespace camber::tests {

/// Path of a file or folder of tests/data: "nc/nist_cover.nc".
std::string data_path(std::string_view name);

/// Paths of the regular files of a folder of tests/data, sorted.
std::vector<std::string> data_files(std::string_view folder);

/// Path of a text that is packed in tests/data: "linuxcnc/arcs_g64_a.csv" of arcs_g64_a.trace.xz (scripts/pack-trace),
/// "nist/box_op5_hurco02_05of20.txt" of the same name with .xz. It is unpacked into the build folder by the first test
/// that asks for it; later ones, of other processes too, find it there. Throws std::runtime_error where the packed file
/// is missing or damaged.
std::string unpacked_data(std::string_view name);

/// The text of a packed trace, whose bytes are given. Throws std::runtime_error unless it is the text that was packed.
std::string unpacked_trace(std::string_view packed);

/// Path of a file or folder that may not be shipped, in ../shared/data beside the repository; empty where it is not
/// there. A test that gets none is skipped: GTEST_SKIP() << camber::tests::not_shipped(name).
std::string unshipped_data(std::string_view name);

/// Why a test is skipped that needs it: "NAME may not be shipped and is not in ../shared/data".
std::string not_shipped(std::string_view name);

}  // namespace camber::tests
