#pragma once
// The [material] table of a job or of a fitted material file, in and out.
#include <string>
#include <vector>

#include "machine/material.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// Problems go to the table's diagnostics; the material is then not fit for use.
///
/// `preset` names a set of the library; other keys override its values. The law is `law`, else the preset's, else
/// what the keys show (kc1_1_MPa or kc_by_feed: kienzle), else linear. Kienzle's tangential pair is kc1_1_MPa and mc,
/// or kc_by_feed = [[feed per tooth mm, kc MPa], ...] as catalogues give it; the radial and axial pairs are kr1_1_MPa
/// and mr, ka1_1_MPa and ma, or krc_ratio and kac_ratio (fraction of the tangential force, same exponent).
/// Checks: [material-preset], [material-law], [key-unused], [key-missing], [value-range].
Material read_material(TomlTable table);

/// The table itself, or the [material] of the file that it names (`file = "material.toml"`, as fit-force writes it);
/// paths count from `folder`. Checks as above and [file-missing].
Material read_material_table(TomlTable table, const std::string& folder, Diagnostics& diagnostics);

/// The coefficients that material_text writes for a law.
std::vector<double Material::*> coefficient_fields(ForceLaw law);

/// The same table as text, every value filled in, without its header line.
std::string material_text(const Material& material);

}  // namespace camber::machine
