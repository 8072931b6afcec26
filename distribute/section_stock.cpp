#include "distribute/section_stock.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace camber::distribute {

using namespace motion;
using namespace simulate;

using removal::Region;
using removal::Stock;
using removal::StockPart;

SectionPlace::SectionPlace(const PathStretch& path, std::size_t section_, std::size_t sections)
    : pieces(path_pieces(path)), section(section_) {
  for (std::size_t s = 0; s < sections; ++s) ranges.push_back(section_pieces(pieces, s, sections));
  own = ranges[section];
}

SectionPlace::SectionPlace(const PathStretch& path, std::size_t section_, std::vector<PieceRange> ranges_)
    : pieces(path_pieces(path)), ranges(std::move(ranges_)), section(section_), own(ranges[section_]) {}

JoinOwnPiece pieces_of(const OwnSweep& own) {
  if (own.open)
    return [next = own.open()](std::size_t, Stock& stock, const Region& within) {
      const std::string bytes = next();
      ByteReader in(bytes);
      StockPart::read(in).join_to(stock, &within);
    };
  return [in = ByteReader(own.bytes)](std::size_t, Stock& stock, const Region& within) mutable {
    StockPart::read(in).join_to(stock, &within);
  };
}

JoinOwnPiece pieces_of(const OwnSolution& own) {
  return [&own](std::size_t piece, Stock& stock, const Region& within) {
    own.pieces[piece].stock.join_to(stock, &within);
  };
}

StockBefore::StockBefore(const Stock& blank, const SectionPlace& place,
                         std::vector<const std::vector<StockPart>*> others, JoinOwnPiece own, const Region& within)
    : place_(place), own_(std::move(own)), within_(within), stock_(blank), next_(place.own.begin) {
  for (std::size_t s = 0; s < place.section; ++s) {
    std::size_t part = 0;
    for (const RunPieces& r : place.runs(s)) {
      enter(r.run);
      others[s]->at(part++).join_to(stock_, &within_);
    }
  }
}

void StockBefore::enter(std::size_t run) {
  if (run_ == run) return;
  before_run_.emplace(stock_);
  run_ = run;
}

void StockBefore::advance_to(std::size_t piece) {
  while (next_ < piece) {
    enter(place_.pieces[next_].run);
    own_(next_ - place_.own.begin, stock_, within_);
    ++next_;
  }
  enter(place_.pieces[piece].run);
}

std::vector<BendBefore> bends_before(const SectionPlace& place, const std::vector<SolvedSection>& round,
                                     const OwnSolution& own) {
  std::vector<BendBefore> out(place.own.end - place.own.begin);
  if (round.empty()) return out;
  BendBefore now;
  std::optional<std::size_t> run;
  const auto enter = [&](std::size_t next) {
    if (run != next) now = {};
    run = next;
  };
  for (std::size_t s = 0; s < place.section; ++s) {
    const std::vector<RunPieces> runs = place.runs(s);
    for (std::size_t r = 0; r < runs.size(); ++r) {
      enter(runs[r].run);
      now.largest_mm = std::max(now.largest_mm, round[s].largest_bend_mm.at(r));
    }
    if (!runs.empty()) now.rows = round[s].last_bend;
  }
  for (std::size_t p = place.own.begin; p < place.own.end; ++p) {
    enter(place.pieces[p].run);
    out[p - place.own.begin] = now;
    const BendBefore& bend = own.pieces[p - place.own.begin].cut.bend;
    now = {bend.rows, std::max(now.largest_mm, bend.largest_mm)};
  }
  return out;
}

double largest_difference_mm(const BendBefore& a, const BendBefore& b) {
  if (a.rows.size() != b.rows.size()) return std::max(a.largest_mm, b.largest_mm);
  float out = 0;
  for (std::size_t i = 0; i < a.rows.size(); ++i) out = std::max(out, std::abs(a.rows[i] - b.rows[i]));
  return static_cast<double>(out);
}

}  // namespace camber::distribute
