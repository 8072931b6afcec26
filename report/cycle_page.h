#pragma once
// The page of camber time: where the time goes, for one machine or several side by side.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "feedmodel/cycle_time.h"
#include "report/machine_page.h"
#include "report/path_picture.h"

namespace camber::report {

struct CycleRow {
  std::string name;            ///< name of the case or point
  std::vector<double> values;  ///< values of the swept keys
  feedmodel::CycleTime time;
};

struct CyclePage {
  std::string title, subtitle;
  std::vector<std::string> keys;  ///< swept; empty: cases or a single run
  std::vector<CycleRow> rows;     ///< at least one; each with a value a key
  PathPicture picture;            ///< picture of the first row's program on its machine; without points: none
  MachineCards machine;           ///< instead of it, where the program turns rotary axes of the machine
  std::vector<std::string> notes;
};

/// Explanation of e and k in the tables; the limit is that of a program which stops after every block (Yan & Shirase
/// 1997).
inline constexpr const char* kRatiosSentence =
    "e = actual / commanded feed; k = F^2 / (a d), a the acceleration, d the mean block length. With a stop after "
    "every "
    "block e would be 1 / (1 + k), from k = 1 on 1 / (2 sqrt(k)).";

/// One sentence: what takes most of the time, and what of the cutting time acceleration, corners and short blocks cost.
std::string dominance_sentence(const feedmodel::CycleTime& time);

/// The page's text, UTF-8, self-contained: the path as report/web draws it, the other pictures as SVG. The same data
/// give the same bytes.
std::string cycle_page(const CyclePage& page);

/// Bars of the kinds of time, a row each.
std::string split_bars_svg(const std::vector<CycleRow>& rows);
/// Total and cutting time over the values of the first swept key.
std::string sweep_svg(const CyclePage& page);
std::string distance_svg(const feedmodel::DistanceHistogram& histogram, const std::string& name);

}  // namespace camber::report
