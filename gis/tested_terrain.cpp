#include "gis/tested_terrain.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/support/error.h"
#include "core/terrain/fill_voids.h"

namespace arete {
namespace {

constexpr double most_codes = std::numeric_limits<std::int32_t>::max();

bool all_are_multiples(const Raster<float>& cells, double quantum) {
  const LinearMap map{0, 1, quantum};
  const float* end = cells.data() + cells.size().cells();
  return std::all_of(cells.data(), end, [&](float z) {
    if (is_void(z)) return true;
    const double multiple = static_cast<double>(z) / quantum;
    return std::abs(multiple) < most_codes && map.elevation(std::llround(multiple)) == z;
  });
}

/// Maps each filled cell by to_code, clamped from 0 to the highest code.
template <typename F>
Raster<std::int32_t> code_cells(const Raster<float>& filled, std::int32_t highest, const F& to_code) {
  Raster<std::int32_t> codes(filled.width(), filled.height());
  for (std::int64_t i = 0; i < filled.size().cells(); ++i)
    codes.data()[i] = static_cast<std::int32_t>(std::clamp<std::int64_t>(to_code(static_cast<double>(filled.data()[i])), 0, highest));
  return codes;
}

/// Whether floats hold multiples of the quantum as they are.
bool exact_in_floats(double quantum) { return std::floor(quantum) == quantum; }

/// How far apart floats are where the terrain is farthest from 0.
double rounding_of_floats(const TestedTerrain& terrain) {
  const float farthest = std::max(std::abs(terrain.low), std::abs(terrain.high));
  return static_cast<double>(std::nextafter(farthest, std::numeric_limits<float>::infinity()) - farthest);
}

std::optional<UniformSteps> steps_of_quanta(const TestedTerrain& terrain, double bound_m) {
  const double quantum = terrain.quantum;
  const std::int64_t lowest = std::llround(static_cast<double>(terrain.low) / quantum);
  const std::int64_t highest = std::llround(static_cast<double>(terrain.high) / quantum);
  const double slack = exact_in_floats(quantum) ? 0 : rounding_of_floats(terrain);
  const auto within = static_cast<std::int64_t>(std::clamp(std::floor((bound_m - slack) / quantum), 0.0, most_codes / 4));
  const std::int64_t stride = 2 * within + 1, last = (highest - lowest + within) / stride;
  if (last >= static_cast<std::int64_t>(most_codes)) return std::nullopt;
  return UniformSteps{{static_cast<double>(lowest), static_cast<double>(stride), quantum}, static_cast<std::int32_t>(last), true};
}

std::optional<UniformSteps> steps_of_metres(const TestedTerrain& terrain, double bound_m) {
  const double low = terrain.low, high = terrain.high;
  // What is decoded is rounded by half of it at most; the rest is for the roundings of double.
  const double stride = 2 * (bound_m - rounding_of_floats(terrain));
  if (!(stride > 0) || (high - low) / stride >= most_codes - 1) return std::nullopt;
  return UniformSteps{{low, stride, 1}, static_cast<std::int32_t>(std::llround((high - low) / stride)), false};
}

template <typename T>
void append(std::vector<std::byte>& bytes, T value) {
  const auto* raw = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), raw, raw + sizeof value);
}

template <typename T>
T take(std::span<const std::byte>& bytes) {
  if (bytes.size() < sizeof(T))
    throw Error(ErrorKind::damaged, "a coded terrain ends after " + std::to_string(bytes.size()) + " bytes of its map, expected " +
                                        std::to_string(sizeof(T)));
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes = bytes.subspan(sizeof value);
  return value;
}

}  // namespace

