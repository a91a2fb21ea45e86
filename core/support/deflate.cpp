#include "core/support/deflate.h"

#include <zlib.h>

#include <algorithm>
#include <new>

#include "core/support/error.h"

namespace arete {
namespace {

constexpr std::size_t chunk_bytes = std::size_t{1} << 16;

[[noreturn]] void fail(const std::string& name) {
  throw Error(ErrorKind::damaged, "'" + name + "' is damaged: a compressed part of it cannot be read; take a fresh copy or make it again");
}

}  // namespace

std::vector<std::byte> deflate_bytes(std::span<const std::byte> bytes) {
  uLongf length = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::byte> out(length);
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &length, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                Z_BEST_COMPRESSION) != Z_OK)
    throw std::bad_alloc();
  out.resize(length);
  return out;
}

std::vector<std::byte> inflate_bytes(std::span<const std::byte> bytes, std::size_t limit, const std::string& name) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  struct End {
    z_stream& stream;
    ~End() { inflateEnd(&stream); }
  } const end{stream};
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(std::min<std::size_t>(bytes.size(), 0xffffffff));
  std::vector<std::byte> out;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (out.size() > limit) fail(name);
    const std::size_t before = out.size();
    out.resize(before + chunk_bytes);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(chunk_bytes);
    status = inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
    if (status != Z_OK && status != Z_STREAM_END) fail(name);
    if (status == Z_OK && stream.avail_in == 0 && stream.avail_out > 0) fail(name);
  }
  if (stream.avail_in != 0 || out.size() > limit) fail(name);
  return out;
}

}  // namespace arete
