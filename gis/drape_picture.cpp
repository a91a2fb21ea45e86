#include "gis/drape_picture.h"

#include <cpl_string.h>
#include <gdal_alg.h>
#include <gdal_priv.h>
#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/support/error.h"
#include "core/terrain/statistics.h"
#include "gis/colour_ramp.h"
#include "gis/gdal_errors.h"

namespace arete {
namespace {

constexpr int strip_rows = 512, sampled = 512;

[[noreturn]] void fail(const std::string& path, const Placed& dem, const std::string& why) {
  throw Error(ErrorKind::input, "cannot lay '" + path + "' over '" + dem.name + "': " + why);
}

struct Raw {
  GDALDatasetUniquePtr file, bands;  // the second refers to the first: it goes first
  int colours = 1;                   // 1 or 3, before an alpha band
  bool bytes = true, georeferenced = true;
};

/// The bands that make the picture, a palette as its colours, opacity last.
Raw open_bands(const std::string& path, const Placed& dem) {
  const GdalErrors errors;
  Raw raw;
  raw.file.reset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  if (!raw.file || raw.file->GetRasterCount() == 0) fail(path, dem, "it cannot be read as a raster" + errors.suffix());
  int of[3] = {1, 2, 3}, alpha = 0;
  const int count = raw.file->GetRasterCount();
  for (int b = 1; b <= count; ++b) {
    const GDALColorInterp colour = raw.file->GetRasterBand(b)->GetColorInterpretation();
    if (colour == GCI_AlphaBand) alpha = b;
    for (const auto& [name, i] : {std::pair{GCI_RedBand, 0}, {GCI_GreenBand, 1}, {GCI_BlueBand, 2}})
      if (colour == name) of[i] = b;
  }
  const bool palette = count == 1 && raw.file->GetRasterBand(1)->GetColorTable() != nullptr;
  raw.colours = palette || count - (alpha > 0) >= 3 ? 3 : 1;
  CPLStringList how;
  how.AddString("-of");
  how.AddString("VRT");
  if (palette) {
    how.AddString("-expand");
    how.AddString("rgba");
  } else {
    for (int i = 0; i < raw.colours; ++i) {
      GDALRasterBand* band = raw.file->GetRasterBand(of[i]);
      if (GDALDataTypeIsComplex(band->GetRasterDataType())) fail(path, dem, "its numbers are complex");
      raw.bytes &= band->GetRasterDataType() == GDT_Byte;
      how.AddString("-b");
      how.AddString(std::to_string(of[i]).c_str());
    }
    if (alpha > 0) {
      how.AddString("-b");
      how.AddString(std::to_string(alpha).c_str());
    }
  }
  const std::unique_ptr<GDALTranslateOptions, void (*)(GDALTranslateOptions*)> options(
      GDALTranslateOptionsNew(how.List(), nullptr), GDALTranslateOptionsFree);
  raw.bands.reset(GDALDataset::FromHandle(GDALTranslate("", GDALDataset::ToHandle(raw.file.get()), options.get(), nullptr)));
  if (!raw.bands) fail(path, dem, "its bands cannot be read" + errors.suffix());
  double transform[6];
  raw.georeferenced =
      raw.file->GetGeoTransform(transform) == CE_None || raw.file->GetGCPCount() > 0 || raw.file->GetMetadata("RPC") != nullptr;
  return raw;
}

/// Where numbers begin and end for the eye: the 1 and 99 % percentiles of all colour bands together, of pixels here and there.
std::array<double, 2> stretch(const Raw& raw) {
  const int width = std::min(sampled, raw.bands->GetRasterXSize()), height = std::min(sampled, raw.bands->GetRasterYSize());
  std::vector<float> values, cells(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<std::uint8_t> mask(cells.size());
  for (int b = 1; b <= raw.colours; ++b) {
    GDALRasterBand* band = raw.bands->GetRasterBand(b);
    if (band->RasterIO(GF_Read, 0, 0, band->GetXSize(), band->GetYSize(), cells.data(), width, height, GDT_Float32, 0, 0,
                       nullptr) != CE_None ||
        band->GetMaskBand()->RasterIO(GF_Read, 0, 0, band->GetXSize(), band->GetYSize(), mask.data(), width, height, GDT_Byte, 0,
                                      0, nullptr) != CE_None)
      return {0, 1};
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (mask[i] != 0 && std::isfinite(cells[i])) values.push_back(cells[i]);
  }
  if (values.empty()) return {0, 1};
  const double low = percentile(values, 0.01), high = percentile(values, 0.99);
  return {low, high > low ? high : low + 1};
}

/// The grid of the picture, and how the raster lies on it.
struct Plan {
  double left = 0, top = 0, width = 0, height = 0;  // cells of the DEM
  std::array<double, 6> transform{};                // of the DEM
  int columns = 1, rows = 1;                        // pixels
};

/// Columns and rows of the DEM for places of the raster, in pixels.
class ToCells {
 public:
  ToCells(GDALDataset& raster, const std::array<double, 6>& transform, const std::string& crs) {
    CPLStringList how;
    if (!crs.empty() && raster.GetSpatialRef() != nullptr) how.SetNameValue("DST_SRS", crs.c_str());
    how.SetNameValue("STRIP_VERT_CS", "YES");
    argument_ = GDALCreateGenImgProjTransformer2(GDALDataset::ToHandle(&raster), nullptr, how.List());
    if (argument_ != nullptr) GDALSetGenImgProjTransformerDstGeoTransform(argument_, transform.data());
  }
  ~ToCells() {
    if (argument_ != nullptr) GDALDestroyGenImgProjTransformer(argument_);
  }
  ToCells(const ToCells&) = delete;
  ToCells& operator=(const ToCells&) = delete;
  bool known() const { return argument_ != nullptr; }
  /// NaN where the place has no image.
  std::array<double, 2> operator()(double x, double y) const {
    double z = 0;
    int good = 0;
    GDALGenImgProjTransform(argument_, FALSE, 1, &x, &y, &z, &good);
    return good && std::isfinite(x) && std::isfinite(y) ? std::array<double, 2>{x, y}
                                                        : std::array<double, 2>{std::nan(""), std::nan("")};
  }

 private:
  void* argument_ = nullptr;
};

Plan plan_picture(const std::string& path, Raw& raw, const Placed& dem, const std::string& crs, const DrapeLimits& limits,
                  Plan plan) {
  const GdalErrors errors;
  const ToCells to_cells(*raw.bands, plan.transform, crs);
  if (!to_cells.known()) fail(path, dem, "their coordinate systems cannot be related" + errors.suffix());
  const double wide = raw.bands->GetRasterXSize(), high = raw.bands->GetRasterYSize();
  constexpr int parts = 24;
  double west = INFINITY, east = -INFINITY, north = INFINITY, south = -INFINITY, finest_x = 0, finest_y = 0;
  bool whole = false;
  for (int j = 0; j <= parts; ++j)
    for (int i = 0; i <= parts; ++i) {
      const double x = wide * i / parts, y = high * j / parts, step_x = i < parts ? 0.5 : -0.5, step_y = j < parts ? 0.5 : -0.5;
      const auto p = to_cells(x, y), across = to_cells(x + step_x, y), down = to_cells(x, y + step_y);
      if (std::isnan(p[0]) || std::isnan(across[0]) || std::isnan(down[0])) {
        whole = true;  // parts of it lie beyond what the CRS of the DEM can tell
        continue;
      }
      west = std::min(west, p[0]), east = std::max(east, p[0]), north = std::min(north, p[1]), south = std::max(south, p[1]);
      // Pixels per cell along the columns and rows of the DEM: the inverse of the derivatives.
      const double a = (across[0] - p[0]) / step_x, b = (down[0] - p[0]) / step_y, c = (across[1] - p[1]) / step_x,
                   d = (down[1] - p[1]) / step_y;
      const double determinant = std::abs(a * d - b * c);
      const bool inside = p[0] > -0.5 * static_cast<double>(dem.size.width) && p[0] < 1.5 * static_cast<double>(dem.size.width) &&
                          p[1] > -0.5 * static_cast<double>(dem.size.height) && p[1] < 1.5 * static_cast<double>(dem.size.height);
      if (determinant > 0 && (inside || finest_x == 0)) {
        finest_x = std::max(finest_x, std::hypot(d, c) / determinant);
        finest_y = std::max(finest_y, std::hypot(a, b) / determinant);
      }
    }
  if (whole || !(west < east))
    west = north = 0, east = static_cast<double>(dem.size.width), south = static_cast<double>(dem.size.height);
  plan.left = std::max(0.0, west), plan.top = std::max(0.0, north);
  plan.width = std::min(static_cast<double>(dem.size.width), east) - plan.left;
  plan.height = std::min(static_cast<double>(dem.size.height), south) - plan.top;
  if (!(plan.width > 0 && plan.height > 0)) fail(path, dem, "they share no ground");
  const double per_column = std::min(finest_x > 0 ? finest_x : 1, limits.per_cell),
               per_row = std::min(finest_y > 0 ? finest_y : 1, limits.per_cell);
  const double longest = static_cast<double>(limits.longest),
               shrink = std::min({1.0, longest / (plan.width * per_column), longest / (plan.height * per_row)});
  const auto pixels = [&](double cells) { return static_cast<int>(std::clamp(std::ceil(cells * shrink - 1e-6), 1.0, longest)); };
  plan.columns = pixels(plan.width * per_column);
  plan.rows = pixels(plan.height * per_row);
  return plan;
}

/// Rows [first, first + rows) of the picture: colours and opacity, in bands of a dataset in memory.
GDALDatasetUniquePtr warp_strip(const std::string& path, Raw& raw, const Placed& dem, const std::string& crs, const Plan& plan,
                                int first, int rows) {
  const GdalErrors errors;
  GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
  GDALDatasetUniquePtr strip(
      memory->Create("", plan.columns, rows, raw.colours + 1, raw.bytes ? GDT_Byte : GDT_Float32, nullptr));
  if (!strip) throw Error(ErrorKind::memory, "not enough memory for a strip of '" + path + "'");
  const double across = plan.width / plan.columns, down = plan.height / plan.rows, top = plan.top + first * down;
  const auto& t = plan.transform;
  double transform[6] = {t[0] + plan.left * t[1] + top * t[2], across * t[1], down * t[2],
                         t[3] + plan.left * t[4] + top * t[5], across * t[4], down * t[5]};
  strip->SetGeoTransform(transform);
  strip->GetRasterBand(raw.colours + 1)->SetColorInterpretation(GCI_AlphaBand);
  CPLStringList how;
  for (const char* word : {"-r", "bilinear", "-novshift", "-wm", "64", "-q"}) how.AddString(word);
  const std::string source = raw.bands->GetSpatialRef() != nullptr ? raw.bands->GetProjectionRef() : "";
  if (!crs.empty() || !source.empty()) {
    const std::string& to = !crs.empty() && !source.empty() ? crs : source.empty() ? crs : source;
    strip->SetProjection(to.c_str());
    how.AddString("-s_srs");
    how.AddString((source.empty() ? to : source).c_str());
    how.AddString("-t_srs");
    how.AddString(to.c_str());
  }
  const std::unique_ptr<GDALWarpAppOptions, void (*)(GDALWarpAppOptions*)> options(GDALWarpAppOptionsNew(how.List(), nullptr),
                                                                                   GDALWarpAppOptionsFree);
  GDALDatasetH from = GDALDataset::ToHandle(raw.bands.get());
  int wrong = 0;
  if (GDALWarp(nullptr, GDALDataset::ToHandle(strip.get()), 1, &from, options.get(), &wrong) == nullptr || wrong != 0 ||
      errors.failed())
    fail(path, dem, "it cannot be warped" + errors.suffix());
  return strip;
}

}  // namespace

DrapePicture read_drape(const std::string& path, const Placed& dem, const DrapeLimits& limits) {
  Raw raw = open_bands(path, dem);
  Plan plan;
  std::string crs = dem.geo.crs_wkt;
  if (dem.geo.transform && raw.georeferenced) {
    plan.transform = *dem.geo.transform;
  } else {
    const double wide = static_cast<double>(dem.size.width) / raw.bands->GetRasterXSize(),
                 high = static_cast<double>(dem.size.height) / raw.bands->GetRasterYSize();
    if (!(std::abs(wide / high - 1) <= 0.01)) fail(path, dem, "one has no georeference, and their proportions differ");
    plan.transform = {0, 1, 0, 0, 0, 1};
    double transform[6] = {0, wide, 0, 0, 0, high};
    raw.bands->SetGeoTransform(transform);
    raw.bands->SetSpatialRef(nullptr);
    crs.clear();
  }
  plan = plan_picture(path, raw, dem, crs, limits, plan);

  DrapePicture drape{Picture(plan.columns, plan.rows, {0, 0, 0, 0}),
                     plan.left,
                     plan.top,
                     plan.width,
                     plan.height,
                     false,
                     raw.colours == 1 && !raw.bytes,
                     0,
                     255};
  if (!raw.bytes) {
    const auto [low, high] = stretch(raw);
    drape.low = low, drape.high = high;
  }
  const ColourRamp ramp = named_ramp("viridis");
  std::int64_t shown = 0, solid = 0;
  std::vector<float> line(static_cast<std::size_t>(plan.columns) * static_cast<std::size_t>(raw.colours + 1));
  for (int first = 0; first < plan.rows; first += strip_rows) {
    const int rows = std::min(strip_rows, plan.rows - first);
    const GDALDatasetUniquePtr strip = warp_strip(path, raw, dem, crs, plan, first, rows);
    for (int y = 0; y < rows; ++y) {
      const auto pixel_bytes = static_cast<GSpacing>(sizeof(float)) * (raw.colours + 1);
      if (strip->RasterIO(GF_Read, 0, y, plan.columns, 1, line.data(), plan.columns, 1, GDT_Float32, raw.colours + 1, nullptr,
                          pixel_bytes, 0, sizeof(float), nullptr) != CE_None)
        fail(path, dem, "it cannot be warped");
      for (int x = 0; x < plan.columns; ++x) {
        const float* values = &line[static_cast<std::size_t>(x) * static_cast<std::size_t>(raw.colours + 1)];
        Colour& pixel = drape.picture(x, first + y);
        const float opacity = values[raw.colours];
        if (!(opacity >= 0.5f)) continue;
        const auto share = [&](int band) { return (static_cast<double>(values[band]) - drape.low) / (drape.high - drape.low); };
        if (drape.values) {
          if (std::isnan(values[0])) continue;
          pixel = ramp.at(share(0));
        } else {
          for (int c = 0; c < 3; ++c)
            pixel[static_cast<std::size_t>(c)] =
                static_cast<std::uint8_t>(std::lround(255 * std::clamp(share(raw.colours == 3 ? c : 0), 0.0, 1.0)));
        }
        pixel[3] = static_cast<std::uint8_t>(std::lround(std::min(opacity, 255.0f)));
        ++shown;
        solid += pixel[3] == 255;
      }
    }
  }
  if (shown == 0) fail(path, dem, "they share no ground, or all pixels there are without data");
  const bool all = plan.left < 0.5 && plan.top < 0.5 && plan.left + plan.width > static_cast<double>(dem.size.width) - 0.5 &&
                   plan.top + plan.height > static_cast<double>(dem.size.height) - 0.5;
  drape.opaque = all && solid >= drape.picture.width() * drape.picture.height() * 999 / 1000;
  return drape;
}

}  // namespace arete
