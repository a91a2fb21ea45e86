#include "gis/mesh/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/support/error.h"

namespace arete {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

/// Long enough for 16 digits before the point, or for 7 zeros and 17 digits behind it.
constexpr std::size_t longest_number = 48;

char* append_number(double value, char* to) {
  const double size = std::abs(value);
  const bool plain = size == 0 || (size >= 1e-7 && size < 1e16);
  return plain ? std::to_chars(to, to + longest_number, value, std::chars_format::fixed).ptr
               : std::to_chars(to, to + longest_number, value).ptr;
}

}  // namespace

OutputFile::OutputFile(const std::string& path)
    : path_(path), file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (file_ < 0) fail(errno);
  buffer_.reserve(buffer_bytes);
}

OutputFile::~OutputFile() {
  if (file_ >= 0) ::close(file_);
}

void OutputFile::fail(int reason) const {
  throw Error(ErrorKind::disk, "cannot write '" + path_ + "': " + std::strerror(reason));
}

void OutputFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    if (buffer_.size() == buffer_bytes) flush();
    const std::size_t count = std::min(bytes.size(), buffer_bytes - buffer_.size());
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
    bytes = bytes.subspan(count);
  }
}

void OutputFile::integer(std::int64_t value) {
  char digits[24];
  text({digits, static_cast<std::size_t>(std::to_chars(digits, digits + sizeof digits, value).ptr - digits)});
}

void OutputFile::number(double value) {
  char digits[longest_number];
  text({digits, static_cast<std::size_t>(append_number(value, digits) - digits)});
}

void OutputFile::flush() {
  std::span<const std::byte> left = buffer_;
  while (!left.empty()) {
    const ssize_t count = ::write(file_, left.data(), left.size());
    if (count < 0 && errno != EINTR) fail(errno);
    if (count > 0) left = left.subspan(static_cast<std::size_t>(count));
  }
  buffer_.clear();
}

void OutputFile::close() {
  flush();
  // Closing may be the first to tell of a full disk (NFS).
  if (::close(std::exchange(file_, -1)) != 0) fail(errno);
}

std::string number_text(double value) {
  char digits[longest_number];
  return {digits, append_number(value, digits)};
}

std::string one_line(const std::string& text) {
  std::string line = text;
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  return line;
}

}  // namespace arete
