#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/support/error.h"

namespace arete {

// Numbers and texts as bytes: little-endian, integers of any size in groups of seven bits (LEB128).

class ByteWriter {
 public:
  void put_u8(std::uint8_t value) { bytes_.push_back(static_cast<std::byte>(value)); }
  void put_varint(std::uint64_t value) {
    for (; value >= 128; value >>= 7) put_u8(static_cast<std::uint8_t>(value | 128));
    put_u8(static_cast<std::uint8_t>(value));
  }
  template <typename T>
  void put(T value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  void put_bytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  /// With its length before it.
  void put_blob(std::span<const std::byte> bytes) {
    put_varint(bytes.size());
    put_bytes(bytes);
  }
  void put_text(const std::string& text) { put_blob(std::as_bytes(std::span(text))); }
  std::vector<std::byte> take() { return std::move(bytes_); }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads back what a ByteWriter wrote. Safe for untrusted bytes: each read throws Error{damaged} where the bytes end before it.
class ByteReader {
 public:
  ByteReader(std::span<const std::byte> bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  std::size_t left() const { return bytes_.size() - position_; }
  std::uint8_t get_u8() { return std::to_integer<std::uint8_t>(take(1)[0]); }
  std::uint64_t get_varint() {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint8_t byte = get_u8();
      // The tenth group has one bit left; and a number has one form only.
      if ((shift == 63 && byte > 1) || (shift > 0 && byte == 0)) fail("a number is not written as it must be");
      value |= static_cast<std::uint64_t>(byte & 127) << shift;
      if (byte < 128) return value;
    }
  }
  /// An integer of at most `limit`.
  std::uint64_t get_varint(std::uint64_t limit, const char* what) {
    const std::uint64_t value = get_varint();
    if (value > limit) fail(std::string(what) + " is " + std::to_string(value) + ", at most " + std::to_string(limit) + " expected");
    return value;
  }
  template <typename T>
  T get() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::span<const std::byte> get_blob() {
    const std::uint64_t length = get_varint();
    if (length > left()) fail("a part of it is longer than the rest of the file");
    return take(static_cast<std::size_t>(length));
  }
  std::string get_text() {
    const std::span<const std::byte> bytes = get_blob();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::damaged, "'" + name_ + "' is damaged: " + what + "; take a fresh copy or make it again");
  }

 private:
  std::span<const std::byte> take(std::size_t count) {
    if (count > left()) fail("it ends too early");
    const std::span<const std::byte> taken = bytes_.subspan(position_, count);
    position_ += count;
    return taken;
  }
  std::span<const std::byte> bytes_;
  std::string name_;
  std::size_t position_ = 0;
};

}  // namespace arete
