#pragma once

#include <memory>
#include <vector>

#include "gis/codec_under_test.h"

namespace arete {

/// The codecs that terrain is compressed with today, each as well as its library allows (and one as most people use it), in the order
/// of reports; the first is the anchor of all differences: JPEG 2000 by OpenJPEG, one tile, 16 bits, irreversible 9/7, 6 resolutions.
std::vector<std::unique_ptr<CodecUnderTest>> peer_codecs();

/// Ours, and the peers after it.
std::vector<std::unique_ptr<CodecUnderTest>> all_codecs();

/// The compact sparse tree, core/tree/compress.h.
std::unique_ptr<CodecUnderTest> make_sct_codec();
/// libopenjp2. Terrain scaled to 16 bits; strict errors and lossless by the reversible 5/3 on quantised terrain.
std::unique_ptr<CodecUnderTest> make_openjpeg_codec();
/// GDAL's driver JP2OpenJPEG as it comes: whole metres, tiles of 1024, QUALITY.
std::unique_ptr<CodecUnderTest> make_gdal_jpeg2000_codec();
/// libjxl. Lossy by distance on terrain scaled to 16 bits; strict errors and lossless by its modular mode on quantised terrain.
std::unique_ptr<CodecUnderTest> make_jpegxl_codec();
/// GeoTIFF with LERC_ZSTD and MAX_Z_ERROR, in one block.
std::unique_ptr<CodecUnderTest> make_lerc_codec();
/// GeoTIFF in tiles of 512 with a predictor, lossless or on quantised terrain.
std::unique_ptr<CodecUnderTest> make_zstd_codec();
std::unique_ptr<CodecUnderTest> make_deflate_codec();

}  // namespace arete
