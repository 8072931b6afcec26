// Parts of sections as bytes.
#include "distribute/section_parts.h"

namespace camber::distribute {

using namespace simulate;
namespace {

using removal::Region;
using removal::StockPart;

void write_parts(ByteWriter& out, const std::vector<StockPart>& parts) {
  out.value(static_cast<std::uint64_t>(parts.size()));
  for (const StockPart& part : parts) part.write(out);
}

/// A count of things that take a byte each at least.
std::size_t read_count(ByteReader& in) {
  const auto count = in.value<std::uint64_t>();
  if (count > in.left()) throw BytesMissing();
  return count;
}

std::vector<StockPart> read_parts(ByteReader& in) {
  std::vector<StockPart> out(read_count(in));
  for (StockPart& part : out) part = StockPart::read(in);
  return out;
}

std::vector<StockPart> parts_within(const std::vector<StockPart>& parts, const Region& region, double voxel_mm) {
  std::vector<StockPart> out;
  for (const StockPart& part : parts) out.push_back(part.within(region, voxel_mm));
  return out;
}

/// Members of a CutResult that are no lists.
struct CutFigures {
  double chip_mm3, stock_mm3, deflection_max_mm, deflection_limit_mm, extrapolation_sum2_um2, extrapolation_max_um;
  std::uint64_t read, unsettled, extrapolations;
  std::int64_t rounds_max;
};

void write_cut(ByteWriter& out, const CutResult& cut) {
  out.value(CutFigures{cut.chip_mm3, cut.stock_mm3, cut.deflection_max_mm, cut.deflection_limit_mm,
                       cut.extrapolation.sum2_um2, cut.extrapolation.max_um, cut.read, cut.unsettled,
                       cut.extrapolation.count, cut.rounds_max});
  out.list(cut.loads);
  out.list(cut.bend.rows);
  out.value(cut.bend.largest_mm);
  out.list(cut.unsettled_moves);
  out.list(cut.unsettled_reasons);
  out.list(cut.unsettled_stamps);
  out.list(cut.beyond_stamps);
  out.value(static_cast<std::uint64_t>(cut.turn.teeth.size()));
  for (const auto& tooth : cut.turn.teeth) out.list(tooth);
}

CutResult read_cut(ByteReader& in) {
  CutResult out;
  const auto f = in.value<CutFigures>();
  out.chip_mm3 = f.chip_mm3, out.stock_mm3 = f.stock_mm3;
  out.deflection_max_mm = f.deflection_max_mm, out.deflection_limit_mm = f.deflection_limit_mm;
  out.extrapolation = {f.extrapolations, f.extrapolation_sum2_um2, f.extrapolation_max_um};
  out.read = f.read, out.unsettled = f.unsettled;
  out.rounds_max = static_cast<int>(f.rounds_max);
  out.loads = in.list<StampLoad>();
  out.bend.rows = in.list<float>();
  out.bend.largest_mm = in.value<double>();
  out.unsettled_moves = in.list<std::uint32_t>();
  out.unsettled_reasons = in.list<deflection::NoEquilibrium>();
  out.unsettled_stamps = in.list<std::uint32_t>();
  out.beyond_stamps = in.list<std::uint32_t>();
  out.turn.teeth.resize(read_count(in));
  for (auto& tooth : out.turn.teeth) tooth = in.list<deflection::TurnForces::Tooth>();
  return out;
}

}  // namespace

SweptSection SweptSection::within(const Region& region, double voxel_mm) const {
  return {.stock = parts_within(stock, region, voxel_mm),
          .target = target.within(region, voxel_mm),
          .allowance = allowance.within(region, voxel_mm),
          .target_mm3 = target_mm3,
          .allowance_mm3 = allowance_mm3,
          .work = work};
}

void SweptSection::write(ByteWriter& out) const {
  write_parts(out, stock);
  target.write(out);
  allowance.write(out);
  out.value(target_mm3);
  out.value(allowance_mm3);
  out.value(work);
}

SweptSection SweptSection::read(ByteReader& in) {
  SweptSection out;
  out.stock = read_parts(in);
  out.target = StockPart::read(in);
  out.allowance = StockPart::read(in);
  out.target_mm3 = in.value<double>();
  out.allowance_mm3 = in.value<double>();
  out.work = in.value<SectionWork>();
  return out;
}

void OwnSweep::add(const StockPart& piece) { bytes += bytes_of_part(piece); }

SolvedSection SolvedSection::within(const Region& region, double voxel_mm) const {
  return {.stock = parts_within(stock, region, voxel_mm),
          .largest_bend_mm = largest_bend_mm,
          .last_bend = last_bend,
          .history = history,
          .work = work,
          .cuts = {},
          .marks = {},
          .contour = {}};
}

void SolvedSection::write(ByteWriter& out) const {
  write_parts(out, stock);
  out.list(largest_bend_mm);
  out.list(last_bend);
  out.list(history);
  out.value(work);
  out.value(static_cast<std::uint64_t>(cuts.size()));
  for (const CutResult& cut : cuts) write_cut(out, cut);
  out.list(marks);
  out.list(contour);
}

SolvedSection SolvedSection::read(ByteReader& in) {
  SolvedSection out;
  out.stock = read_parts(in);
  out.largest_bend_mm = in.list<double>();
  out.last_bend = in.list<float>();
  out.history = in.list<Round>();
  out.work = in.value<SectionWork>();
  out.cuts.resize(read_count(in));
  for (CutResult& cut : out.cuts) cut = read_cut(in);
  out.marks = in.list<SurfaceMark>();
  out.contour = in.list<SurfaceMark>();
  return out;
}

void OwnSolution::write(ByteWriter& out) const {
  out.value(static_cast<std::uint64_t>(pieces.size()));
  for (const SolvedPiece& piece : pieces) {
    write_cut(out, piece.cut);
    out.list(piece.marks);
    piece.stock.write(out);
  }
}

OwnSolution OwnSolution::read(ByteReader& in) {
  OwnSolution out;
  out.pieces.resize(read_count(in));
  for (SolvedPiece& piece : out.pieces) {
    piece.cut = read_cut(in);
    piece.marks = in.list<removal::PointMark>();
    piece.stock = StockPart::read(in);
  }
  return out;
}

}  // namespace camber::distribute
