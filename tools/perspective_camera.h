#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"
#include "shaders/camera.h"

namespace arete::tools {

/// A camera as the user describes it; what is not given follows from the terrain.
struct CameraArguments {
  std::string look_at = {};  ///< X,Y or X,Y,Z: in the CRS of the DEM (columns and rows where it has no transform), Z in metres above its zero
  std::string eye = {};      ///< X,Y,Z, or X,Y,+H: H metres above the ground
  std::optional<double> look_from_deg = {}, pitch_deg = {}, distance_m = {};
  double field_of_view_deg = 30;
  int turntable = 0;    ///< pictures round the target; 0: one
};

/// Where a camera is told to stand and to look: metres east and north of the first sample, and metres above the DEM's zero, not exaggerated.
struct CameraPlaces {
  std::optional<Point3> look_at, eye;
};

/// Terrain that cameras stand on.
struct CameraGround {
  const RasterSource& source;
  const GeoReference& geo;
  CellSize cell;
};

/// The direction of the grid's north in the scene, degrees clockwise from its y axis: 0 but for rotated transforms.
double grid_north_deg(const CameraGround& ground);

/// Metres that a pixel in the middle of a picture of that height shows across, at the distance of the target.
double metres_per_pixel(const Camera& camera, std::int64_t height);

/// Throws Error{usage}, one line, where the options contradict each other.
void check_camera(const CameraArguments& arguments);

/// Reads the ground where it must be known. Throws Error{usage}, one line, where a place is not written as it should be, lies outside the DEM or in a void
/// and has no height, and where the eye lies under the ground.
CameraPlaces find_places(const CameraArguments& arguments, const CameraGround& ground);

/// The ground at a place (metres east and north of the first sample), metres, not exaggerated: the higher of both ways to cut the four samples around into
/// triangles, so that what is drawn close by is never above. NaN in voids and outside the DEM.
double ground_at(const CameraGround& ground, double x_m, double y_m);

/// One camera, or those of a turntable in their order, clockwise. Without a place to look at they show the whole box. `box` is in exaggerated metres.
/// Throws Error{usage}, one line, where a camera would stand under the ground.
std::vector<Camera> place_cameras(const CameraArguments& arguments, const CameraPlaces& places, const CameraGround& ground, const Box& box, double exaggeration,
                                  double aspect);

/// A place of the scene as X,Y,Z of the options.
std::array<double, 3> place_in_crs(const Point3& place, const CameraGround& ground, double exaggeration);

}  // namespace arete::tools
