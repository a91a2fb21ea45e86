#include "core/support/scratch.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "core/support/error.h"

namespace arete {
namespace {

[[noreturn]] void fail(const std::string& folder, const char* what, int reason) {
  throw Error(ErrorKind::disk, "cannot " + std::string(what) + " a temporary file in the folder '" + folder + "': " + std::strerror(reason) +
                                   "; free some space there, or give more --memory");
}

// A file without a name.
int open_unnamed(const std::string& folder) {
#ifdef O_TMPFILE
  const int unnamed = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (unnamed >= 0) return unnamed;
#endif
  // Not every file system has them: make one with a name, and take the name away.
  std::string path = folder + "/.arete-scratch-XXXXXX";
  const int file = ::mkostemp(path.data(), O_CLOEXEC);
  if (file < 0) fail(folder, "make", errno);
  ::unlink(path.c_str());
  return file;
}

}  // namespace

ScratchBytes::~ScratchBytes() {
  if (file_ >= 0) ::close(file_);
}

ScratchBytes::ScratchBytes(ScratchBytes&& other) noexcept { *this = std::move(other); }

ScratchBytes& ScratchBytes::operator=(ScratchBytes&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(limit_, other.limit_);
  std::swap(size_, other.size_);
  std::swap(memory_, other.memory_);
  std::swap(file_, other.file_);
  return *this;
}

void ScratchBytes::spill() {
  file_ = open_unnamed(folder_);
  const std::vector<std::byte> held = std::exchange(memory_, {});
  write(0, held);
}

void ScratchBytes::resize(std::uint64_t size) {
  if (in_memory() && !folder_.empty() && size > static_cast<std::uint64_t>(limit_)) spill();
  if (in_memory()) memory_.resize(size);
  else if (::ftruncate(file_, static_cast<off_t>(size)) != 0) fail(folder_, "write", errno);
  size_ = size;
}

void ScratchBytes::write(std::uint64_t position, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  if (position + bytes.size() > size_) resize(position + bytes.size());
  if (in_memory()) {
    std::memcpy(memory_.data() + position, bytes.data(), bytes.size());
    return;
  }
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(position));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail(folder_, "write", count < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    position += static_cast<std::uint64_t>(count);
  }
}

void ScratchBytes::read(std::uint64_t position, std::span<std::byte> to) const {
  if (to.empty()) return;
  if (in_memory()) {
    std::memcpy(to.data(), memory_.data() + position, to.size());
    return;
  }
  while (!to.empty()) {
    const ssize_t count = ::pread(file_, to.data(), to.size(), static_cast<off_t>(position));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail(folder_, "read", count < 0 ? errno : EIO);
    to = to.subspan(static_cast<std::size_t>(count));
    position += static_cast<std::uint64_t>(count);
  }
}

}  // namespace arete
