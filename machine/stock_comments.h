#pragma once
// The blank as comments of a program give it.
#include <optional>
#include <string>

#include "base/diagnostics.h"
#include "machine/job.h"

namespace camber::machine {

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
