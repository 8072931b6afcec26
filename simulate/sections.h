#pragma once
// A prediction in sections of the path, for several processes: what each computes alone, and how the parts are joined.
//
// The path is cut in pieces at places that depend on the path alone. Every piece is computed by itself, from the stock
// that the pieces before it leave, so that the result does not depend on who computes it. A section is a number of
// consecutive pieces.
//
// 1. Sweep: each piece is carved alone out of the raw stock: the path as the machine runs it, the nominal path of the
//    target, and what lies above the allowance. The stock before a piece is the pointwise maximum of the parts before.
// 2. Solve: forces, deflections and marks of each piece from that stock. In rigid coupling this is all. In static
//    coupling the deflected cutter leaves another stock, so that rounds follow: each piece whose stock has changed by
//    more than kSettled_mm where it cuts, or which the tool enters bent in another way, is solved again from the parts
//    of the round before.
// 3. Merge: loads, marks and stock of all pieces become one prediction.
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "removal/form_error.h"
#include "removal/stock_part.h"
#include "simulate/pieces.h"

namespace camber::simulate {

/// Stamps from ... from + count - 1 of a run.
struct PathPiece {
  std::size_t run = 0, from = 0, count = 0;
};
inline constexpr std::size_t kPieceStamps = 1000;  ///< at most, in milling; runs of holes are not cut
std::vector<PathPiece> path_pieces(const removal::StampPath& path);

/// Half open.
struct PieceRange {
  std::size_t begin = 0, end = 0;
};
/// The pieces of a section, 0 ... sections - 1: about as many stamps each. May be empty.
PieceRange section_pieces(const std::vector<PathPiece>& pieces, std::size_t section, std::size_t sections);

/// What was done, for the efficiency of many.
struct SectionWork {
  std::size_t stamps = 0;  ///< carved, read or marked
  std::size_t voxels = 0;  ///< of the parts that were made
};

/// A section's pieces of three paths, each carved alone.
struct SweptSection {
  std::vector<removal::StockPart> stock;      ///< of the program
  std::vector<removal::StockPart> target;     ///< of the nominal path
  std::vector<removal::StockPart> allowance;  ///< of the target program with the cutter shrunk by the allowance
  double target_mm3 = 0, allowance_mm3 = 0;   ///< sums over pieces
  SectionWork work;

  void write(ByteWriter& out) const;
  static SweptSection read(ByteReader& in);
};
SweptSection sweep_section(const machine::Job& job, const Programs& programs, std::size_t section, std::size_t sections,
                           Diagnostics& diagnostics);

/// A mark on a point of the target's surface.
struct SurfaceMark {
  Vec3 place_mm = Vec3::Zero();  ///< of the point: none has another one's
  double error_mm = 0;
  std::int32_t stamp = -1;
  std::int32_t unused = 0;  ///< no byte of a file is left to chance
};
using SurfaceMarks = std::vector<SurfaceMark>;  ///< in the order of the map's points

/// A piece that was solved.
struct SolvedPiece {
  CutResult cut;
  SurfaceMarks marks;
  removal::StockPart stock;  ///< static: what the deflected cutter cut
};
struct SolvedSection {
  std::vector<SolvedPiece> pieces;
  std::vector<SurfaceMarks> contour;  ///< of the target program's pieces
  struct Round {
    std::uint64_t solved_again = 0;  ///< pieces
    double largest_change_um = 0;  ///< of the stock before a piece, or of the tool's bend there, since the round before
  };
  std::vector<Round> history;  ///< from the second round on
  SectionWork work;

  void write(ByteWriter& out) const;
  static SolvedSection read(ByteReader& in);
};

/// Change of the stock that a piece must feel, or of the deflection with which the tool enters it, before it is solved
/// again.
inline constexpr double kSettled_mm = 5e-5;

/// All sections' parts, in order.
struct SectionParts {
  std::vector<SweptSection> swept;
  std::vector<SolvedSection> last;         ///< of the round before this one, or, to be merged, of the last one
  std::vector<SolvedSection> before_last;  ///< of the round before that
};
struct SolveOptions {
  std::size_t section = 0, sections = 1;
  std::optional<std::size_t> turn_from{};  ///< see PredictOptions
  std::function<void(double)> progress{};
};
/// Solves a section; in a later round only the pieces whose stock has changed.
SolvedSection solve_section(const machine::Job& job, const Programs& programs, const SectionParts& parts,
                            const SolveOptions& options, Diagnostics& diagnostics);

/// What a section reads of others' parts: the rest may be left out, here. Empty where the section has nothing.
removal::Region section_region(const machine::Job& job, const Programs& programs, std::size_t section,
                               std::size_t sections);
void keep_within(SweptSection& section, const removal::Region& region, double voxel_mm);
/// Keeps nothing but stocks, and how the tool was bent.
void keep_stock_within(SolvedSection& section, const removal::Region& region, double voxel_mm);

/// Joins the target's parts instead of sweeping it. `parts` must outlive the result; `within` (null: everywhere) bounds
/// what is joined.
TargetWork joined_target(const SectionParts& parts, const removal::Region* within = nullptr);

/// The prediction of all parts. Target: made by joined_target().
Prediction merge_sections(const machine::Job& job, Target& target, const SimulatedProgram& program,
                          const SectionParts& parts);

}  // namespace camber::simulate
