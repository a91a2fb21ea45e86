// Prints what trees hold, as tests/golden/expected.txt has it: `print_trees FILE...`. Needs core/codec, core/tree and what they
// need only, so that scripts/compare-compilers builds it with several compilers.
#include <cstdio>
#include <string>

#include "core/support/error.h"
#include "tests/golden/describe_tree.h"

int main(int count, char** paths) {
  for (int i = 1; i < count; ++i) {
    const std::string path = paths[i];
    try {
      std::fputs(arete::describe_tree(arete::ElevationTree::open(path, 1), path.substr(path.rfind('/') + 1)).c_str(), stdout);
    } catch (const arete::Error& error) {
      std::fprintf(stderr, "print_trees: %s\n", error.what());
      return static_cast<int>(error.kind());
    }
  }
}
