#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/support/progress.h"
#include "core/support/scratch.h"
#include "core/terrain/georeference.h"
#include "gis/mesh/mesh.h"
#include "gis/mesh/recent_blocks.h"

namespace arete {

/// So many units of a RasterPoint are one cell.
inline constexpr std::int64_t cell_units = std::int64_t{1} << 30;

/// A vertex in the plane of a raster: column and row in units of 2^-30 cell from the centre of the first cell, rows growing
/// downwards, and its height in metres. Integers, so that what is asked of places has an exact answer.
struct RasterPoint {
  std::int64_t column = 0;
  std::int64_t row = 0;
  double z = 0;
};

/// Takes vertices of a mesh back to the plane of the raster that it was made of.
///
/// CRS: where both are the same, or one is unknown, only the raster's transform counts (without one: x = column, y = -row, the
/// outer corner of the first cell at 0, 0). Else coordinates are transformed horizontally (PROJ through OGR, axes in the order
/// east, north; the height that a datum shift sees is 0), and heights stay as they are, unless both CRS name vertical parts that
/// differ. Geocentric coordinates are transformed with the height: to the raster's CRS with its vertical part, or to ellipsoidal
/// heights where it has none. What counts is which place of the raster's CRS comes to lie on the vertex: datum shifts and their
/// inverse differ by up to 1 mm.
///
/// Noise: georeferencing rounds places to about 1e-9 of a cell. A column or row that lies within `snap` of a multiple of half a
/// cell is that multiple; every other is rounded to 2^-30 cell. A height that came through a change of CRS, or from a unit other than the
/// metre, is the nearest float where that is within 1e-6 m, or 1e-9 m: floats are what rasters are read as. Other heights are as they
/// are stated.
class RasterPlane {
 public:
  /// `snap` in cells, below 0.25. Throws Error{input} where the CRS cannot be related or the transform cannot be inverted.
  RasterPlane(const MeshFrame& frame, const GeoReference& geo, double snap = 1e-6);
  ~RasterPlane();
  /// `first`: the index of the first vertex, for messages. Throws Error{input} where a vertex is not finite, has no place in the
  /// raster's CRS, or lies 2^31 cells away. One thread.
  void place(std::int64_t first, std::span<const MeshVertex> vertices, std::span<RasterPoint> out) const;
  /// The sign of the area, in columns and rows, of triangles that are counter-clockwise in x and y: -1 where north is up.
  int orientation() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All vertices of a mesh in the plane of a raster, in memory or, beyond the limit, in a file.
class RasterPoints {
 public:
  /// Throws as RasterPlane::place and ScratchBytes.
  RasterPoints(const MeshSource& mesh, const RasterPlane& plane, const Scratch& scratch, std::int64_t limit_bytes, Progress& progress);
  RasterPoints(const RasterPoints&) = delete;
  RasterPoints& operator=(const RasterPoints&) = delete;
  std::int64_t size() const { return size_; }
  /// Valid until the next call.
  const RasterPoint& at(std::int64_t index) { return blocks_.at(index / block_points).points[static_cast<std::size_t>(index % block_points)]; }
  /// Points [first, first + out.size()).
  void read(std::int64_t first, std::span<RasterPoint> out) const;

 private:
  static constexpr std::int64_t block_points = 4096;
  struct Block {
    std::vector<RasterPoint> points;
  };
  std::int64_t size_;
  ScratchBytes bytes_;
  RecentBlocks<Block> blocks_;
};

/// The corners of the index-th triangle. Throws Error{input} where it names a vertex that is not there.
std::array<RasterPoint, 3> corners_of(const MeshTriangle& triangle, std::int64_t index, RasterPoints& points);

}  // namespace arete
