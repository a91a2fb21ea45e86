#include "gis/peer_codecs.h"

namespace arete {

std::vector<std::unique_ptr<CodecUnderTest>> peer_codecs() {
  std::vector<std::unique_ptr<CodecUnderTest>> codecs;
  codecs.push_back(make_openjpeg_codec());
  codecs.push_back(make_gdal_jpeg2000_codec());
  codecs.push_back(make_jpegxl_codec());
  codecs.push_back(make_lerc_codec());
  codecs.push_back(make_zstd_codec());
  codecs.push_back(make_deflate_codec());
  return codecs;
}

std::vector<std::unique_ptr<CodecUnderTest>> all_codecs() {
  std::vector<std::unique_ptr<CodecUnderTest>> codecs = peer_codecs();
  codecs.insert(codecs.begin(), make_sct_codec());
  return codecs;
}

}  // namespace arete
