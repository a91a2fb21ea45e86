#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace arete {

/// A new file that is written from its start to its end through a buffer. Not flushed to the disk: who moves it to its place does
/// that. Every function throws Error{disk} with the path and the reason where writing fails.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void text(std::string_view text) { write(std::as_bytes(std::span<const char>(text))); }
  void integer(std::int64_t value);
  /// The shortest text that reads back as the same double, with a point in every locale; without an exponent from 1e-7 to 1e16.
  void number(double value);
  /// As it lies in memory: little endian on all machines that Arete runs on.
  template <class T>
  void binary(const T& value) {
    write(std::as_bytes(std::span<const T, 1>(&value, 1)));
  }
  /// To be called after the last byte: until then nothing is certain.
  void close();

 private:
  void flush();
  [[noreturn]] void fail(int reason) const;

  std::string path_;
  int file_;
  std::vector<std::byte> buffer_;
};

/// The text of OutputFile::number.
std::string number_text(double value);

/// What a user wrote, fit for a comment: control characters and line breaks become spaces.
std::string one_line(const std::string& text);

}  // namespace arete
