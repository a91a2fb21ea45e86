#pragma once

#include <string>
#include <vector>

#include "core/amplify/learn.h"
#include "gis/dem_file.h"
#include "tools/command.h"

namespace arete::tools {

/// What a verb asks of learning; 0 stands for the default.
struct LearnSettings {
  std::string method = "constrained";  ///< all, ksvd, constrained
  int factor = 4;
  int atoms = 0;
  int patch_cells = 0;
  int sparsity = 1;
  bool symmetries = false;
  bool detail = true;
  bool exhaustive = false;
  DemReadOptions reading = {};
};

struct LearnedDictionary {
  Dictionary dictionary;
  LearnReport report;
};

inline constexpr int default_atoms = 1024;
inline constexpr int default_patch_cells = 6;

/// The even number of cells, at least 4, whose half comes nearest to the radius.
int patch_of_radius(double radius_m, double coarse_cell_m);

/// Reads the exemplars, as far as the memory budget goes (of a larger one the middle, with a warning), and learns from them.
/// The radius, when given (> 0), is in metres on the first exemplar's coarse grid.
LearnedDictionary learn_from_files(const std::vector<std::string>& paths, const LearnSettings& settings, double radius_m,
                                   const CommonOptions& common, Progress& progress);

}  // namespace arete::tools
