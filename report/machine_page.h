#pragma once
// The page that shows a machine run a program: the part turns on the table, the head turns, every axis over time.
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/triangle_mesh.h"
#include "kinematics/pose_track.h"
#include "machine/machine_model.h"
#include "report/html_report.h"

namespace camber::report {

struct MachinePage {
  std::string title{}, subtitle{};
  std::vector<Figure> figures{};  ///< the first four are shown large
  std::vector<TextTable> tables{};
  std::vector<std::string> warnings{}, notes{};
  std::string time_label = "time at programmed feeds, s";  ///< below the plots
  std::optional<TriangleMesh> part{};                      ///< in the frame of the work offset; none: the path alone
  Vec3 work_origin_mm = Vec3::Zero();                      ///< origin of the work offset, in the machine frame
  double tool_diameter_mm = 0;                             ///< 0: not known, drawn slim
  std::size_t max_samples = 20000;    ///< above this many, samples are left out; the extremes of every joint stay
  std::size_t max_triangles = 60000;  ///< a part of more triangles is not drawn
};

/// Cards of a page that shows the machine.
struct MachineCards {
  std::string pictures;            ///< cards of machine and axes; without samples one that says so
  std::string axes;                ///< axis_table; empty without samples
  std::string scripts;             ///< before the end of the body
  std::vector<std::string> notes;  ///< those of the page first
};
/// Makes the cards. Of `page` only the part, the label of time and the notes are used. Requires
/// machine.kinematics.given().
MachineCards machine_cards(const machine::Machine& machine, std::span<const kinematics::PoseSample> samples,
                           const MachinePage& page);

/// The page's text, UTF-8, self-contained. The same data give the same bytes. Without samples the page has no picture.
/// Requires machine.kinematics.given().
std::string machine_page(const machine::Machine& machine, std::span<const kinematics::PoseSample> samples,
                         const MachinePage& page);

/// Writes the page beside its place and renames it. Throws InputError [file-unwritable].
void write_machine_page(const std::string& path, const machine::Machine& machine,
                        std::span<const kinematics::PoseSample> samples, const MachinePage& page);

/// Lowest and highest position of every axis of the chain with its travel, and the first line beyond it.
TextTable axis_table(const machine::Machine& machine, std::span<const kinematics::PoseSample> samples);

}  // namespace camber::report
