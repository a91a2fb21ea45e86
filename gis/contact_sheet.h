#pragma once

#include <string>

#include "core/sparse/dictionary.h"
#include "gis/image.h"

namespace arete {

inline constexpr std::int64_t most_sheet_atoms = 1024;

/// Draws the atoms of a dictionary side by side, in stored order, row by row: the first `most_sheet_atoms`. An atom is drawn as
/// terrain: its finer half where there is one, else the atom itself, in the colours of heights from its own lowest to its own
/// highest sample, lit from the north-west as hillshade does, exaggerated until its slopes have the same root mean square as
/// those of any other: the sheet compares shapes, not heights. A sample is a square of whole pixels; atoms of more than 64
/// samples a side are averaged. `caption` stands below (without a font, find_font, it is left out). The dictionary has at least
/// one atom.
Picture draw_contact_sheet(const Dictionary& dictionary, const std::string& caption);

}  // namespace arete
