// Bytes as a small raster and what is asked of its tree: what is decoded must keep what was promised. The patch coder promises nothing of
// its error, and learns for too long; what it decodes is tree_fuzz.cpp's.
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <fuzzer/FuzzedDataProvider.h>

#include "core/support/error.h"
#include "core/tree/fit_predictive.h"
#include "core/tree/fit_wavelet.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void report(const std::string& broken) {
  std::fprintf(stderr, "%s\n", broken.c_str());
  std::abort();
}

// What the bytes of one cell are taken for.
enum class Filling { any, near_zero, slope, few };

double fill_cell(FuzzedDataProvider& bytes, Filling filling, ValueType type, std::int64_t x, std::int64_t y) {
  const std::uint8_t byte = bytes.ConsumeIntegral<std::uint8_t>();
  if (filling != Filling::any) {
    if (byte == 255) return nothing;
    const double sample = filling == Filling::near_zero ? byte - 100.0
                          : filling == Filling::few     ? byte % 4 * 1000.0
                                                        : 3.0 * static_cast<double>(x) + 2.0 * static_cast<double>(y) + byte / 16.0;
    return hold_to(type, sample);
  }
  if (type == ValueType::float32) return static_cast<double>(std::bit_cast<float>(bytes.ConsumeIntegral<std::uint32_t>()));
  if (type == ValueType::float64) return std::bit_cast<double>(bytes.ConsumeIntegral<std::uint64_t>());
  return byte == 255 ? nothing : hold_to(type, bytes.ConsumeIntegral<std::int32_t>());
}

Raster<double> take_raster(FuzzedDataProvider& bytes, ValueType type) {
  Raster<double> cells(bytes.ConsumeIntegralInRange<int>(1, 48), bytes.ConsumeIntegralInRange<int>(1, 48));
  const auto filling = static_cast<Filling>(bytes.ConsumeIntegralInRange<int>(0, 3));
  for (std::int64_t y = 0; y < cells.height(); ++y)
    for (std::int64_t x = 0; x < cells.width(); ++x) cells(x, y) = fill_cell(bytes, filling, type, x, y);
  return cells;
}

CompressOptions take_options(FuzzedDataProvider& bytes) {
  CompressOptions options;
  options.threads = 1;
  options.node_side = 32 << bytes.ConsumeIntegralInRange<int>(0, 1);
  options.passes = bytes.ConsumeIntegralInRange<int>(1, 2);
  options.target.kind = static_cast<TreeClaim>(bytes.ConsumeIntegralInRange<int>(1, 5));
  const double digits = bytes.ConsumeIntegralInRange<int>(1, 1000);
  options.target.value = options.target.kind == TreeClaim::psnr ? digits / 10 : digits / std::pow(10, bytes.ConsumeIntegralInRange<int>(0, 4));
  if (options.target.kind == TreeClaim::bytes) options.target.value = digits;
  return options;
}

TreeHeader take_header(FuzzedDataProvider& bytes) {
  TreeHeader header;
  header.type = static_cast<ValueType>(bytes.ConsumeIntegralInRange<int>(1, 7));
  const std::uint8_t about = bytes.ConsumeIntegral<std::uint8_t>();
  if (about & 1) header.scale = 0.01;
  if (about & 2) header.offset = -500;
  if (about & 4) header.geo.metres_per_unit = 0.3048;
  if (about & 8) header.geo.nodata = -9999;
  if (about & 16) header.geo.transform = {0, 1, 0, 0, 0, -1};
  if (about & 32) header.metadata["name"] = "value";
  return header;
}

// Cell by cell, whatever the encoder measured itself.
void check_cells(const Raster<double>& wanted, const Raster<double>& found, const TreeHeader& about) {
  const double metres = std::abs(about.scale) * about.geo.metres_per_unit;
  for (std::int64_t i = 0; i < wanted.size().cells(); ++i) {
    const double truth = wanted.data()[i], value = found.data()[i];
    if (std::isnan(truth) != std::isnan(value)) report("a void differs");
    if (std::isnan(truth)) continue;
    if (about.claim == TreeClaim::lossless && std::bit_cast<std::uint64_t>(truth) != std::bit_cast<std::uint64_t>(value)) report("lossless is not");
    if (about.claim == TreeClaim::max_error && !(std::abs(truth - value) * metres <= about.claimed)) report("a cell is further off than promised");
    if (!holds(about.type, value)) report("a value is not of its type");
  }
}

void go_round(FuzzedDataProvider& bytes) {
  TreeHeader header = take_header(bytes);
  const CompressOptions options = take_options(bytes);
  const MemoryStored source(take_raster(bytes, header.type));
  header.claim = options.target.kind;
  header.claimed = options.target.value;
  const bool strict = header.claim == TreeClaim::lossless || header.claim == TreeClaim::max_error;
  const FittedTree made = (strict ? fit_predictive : fit_wavelet)(read_tree_cells(source, header, options.scratch), header, options, nullptr);
  if (!made.file) return;
  const ElevationTree tree(TreeFile(made.file, "made.sct"));
  tree.verify_checksums();
  Raster<double> found(tree.size().width, tree.size().height);
  tree.read_stored(0, {0, 0, tree.size().width, tree.size().height}, found.view());
  check_cells(source.cells(), found, tree.header());
  const TreeErrors errors = measure_tree(tree, source, std::int64_t{1} << 28);
  if (!keeps_claim(tree.header(), errors)) {
    report("claim " + std::to_string(static_cast<int>(header.claim)) + " of " + std::to_string(header.claimed) + " is not kept by " +
           std::to_string(errors.bytes) + " bytes, RMSE " + std::to_string(errors.rmse_m) + " m, PSNR " + std::to_string(errors.psnr_db()) + " dB");
  }
  if (errors.rmse_m != made.errors.rmse_m && !std::isnan(errors.rmse_m)) report("the report is not what is measured");
}

}  // namespace
}  // namespace arete

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider bytes(data, size);
  try {
    arete::go_round(bytes);
  } catch (const arete::Error& error) {
    // What cannot be encoded is refused; a file that was made must be readable, and the encoder never doubts itself.
    if (error.kind() != arete::ErrorKind::input && error.kind() != arete::ErrorKind::usage) arete::report(error.what());
    if (std::string(error.what()).find("fault of the program") != std::string::npos) arete::report(error.what());
  }
  return 0;
}