TestedTerrain examine_terrain(std::string name, Raster<float> cells, double unit) {
  TestedTerrain terrain;
  terrain.name = std::move(name);
  terrain.low = std::numeric_limits<float>::infinity();
  terrain.high = -terrain.low;
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) {
    const float z = cells.data()[i];
    if (is_void(z)) continue;
    ++terrain.valid;
    terrain.low = std::min(terrain.low, z);
    terrain.high = std::max(terrain.high, z);
  }
  if (terrain.valid == 0) throw Error(ErrorKind::input, terrain.name + ": no valid elevation; there is nothing to compress");
  if (terrain.low == terrain.high)
    throw Error(ErrorKind::input, terrain.name + ": every valid elevation is " + std::to_string(terrain.low) + " m; a PSNR needs relief");
  for (const int parts : {1, 10, 100, 1000})
    if (terrain.quantum == 0 && all_are_multiples(cells, unit / parts)) terrain.quantum = unit / parts;
  terrain.filled = cells.clone();
  if (terrain.valid < cells.size().cells()) fill_voids(terrain.filled.view());
  terrain.cells = std::move(cells);
  return terrain;
}

CodedTerrain scale_to_16_bits(const TestedTerrain& terrain) {
  constexpr std::int32_t highest = 65535;
  const double low = terrain.low;
  // Stored as a float, so used as one.
  const auto stride = static_cast<float>((static_cast<double>(terrain.high) - low) / highest);
  CodedTerrain coded;
  coded.map = {low, static_cast<double>(stride), 1};
  coded.highest = highest;
  coded.codes = code_cells(terrain.filled, highest, [&](double z) { return std::llround((z - low) / static_cast<double>(stride)); });
  return coded;
}

std::optional<UniformSteps> steps_within(const TestedTerrain& terrain, double bound_m) {
  const std::optional<UniformSteps> metres = steps_of_metres(terrain, bound_m);
  if (terrain.quantum == 0) return metres;
  const std::optional<UniformSteps> quanta = steps_of_quanta(terrain, bound_m);
  if (quanta && exact_in_floats(terrain.quantum)) return quanta;
  return quanta && (!metres || quanta->map.stride * quanta->map.unit >= metres->map.stride) ? quanta : metres;
}

CodedTerrain quantise(const TestedTerrain& terrain, const UniformSteps& steps) {
  CodedTerrain coded{steps.map, {}, steps.highest};
  const double quantum = terrain.quantum, low = terrain.low;
  const auto base = static_cast<std::int64_t>(steps.map.base), stride = static_cast<std::int64_t>(steps.map.stride);
  if (steps.of_quanta)
    coded.codes = code_cells(terrain.filled, steps.highest, [&](double z) { return (std::llround(z / quantum) - base + stride / 2) / stride; });
  else
    coded.codes = code_cells(terrain.filled, steps.highest, [&](double z) { return std::llround((z - low) / steps.map.stride); });
  return coded;
}

std::vector<std::byte> with_map(const std::optional<LinearMap>& map, std::span<const std::byte> file) {
  std::vector<std::byte> bytes;
  bytes.reserve(file.size() + 32);
  const auto as_float = [](double value) { return static_cast<float>(value); };
  if (!map) {
    bytes.push_back(std::byte{0});
  } else if (map->unit == 1 && static_cast<double>(as_float(map->base)) == map->base &&
             static_cast<double>(as_float(map->stride)) == map->stride) {
    bytes.push_back(std::byte{1});
    append(bytes, as_float(map->base));
    append(bytes, as_float(map->stride));
  } else {
    bytes.push_back(std::byte{2});
    append(bytes, map->base);
    append(bytes, map->stride);
    append(bytes, map->unit);
  }
  bytes.insert(bytes.end(), file.begin(), file.end());
  return bytes;
}

MappedFile read_map(std::span<const std::byte> bytes) {
  MappedFile mapped;
  const auto kind = take<std::uint8_t>(bytes);
  if (kind > 2) throw Error(ErrorKind::damaged, "a coded terrain begins with " + std::to_string(kind) + ", expected 0, 1 or 2");
  if (kind == 1) {
    const auto base = take<float>(bytes), stride = take<float>(bytes);
    mapped.map = {static_cast<double>(base), static_cast<double>(stride), 1};
  } else if (kind == 2) {
    const auto base = take<double>(bytes), stride = take<double>(bytes), unit = take<double>(bytes);
    mapped.map = {base, stride, unit};
  }
  mapped.file = bytes;
  return mapped;
}

}  // namespace arete
