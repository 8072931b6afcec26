#pragma once
// The figures of camber posture: JSON, text for a terminal, and the page.
#include <cstddef>
#include <string>
#include <vector>

#include "kinematics/pose_track.h"
#include "machine/job_file.h"
#include "nc/five_axis_words.h"
#include "posture/posture_program.h"

namespace camber::report {

struct PosturedProgram {
  posture::Postured postured;    ///< without a text where no direction is clear
  double time_s = 0;             ///< machine time of the whole program
  double given_time_s = 0;       ///< and of the given one
  std::size_t blocked_line = 0;  ///< 1-based; 0: none
  std::size_t unclear_line = 0;  ///< the first of figures.unclear, 1-based; 0: none
  nc::OneDirection written = nc::OneDirection::tip;
};

/// With a step the rows of a table, with ever less overhang as long as the tool stays clear; without: one.
struct PosturedOverhangs {
  std::vector<PosturedProgram> rows;  ///< the first may be blocked, and not be clear
  std::size_t chosen = 0;             ///< whose program is written

  const PosturedProgram& program() const { return rows[chosen]; }
};

/// What was asked for.
struct PostureAsked {
  std::string program;  ///< name of the given one
  const machine::Job* job = nullptr;
  posture::PostureOptions options;
  double overhang_step_mm = 0;
};

/// Neither blocked nor unclear anywhere.
bool clear(const posture::Postured& row);
/// The first row of the least expected error.
std::size_t least_error(const std::vector<PosturedProgram>& rows);

/// With a line end: the figures of the row that is written, and where overhangs were asked for those of all.
std::string posture_json(const PosturedOverhangs& overhangs, const PostureAsked& asked);

/// For a terminal: of the row that is written, and, where overhangs were asked for, before it of all rows.
std::string posture_text(const PosturedOverhangs& overhangs, const PostureAsked& asked);

/// The page's text, UTF-8, self-contained. `track`: positions of the machine along the new program. Throws InputError
/// where the part cannot be read.
std::string posture_page(const PosturedOverhangs& overhangs, const PostureAsked& asked,
                         const std::vector<kinematics::PoseSample>& track, const std::vector<std::string>& warnings);

}  // namespace camber::report
