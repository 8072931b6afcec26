#pragma once
// What a section has computed: its part for the others, joined over its pieces, and what it keeps for itself, piece by
// piece.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "removal/form_error.h"
#include "removal/stock.h"
#include "simulate/cut.h"

namespace camber::distribute {

/// Amount of work, for the efficiency of many.
struct SectionWork {
  std::size_t stamps = 0;  ///< carved, read or marked
  std::size_t voxels = 0;  ///< voxels of the parts that were made
};

/// The material that a section has carved out of the raw stock, for the others.
struct SweptSection {
  std::vector<removal::StockPart> stock;     ///< cut by the program; one per run of which the section has pieces
  removal::StockPart target;                 ///< cut by the nominal path
  removal::StockPart allowance;              ///< cut by the target program with the cutter shrunk by the allowance
  double target_mm3 = 0, allowance_mm3 = 0;  ///< sums over pieces
  SectionWork work;

  /// The part of it that a section reading within `region` needs.
  SweptSection within(const removal::Region& region, double voxel_mm) const;
  void write(ByteWriter& out) const;
  static SweptSection read(ByteReader& in);
};
/// The same of the program alone, one per piece; no other section reads it. Pieces are read one after the other: they
/// stay the bytes that they are in a file, and those of a long section stay there.
struct OwnSweep {
  std::string bytes;
  /// Begins to read pieces that are elsewhere: each call of the result gives the bytes of the next one. Empty: they are
  /// in `bytes`.
  std::function<std::function<std::string()>()> open{};

  void add(const removal::StockPart& piece);
};

/// A mark on a point of the target's surface.
struct SurfaceMark {
  Vec3 place_mm = Vec3::Zero();  ///< place of the point; no two are at one place
  double error_mm = 0;
  std::int32_t stamp = -1;
  std::int32_t unused = 0;  ///< no byte of a file is left to chance
};
using SurfaceMarks = std::vector<SurfaceMark>;  ///< in the order of the map's points

/// The solution of a section, for the others and for the merge.
struct SolvedSection {
  std::vector<removal::StockPart> stock;  ///< static: what the deflected cutter cut, one per run
  std::vector<double> largest_bend_mm;    ///< static: one per run
  std::vector<float> last_bend;           ///< static: BendBefore::rows of its last piece
  struct Round {
    std::uint64_t solved_again = 0;  ///< pieces
    double largest_change_um =
        0;  ///< largest change of the stock before a piece, or of the tool's bend there, since the round before
  };
  std::vector<Round> history;  ///< from the second round on
  SectionWork work;
  // For the merge.
  std::vector<simulate::CutResult> cuts;  ///< one per piece, without bend
  SurfaceMarks marks, contour;            ///< the deepest of all pieces; contour: of the target program

  /// The part of it that a section reading within `region` needs; nothing that only the merge needs.
  SolvedSection within(const removal::Region& region, double voxel_mm) const;
  void write(ByteWriter& out) const;
  static SolvedSection read(ByteReader& in);
};

/// A piece that was solved.
struct SolvedPiece {
  simulate::CutResult cut;
  std::vector<removal::PointMark> marks;  ///< on the section's map
  removal::StockPart stock;               ///< static: what the deflected cutter cut
};
/// The part of a solution that the next rounds of the same section read.
struct OwnSolution {
  std::vector<SolvedPiece> pieces;

  void write(ByteWriter& out) const;
  static OwnSolution read(ByteReader& in);
};

/// Bytes of a part.
template <class Part>
std::string bytes_of_part(const Part& part) {
  ByteWriter out;
  part.write(out);
  return out.take();
}
template <class Part>
Part part_from(std::string_view bytes) {
  ByteReader in(bytes);
  return Part::read(in);
}

}  // namespace camber::distribute
