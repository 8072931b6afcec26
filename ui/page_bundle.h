#pragma once
// The page of camber ui, as it lies in ui/page.
#include <string_view>

namespace camber::ui {

std::string_view page_html();
std::string_view page_script();  ///< ui/page/bundle, made by scripts/bundle-page
std::string_view page_style();

}  // namespace camber::ui
