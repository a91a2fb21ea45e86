#pragma once

#include <memory>
#include <string>

#include "core/terrain/georeference.h"
#include "gis/mesh/mesh.h"
#include "gis/tin/tile_cells.h"

namespace arete {

/// In which plane a mesh is to lie.
struct MeshPlacement {
  std::string crs_wkt;  ///< empty: that of the raster
  bool metric = false;  ///< one unit for x, y and z: a raster in degrees is placed in its UTM zone, elevations get the unit of x and y
  bool utm = false;     ///< in place of crs_wkt: the UTM (or UPS) zone of the middle of the raster; its own where that is a UTM zone
};

/// A TIN in the plane of its raster's cells (x: columns, y: rows from the centre of the first cell, z: metres; triangles
/// counter-clockwise where rows run south) as it lies on Earth. Where the raster has no transform, x is the column and y the row
/// upwards, the outer corner of the first cell at (0, 0).
class PlacedMesh final : public MeshSource {
 public:
  /// Throws Error{usage} where the CRS cannot be related to that of the raster, or the raster has none.
  PlacedMesh(const MeshSource& mesh, const GeoReference& geo, Size size, const MeshPlacement& placement);
  ~PlacedMesh() override;

  std::int64_t vertices() const override { return mesh_.vertices(); }
  std::int64_t triangles() const override { return mesh_.triangles(); }
  /// Throws Error{input} where a vertex has no place in the CRS.
  void read_vertices(std::int64_t first, std::span<MeshVertex> out) const override;
  void read_triangles(std::int64_t first, std::span<MeshTriangle> out) const override;

  const MeshFrame& frame() const;
  bool is_in_plane_of_raster() const;
  bool is_geocentric() const;
  /// Of anything that lies over the raster, with elevations (m) between these; the border is followed with 20 points a side.
  MeshBounds bounds_of_raster(double low_m, double high_m) const;
  /// The least width of a cell in the units of x and y.
  double cell_units() const;
  /// What placing makes of straight lines: measured at nine places of the raster, along both sides and a diagonal, with half as much again;
  /// edges so short that they bend by a quarter of a cell at most. The format's rounding is not in it.
  Displacement displacement() const;
  /// How far an elevation may be off, in metres, when a reader takes it back to the raster: 0 where it stays a number of metres.
  double height_noise_m() const;

 private:
  struct Impl;
  const MeshSource& mesh_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace arete
