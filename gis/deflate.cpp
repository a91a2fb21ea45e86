#include "gis/deflate.h"

#include <zlib.h>

#include "core/support/error.h"

namespace arete {

std::string deflate_bytes(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string stream(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(stream.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_COMPRESSION);
  if (status != Z_OK) throw Error(ErrorKind::memory, "cannot deflate " + std::to_string(bytes.size()) + " bytes: zlib needs more memory");
  stream.resize(size);
  return stream;
}

}  // namespace arete
