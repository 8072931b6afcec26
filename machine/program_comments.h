#pragma once
// Comments of an NC program as text, with the code beside them, and the blank that CAM systems write there.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/workpiece.h"

namespace camber::machine {

/// A line of the program that has a comment: (...), from ; to the end of the line, [...] at the beginning of a line,
/// or a structure line of Klartext (* ...).
struct CommentedLine {
  std::size_t line = 0;  ///< 1-based
  std::string code;      ///< what stands outside of the comments, in upper case
  std::string comment;   ///< without its brackets; of several comments the first
};

/// The code of any line, comments left out, in upper case.
std::string code_of_line(const SourceText& program, std::size_t line);

std::vector<CommentedLine> commented_lines(const SourceText& program);

/// A box, or its size and what is said of the program's zero in it.
struct CommentedStock {
  std::optional<Box> box;
  std::optional<Vec3> size_mm;
  std::optional<bool> zero_on_table;   ///< Z0 is the lower face; false: the upper one
  std::optional<bool> zero_in_centre;  ///< X0 Y0 is the middle; false: the lower left corner
  std::string from, what;              ///< "p.nc:3", the comment
};

/// "(STOCK/BLOCK,X,Y,Z,x0,y0,z0)" (CutViewer, Carbide Create; x0 y0 z0: the program's zero, from the lower corner),
/// "(stockMin:0.00mm, 0.00mm, -18.00mm)" with stockMax, "( Material Size)" with "( X= 100.0, Y= 50.0, Z= 12.0)",
/// "( Min Extents: X= ...)" with Max (Vectric), "[MATERIAL size: 12.1\" x 12.6\" x 0.17\"]", "(STOCK SIZE 100 X 50 X
/// 20)". The program's zero: "XYZ Origin=Center - Material Surface", "Z Zero Position: Table Surface". Numbers without
/// a unit are in the program's. Nothing where no comment gives a size.
std::optional<CommentedStock> stock_in_comments(const SourceText& program, bool inch);

}  // namespace camber::machine
