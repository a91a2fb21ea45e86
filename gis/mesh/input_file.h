#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace arete {

/// A file that is read from its start to its end through a buffer of 1 MiB. Every function throws Error{disk} where reading
/// fails.
class InputFile {
 public:
  /// Throws Error{input} where it cannot be opened or is no plain file.
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// Of the next byte.
  std::uint64_t position() const { return position_; }
  std::uint64_t left() const { return size_ - position_; }
  /// Of the line that was read last, from 1.
  std::int64_t line_number() const { return line_; }

  /// The next `count` bytes, at most 1 MiB; they stay where they are until the next call. Throws Error{input} where the file ends
  /// before, naming `what` is missing.
  std::span<const std::byte> take(std::size_t count, const char* what);
  /// As take, for what is not looked at; of any length.
  void skip(std::uint64_t count, const char* what);
  /// The next bytes without taking them: `count`, fewer at the end of the file.
  std::string_view peek(std::size_t count);
  /// The next line without its end (LF, CR LF); it stays until the next call. Nullopt at the end of the file. Throws Error{input}
  /// where a line is longer than 64 KiB: no format here has such lines.
  std::optional<std::string_view> line();
  /// The next word between blanks, across lines, at most 64 KiB. Throws Error{input} at the end of the file.
  std::string_view word(const char* what);

  /// Throws Error{input}: "'path' is damaged: <where> <message>", the place being the line that was read last, or the position.
  [[noreturn]] void fail_at_line(const std::string& message) const;
  [[noreturn]] void fail_at_byte(const std::string& message) const;

 private:
  /// Makes `count` bytes available at the start of what is held, fewer at the end of the file.
  void fill(std::size_t count);

  std::string path_;
  int file_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  std::int64_t line_ = 0;
  std::vector<char> buffer_;
  std::size_t start_ = 0, end_ = 0;
};

/// Words of a line, one after the other: the part of `line` up to the next blank is cut off and returned; empty where none is
/// left.
std::string_view next_word(std::string_view& line);

/// The whole word as a finite double ("+1.5" too); nullopt otherwise. The point is the separator in every locale.
std::optional<double> parse_number(std::string_view word);

/// The whole word as an integer.
std::optional<std::int64_t> parse_integer(std::string_view word);

}  // namespace arete
