#pragma once
// The card with the picture of a path, and what its script reads (report/web/src/path.js).
#include <string>
#include <string_view>

#include "base/json.h"
#include "report/packed_arrays.h"
#include "report/path_picture.h"

namespace camber::report {

/// Points of a picture that a page draws at most, of each path.
constexpr std::size_t kMaxPicturePoints = 80000;

/// The card itself; empty places for buttons, picture and legend. `hint`: what the reader may do with it, plain text.
std::string path_card_html(std::string_view title, std::string_view hint);

/// A picture as the script reads it; tools and feeds where the picture has them.
Json picture_json(PackedArrays& arrays, const PathPicture& picture, std::string_view name);

/// End of the page: index, arrays and script.
std::string path_scripts_html(const Json& index, const PackedArrays& arrays);

/// The card of a whole program, rapids and cutting apart, feeds as a further view; and its scripts.
struct ProgramCard {
  std::string card, scripts;
};
ProgramCard program_card(std::string_view title, const PathPicture& picture);

/// How much of the path the picture leaves out; empty: nothing. `which`: "The picture of the program before".
std::string thinned_note(const PathPicture& picture, std::string_view which);

}  // namespace camber::report
