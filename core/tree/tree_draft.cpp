#include "core/tree/tree_draft.h"

#include <utility>

#include "core/codec/stream_parts.h"

namespace arete {
namespace {

constexpr const char* draft_name = "the tree just made";

}  // namespace

class TreeDraft::Bytes final : public ByteSource {
 public:
  explicit Bytes(const Scratch& scratch) : bytes_(scratch, scratch.memory_bytes / 8) {}
  void append(std::span<const std::byte> bytes) { bytes_.append(bytes); }
  std::uint64_t size() const override { return bytes_.size(); }
  void read(std::uint64_t position, std::span<std::byte> to) const override { bytes_.read(position, to); }

 private:
  ScratchBytes bytes_;
};

TreeDraft::TreeDraft(const MaskStreams& masks, const MaskStreams& flat, const Scratch& scratch)
    : masks_(masks),
      flat_(flat),
      bytes_(std::make_shared<Bytes>(scratch)),
      writer_([bytes = bytes_](std::span<const std::byte> more) { bytes->append(more); }) {}

std::vector<std::byte> TreeDraft::join(const std::vector<std::byte>& flat, const std::vector<std::byte>& mask, std::vector<std::byte> stream) const {
  if (flat_.any()) stream = join_parts({flat, std::move(stream)});
  if (masks_.any()) stream = join_parts({mask, std::move(stream)});
  return stream;
}

NodeStore TreeDraft::nodes() {
  const std::vector<std::byte> none;
  const auto add = [this, none](std::vector<std::byte> stream) {
    const std::size_t index = writer_.nodes().size();
    writer_.add_node(join(flat_.any() ? flat_.nodes[index] : none, masks_.any() ? masks_.nodes[index] : none, std::move(stream)));
  };
  const auto read = [this](std::int64_t index) {
    const NodeEntry& entry = writer_.nodes()[static_cast<std::size_t>(index)];
    std::vector<std::byte> stream(entry.bytes);
    bytes_->read(entry.position, stream);
    if (masks_.any()) stream = split_parts(stream, draft_name).rest;
    if (flat_.any()) stream = split_parts(stream, draft_name).rest;
    return stream;
  };
  return {add, read};
}

std::shared_ptr<const ByteSource> TreeDraft::finish(TreeHeader header, const std::vector<std::byte>& root) {
  header.voids = masks_.any();
  header.root = join(flat_.root, masks_.root, root);
  writer_.finish(header);
  return bytes_;
}

TreeErrors measure_file(const TreeCells& cells, const std::shared_ptr<const ByteSource>& file, const Scratch& scratch, int threads,
                        Progress* progress, const DictionaryFinder& find) {
  return measure_tree(ElevationTree(TreeFile(file, draft_name), threads, find), *cells.stored, scratch.memory_bytes / 2, progress);
}

}  // namespace arete
