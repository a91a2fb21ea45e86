#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/codec/byte_stream.h"

namespace arete {

/// Two streams of a node in one: the first with its length before it. A node that has neither has an empty stream.
struct StreamParts {
  std::vector<std::byte> first;
  std::vector<std::byte> rest;
};

inline std::vector<std::byte> join_parts(const StreamParts& parts) {
  if (parts.first.empty() && parts.rest.empty()) return {};
  ByteWriter out;
  out.put_blob(parts.first);
  out.put_bytes(parts.rest);
  return out.take();
}

/// The inverse. Throws Error{damaged}; `name` stands for the file.
inline StreamParts split_parts(std::span<const std::byte> stream, const std::string& name) {
  if (stream.empty()) return {};
  ByteReader in(stream, name);
  const std::span<const std::byte> first = in.get_blob();
  const std::span<const std::byte> rest = stream.last(in.left());
  return {{first.begin(), first.end()}, {rest.begin(), rest.end()}};
}

}  // namespace arete
