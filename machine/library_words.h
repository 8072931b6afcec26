#pragma once
// Words that the tool libraries of Fusion and HSMWorks share.
#include <optional>
#include <string_view>

#include "machine/job.h"

namespace camber::machine {

/// "ball end mill", "spot drill" ...; nothing for what camber has no cutter for.
std::optional<ToolType> type_of_library(std::string_view word);

/// Modulus of elasticity of "carbide" and "hss"; nothing for others.
std::optional<double> modulus_of_library_GPa(std::string_view word);

}  // namespace camber::machine
