#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace arete {

// What lies below the numbers that the predictive coder codes, where doubles are kept to the last bit (ValueMap::low_bits): mostly
// noise, stored as it is. Laid out in core/codec/predictive-format.md.

/// Numbers of `bits` bits each, the lowest first, deflated; empty where all are 0.
std::vector<std::byte> pack_low_bits(std::span<const std::uint64_t> numbers, int bits);

/// The inverse. Safe for untrusted bytes: throws Error{damaged} where they do not hold `count` numbers; `name` stands for the file.
std::vector<std::uint64_t> unpack_low_bits(std::span<const std::byte> bytes, std::size_t count, int bits, const std::string& name);

}  // namespace arete
