#pragma once
// What a section finds before each of its pieces: the stock that earlier pieces have left, and how the tool was bent.
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "distribute/section_parts.h"
#include "distribute/section_pieces.h"

namespace camber::distribute {

/// How a path is divided, and which part is a section's own.
struct SectionPlace {
  std::vector<motion::StretchPiece> pieces;
  std::vector<PieceRange> ranges;  ///< ranges of all sections
  std::size_t section = 0;
  PieceRange own{};

  SectionPlace(const motion::PathStretch& path, std::size_t section, std::size_t sections);
  /// Divided as another path of as many pieces.
  SectionPlace(const motion::PathStretch& path, std::size_t section, std::vector<PieceRange> ranges);
  std::vector<RunPieces> runs(std::size_t of_section) const { return runs_of(pieces, ranges[of_section]); }
};

/// Joins to `stock`, in a region, what one piece of a section has cut; asked for each of them once, in order.
using JoinOwnPiece = std::function<void(std::size_t piece, removal::Stock& stock, const removal::Region& within)>;
/// Both must outlive the result.
JoinOwnPiece pieces_of(const OwnSweep& own);
JoinOwnPiece pieces_of(const OwnSolution& own);

/// The stock before one piece of a section after the other.
class StockBefore {
 public:
  /// `others`: what each of the sections before has cut, run by run; `own`: the section's pieces.
  StockBefore(const removal::Stock& blank, const SectionPlace& place,
              std::vector<const std::vector<removal::StockPart>*> others, JoinOwnPiece own,
              const removal::Region& within);

  /// `piece`: of the section's own, ascending.
  void advance_to(std::size_t piece);
  const removal::Stock& stock() const { return stock_; }
  /// Before the first piece of the run.
  const removal::Stock& before_run() const { return *before_run_; }

 private:
  void enter(std::size_t run);

  const SectionPlace& place_;
  JoinOwnPiece own_;
  removal::Region within_;
  removal::Stock stock_;
  std::optional<removal::Stock> before_run_;
  std::optional<std::size_t> run_;
  std::size_t next_;
};

/// How the tool was bent before each piece of a section, as a round has found. Without rows where a piece begins a run,
/// or where there was no round.
std::vector<simulate::BendBefore> bends_before(const SectionPlace& place, const std::vector<SolvedSection>& round,
                                               const OwnSolution& own);

double largest_difference_mm(const simulate::BendBefore& a, const simulate::BendBefore& b);

}  // namespace camber::distribute
