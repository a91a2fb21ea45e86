#pragma once

#include <CLI/CLI.hpp>

namespace arete::tools {

// One file per verb: each adds its options and its action to the command line.
// (Declared as they are implemented.)

}  // namespace arete::tools
