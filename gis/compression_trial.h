#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/codec/bjontegaard.h"
#include "core/support/progress.h"
#include "gis/codec_under_test.h"

namespace arete {

/// One encoding, decoded again and compared with the original over its valid cells.
struct Measurement {
  CodingTarget target = {};
  std::int64_t bytes = 0;       ///< all that the decoder needs
  double bits = 0;              ///< per sample: 8 x bytes / cells of the raster, voids included
  double rmse_m = 0;
  double psnr_db = 0;           ///< 20 log10((high - low) / RMSE); +infinity where every valid cell came back as it was
  double max_error_m = 0;       ///< +infinity where a valid cell came back void
  double encode_s = 0, decode_s = 0;  ///< medians
};

/// Fills in RMSE, PSNR and largest error of a decoded raster over the terrain's valid cells.
void compare_cells(const TestedTerrain& terrain, const Raster<float>& decoded, Measurement& measurement);

/// Encodes and decodes `repeats` times (at least 1) for the times; the first decode is compared. Throws as the codec.
Measurement measure_codec(const CodecUnderTest& codec, const TestedTerrain& terrain, CodingTarget target, int repeats, int threads);

/// A curve read at a rate: linear between the measured points beside it, on a logarithmic axis of rates. The times are those of the
/// nearest measured point.
struct RateReading {
  double rate = 0;  ///< bits per sample
  double psnr_db = 0, max_error_m = 0, encode_s = 0, decode_s = 0;
};

/// What a codec did to a terrain.
struct CodecTrial {
  std::string name = {}, title = {}, description = {};
  bool keeps_voids = false;
  std::vector<Measurement> curve = {};             ///< of rate against distortion, rates rising
  std::vector<std::optional<RateReading>> rates = {};   ///< one per rate of the plan; none: the codec did not reach that rate, or came back exact
  std::vector<std::optional<Measurement>> bounds = {};  ///< one per bound of the plan; none: it has no such mode
  std::optional<Measurement> lossless = {};
  std::vector<RatePoint> points() const;  ///< of the curve, for Bjontegaard's differences; exact ones left out
};

struct TrialPlan {
  std::vector<double> rates = {};     ///< bits per sample, each above 0
  std::vector<double> bounds_m = {};  ///< strict errors, each 0 or more
  bool lossless = true;
  int repeats = 3;
  int threads = 1;
};

/// A codec that does not keep its promise is not hidden: its lossless measurement has an error, its bound a larger one.
bool kept(const Measurement& measurement);

/// Five strict errors that suit a terrain, of the numbers 1, 2 and 5 times a power of ten: from about a 5000th of its relief, but at least a
/// quantum, upwards.
std::vector<double> default_bounds(const TestedTerrain& terrain);

/// Where a codec has no target size its setting is searched for each rate, until the file is within 1 % or the bracket is narrow.
/// A target that the codec says it cannot reach (Error{usage}) is left out. Progress counts rates, bounds and the lossless coding, one
/// each: trial_steps in all.
CodecTrial try_codec(const CodecUnderTest& codec, const TestedTerrain& terrain, const TrialPlan& plan, Progress& progress);
std::int64_t trial_steps(const TrialPlan& plan);

/// How many dB `test` is above `anchor` on average over the rates of the plan within [lowest, highest] that both reached; nullopt where
/// there is none.
std::optional<double> mean_gain(const CodecTrial& anchor, const CodecTrial& test, double lowest, double highest);

}  // namespace arete
