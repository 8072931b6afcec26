#include "nc/siemens/siemens_program_files.h"

#include <algorithm>
#include <filesystem>

#include "nc/siemens/line_parser.h"
#include "nc/siemens/siemens_language.h"

namespace camber::nc::siemens {
namespace {

std::string in_upper_case(std::string text) {
  for (char& c : text) c = upper(c);
  return text;
}

}  // namespace

std::optional<FoundProgram> ProgramFiles::find(const Program& from, const std::string& called) {
  std::string name = called;
  if (const std::size_t slash = name.find_last_of('/'); slash != std::string::npos) name.erase(0, slash + 1);
  if (name.starts_with("_N_")) name.erase(0, 3);
  for (const char* type : {"_SPF", "_MPF", ".SPF", ".MPF"})
    if (name.size() > 4 && name.ends_with(type)) name.resize(name.size() - 4);
  for (const Program* file : {&from, &main_})
    for (const Part& part : tree_of(*file).parts)
      if (part.name == name && !(part.first == 0 && file == &main_)) return FoundProgram{file, part};
  const auto known = files_.find(name);
  if (known == files_.end()) {
    namespace fs = std::filesystem;
    if (!folder_read_) {
      folder_read_ = true;
      fs::path folder = fs::path(main_.source.name()).parent_path();
      if (folder.empty()) folder = ".";
      std::error_code none;
      if (fs::exists(main_.source.name(), none))
        for (const auto& entry : fs::directory_iterator(folder, none))
          if (entry.is_regular_file(none))
            folder_.try_emplace(in_upper_case(entry.path().filename().string()), entry.path().string());
    }
    auto& file = files_[name];
    for (const char* extension : {".SPF", ".MPF", ".CYC", "_SPF", "_MPF", ""}) {
      auto found = folder_.find(name + extension);
      if (found == folder_.end()) found = folder_.find("_N_" + name + extension);
      std::error_code none;
      if (found == folder_.end() || fs::equivalent(found->second, main_.source.name(), none)) continue;
      file = std::make_unique<Program>(read(SourceText::read(found->second), diagnostics_));
      break;
    }
  }
  const auto& file = files_[name];
  if (!file) return std::nullopt;
  for (const Part& part : tree_of(*file).parts)
    if (part.name == name) return FoundProgram{file.get(), part};
  return FoundProgram{file.get(), tree_of(*file).parts.front()};
}

}  // namespace camber::nc::siemens
