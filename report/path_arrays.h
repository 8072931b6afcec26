#pragma once
// The path of a program as a file of arrays, for pages and programs that draw it: camber check --path.
#include <string>

#include "report/path_picture.h"

namespace camber::report {

/// Points that such a file has at most; longer paths are thinned.
constexpr std::size_t kMaxPathPoints = 4'000'000;

/// One line of JSON, padded with blanks to a multiple of four bytes, then the arrays that it names, little endian, each
/// padded to a multiple of four bytes:
///   {"camber_path": 1, "points": N, "origin_mm": [x, y, z], "chord_mm": c, "thinned": false,
///    "arrays": [["x", "f4"], ["y", "f4"], ["z", "f4"], ["line", "u4"], ["feed_mm_per_min", "f4"], ["tool", "u2"],
///               ["kind", "u1"]]}
/// x, y, z: mm from the origin. line: from 1. feed: NaN on rapids. kind: of the way to the point, 0 start, 1 rapid,
/// 2 line, 3 arc. `picture` has tools and feeds (program_picture).
std::string path_arrays(const PathPicture& picture);

/// Writes them. Throws InputError [file-unwritable].
void write_path_arrays(const std::string& path, const PathPicture& picture);

}  // namespace camber::report
