#include "core/tree/tree_draft.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/tree/elevation_tree.h"

namespace arete {
namespace {

std::vector<std::byte> bytes_of(const char* text) {
  const auto all = std::as_bytes(std::span(text, std::char_traits<char>::length(text)));
  return {all.begin(), all.end()};
}

// A raster of two levels, hence two nodes of level 1 and one of each level above.
TEST(TreeDraft, GivesBackWhatItWasGivenWithAndWithoutMasksAndWater) {
  const NodeGrid grid({64, 32}, 32);
  MaskStreams masks;
  masks.root = bytes_of("m");
  masks.nodes.resize(static_cast<std::size_t>(grid.node_count()));
  masks.nodes.back() = bytes_of("mask");
  const MaskStreams none;
  for (const auto& [chosen, flat] : {std::pair{none, none}, std::pair{masks, none}, std::pair{none, masks}, std::pair{masks, masks}}) {
    TreeDraft draft(chosen, flat, {0, std::filesystem::temp_directory_path().string()});
    const NodeStore nodes = draft.nodes();
    for (std::int64_t i = 0; i < grid.node_count(); ++i) nodes.add(i == 1 ? std::vector<std::byte>() : bytes_of(i == 0 ? "first" : "other"));
    EXPECT_EQ(nodes.read(0), bytes_of("first"));
    EXPECT_TRUE(nodes.read(1).empty());
    EXPECT_EQ(nodes.read(grid.node_count() - 1), bytes_of("other"));
    TreeHeader header;
    header.grid = grid;
    const TreeFile file(draft.finish(header, bytes_of("root")), "draft");
    EXPECT_EQ(file.header().voids, !chosen.root.empty());
    EXPECT_EQ(static_cast<std::int64_t>(file.nodes().size()), grid.node_count());
  }
}

}  // namespace
}  // namespace arete
