#include "gis/mesh/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/support/error.h"

namespace arete {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;
constexpr std::size_t longest_line = std::size_t{1} << 16;
constexpr std::string_view blanks = " \t\r\n\v\f";

[[noreturn]] void fail_reading(ErrorKind kind, const std::string& path, const std::string& reason) {
  throw Error(kind, "cannot read '" + path + "': " + reason);
}

bool is_blank(char c) { return blanks.find(c) != std::string_view::npos; }

}  // namespace

InputFile::InputFile(const std::string& path) : path_(path), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (file_ < 0) fail_reading(ErrorKind::input, path, std::strerror(errno));
  struct stat about {};
  const bool known = ::fstat(file_, &about) == 0;
  if (!known || !S_ISREG(about.st_mode)) {
    ::close(file_);
    fail_reading(ErrorKind::input, path, known && S_ISDIR(about.st_mode) ? "it is a folder" : "it is no plain file");
  }
  size_ = static_cast<std::uint64_t>(about.st_size);
  buffer_.resize(buffer_bytes);
}

InputFile::~InputFile() { ::close(file_); }

void InputFile::fill(std::size_t count) {
  if (end_ - start_ >= std::min<std::uint64_t>(count, left())) return;
  std::memmove(buffer_.data(), buffer_.data() + start_, end_ - start_);
  end_ -= start_;
  start_ = 0;
  while (end_ < count) {
    const ssize_t got = ::read(file_, buffer_.data() + end_, buffer_.size() - end_);
    if (got < 0 && errno != EINTR) fail_reading(ErrorKind::disk, path_, std::strerror(errno));
    if (got == 0) break;
    if (got > 0) end_ += static_cast<std::size_t>(got);
  }
}

std::span<const std::byte> InputFile::take(std::size_t count, const char* what) {
  fill(count);
  if (end_ - start_ < count)
    throw Error(ErrorKind::input, "'" + path_ + "' is damaged: it ends after " + std::to_string(position_ + (end_ - start_)) +
                                      " bytes, where " + what + " was expected; get it again");
  const auto bytes = std::as_bytes(std::span<const char>(buffer_).subspan(start_, count));
  start_ += count;
  position_ += count;
  return bytes;
}

void InputFile::skip(std::uint64_t count, const char* what) {
  while (count > 0) {
    const std::size_t step = static_cast<std::size_t>(std::min<std::uint64_t>(count, buffer_bytes));
    take(step, what);
    count -= step;
  }
}

std::string_view InputFile::peek(std::size_t count) {
  fill(count);
  return {buffer_.data() + start_, std::min(count, end_ - start_)};
}

std::optional<std::string_view> InputFile::line() {
  fill(longest_line);
  if (start_ == end_) return std::nullopt;
  ++line_;
  const std::string_view held(buffer_.data() + start_, std::min(end_ - start_, longest_line));
  const std::size_t length = std::min(held.find('\n'), held.size());
  if (length == longest_line) fail_at_line("is longer than 65536 characters: no mesh has such lines");
  std::string_view found = held.substr(0, length);
  const std::size_t taken = std::min(length + 1, held.size());
  start_ += taken;
  position_ += taken;
  if (!found.empty() && found.back() == '\r') found.remove_suffix(1);
  return found;
}

std::string_view InputFile::word(const char* what) {
  while (true) {
    fill(1);
    if (start_ == end_) take(1, what);
    if (!is_blank(buffer_[start_])) break;
    ++start_;
    ++position_;
  }
  // A word seldom reaches beyond what is held; then the rest is fetched and it is looked at once more.
  const auto length_held = [&] {
    return static_cast<std::size_t>(std::find_if(buffer_.begin() + static_cast<std::ptrdiff_t>(start_),
                                                 buffer_.begin() + static_cast<std::ptrdiff_t>(end_), is_blank) -
                                    (buffer_.begin() + static_cast<std::ptrdiff_t>(start_)));
  };
  std::size_t length = length_held();
  if (start_ + length == end_) {
    fill(longest_line);
    length = length_held();
  }
  if (length >= longest_line) fail_at_byte("holds a word longer than 65536 characters");
  const std::string_view found(buffer_.data() + start_, length);
  start_ += length;
  position_ += length;
  return found;
}

void InputFile::fail_at_line(const std::string& message) const {
  throw Error(ErrorKind::input, "'" + path_ + "' is damaged: line " + std::to_string(line_) + " " + message);
}

void InputFile::fail_at_byte(const std::string& message) const {
  throw Error(ErrorKind::input, "'" + path_ + "' is damaged: byte " + std::to_string(position_) + " " + message);
}

std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

std::optional<double> parse_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (problem != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  std::int64_t value = 0;
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (problem != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace arete
