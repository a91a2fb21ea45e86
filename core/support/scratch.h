#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace arete {

/// Where intermediate data go that are larger than the memory given for them.
struct Scratch {
  std::int64_t memory_bytes = std::numeric_limits<std::int64_t>::max();  ///< of all that the work holds at a time
  std::string folder;  ///< for files without a name, which are gone with the program however it ends; empty: none are made
};

/// Bytes that are written and read back by position: in memory up to a limit, beyond it in a file without a name. Writes and reads
/// of different bytes may come from several threads, those that make it longer from one. Throws Error{disk} where the file
/// cannot be made, written or read.
class ScratchBytes {
 public:
  ScratchBytes() = default;
  /// Spills to scratch.folder beyond `limit` bytes.
  ScratchBytes(const Scratch& scratch, std::int64_t limit) : folder_(scratch.folder), limit_(limit) {}
  ~ScratchBytes();
  ScratchBytes(ScratchBytes&& other) noexcept;
  ScratchBytes& operator=(ScratchBytes&& other) noexcept;

  std::uint64_t size() const { return size_; }
  /// New bytes are 0.
  void resize(std::uint64_t size);
  /// Makes it longer where needed.
  void write(std::uint64_t position, std::span<const std::byte> bytes);
  void append(std::span<const std::byte> bytes) { write(size_, bytes); }
  /// `to` lies inside.
  void read(std::uint64_t position, std::span<std::byte> to) const;
  bool in_memory() const { return file_ < 0; }

 private:
  void spill();
  std::string folder_;
  std::int64_t limit_ = std::numeric_limits<std::int64_t>::max();
  std::uint64_t size_ = 0;
  std::vector<std::byte> memory_;
  int file_ = -1;
};

}  // namespace arete
