#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "tools/bench_data.h"

namespace arete::tools {

/// A result as `arete bench compression` gets it: OpenJPEG, and a codec 2 dB above it that breaks a bound and is exact at 1 bit.
inline BenchedDem sample_bench(const std::string& label = "dem") {
  BenchedDem dem{.path = "/somewhere/" + label + ".tif", .label = label, .size = {100, 80}, .valid = 7990, .low_m = 10, .high_m = 110};
  dem.plan = {.rates = {0.1, 0.5, 1}, .bounds_m = {1, 2}, .lossless = true, .repeats = 3, .threads = 2};
  for (const std::string& name : {std::string("openjpeg"), std::string("other")}) {
    CodecTrial trial{.name = name, .title = name == "other" ? "Other <new>" : "JPEG 2000", .description = "one, two", .keeps_voids = false};
    for (const double rate : dem.plan.rates) {
      const double psnr = 60 + 6 * std::log2(rate) + (name == "other" ? 2 : 0);
      trial.curve.push_back({.target = {CodingTarget::Kind::bytes, rate * 1000}, .bytes = static_cast<std::int64_t>(rate * 1000), .bits = rate, .rmse_m = 1,
                             .psnr_db = psnr, .max_error_m = 3});
      trial.rates.push_back(RateReading{rate, psnr, 3, 0.5, 0.25});
    }
    trial.bounds = {Measurement{.target = {CodingTarget::Kind::max_error, 1}, .bytes = 3000, .bits = 3, .max_error_m = name == "other" ? 1.5 : 1}, std::nullopt};
    if (name == "other") {
      trial.curve.back().psnr_db = std::numeric_limits<double>::infinity();
      trial.curve.back().max_error_m = trial.curve.back().rmse_m = 0;
      trial.rates.back() = std::nullopt;
      trial.lossless = Measurement{.bytes = 1000, .bits = 1, .psnr_db = std::numeric_limits<double>::infinity()};
    }
    dem.trials.push_back(std::move(trial));
  }
  dem.paper.push_back({.sparsity = 8, .ratio = {0.5, 0.25}, .tree = {.bytes = 1000, .bits = 1, .psnr_db = 40}, .jpeg2000 = {.bytes = 1001, .bits = 1.001, .psnr_db = 43.5}});
  return dem;
}

}  // namespace arete::tools
