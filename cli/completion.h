#pragma once
// Scripts that complete camber's words at a shell's prompt, made from what the command line takes.
#include <string>

namespace CLI {
class App;
}

namespace camber::cli {

/// shell: "bash", "zsh" or "fish". To be loaded by it, or to lie where it looks for completions.
std::string completion_script(const CLI::App& app, const std::string& shell);

}  // namespace camber::cli
