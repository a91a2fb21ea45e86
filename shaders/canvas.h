#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/terrain/raster.h"
#include "shaders/camera.h"
#include "shaders/develop.h"

namespace arete {

/// What is seen at each sample of a picture: the number of a surface, and how far away (samples.glsl). And a picture to colour.
class Canvas {
 public:
  /// Of so many pixels. Throws Error{format} where the driver has no such pictures.
  Canvas(std::int64_t width, std::int64_t height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  Size size() const { return size_; }
  /// Nothing is seen any more within the scissors.
  void clear() const;
  void begin_surfaces(std::int64_t width, std::int64_t height) const;
  void begin_colours(std::int64_t width, std::int64_t height) const;
  /// Linear RGBA in half floats, row 0 at the bottom.
  void read(std::int64_t width, std::int64_t height, std::vector<std::uint16_t>& pixels) const;
  /// Uniforms of samples.glsl for a part of a picture of so many pixels of the canvas that begins at `near_m`.
  void set_samples(unsigned program, const Camera& camera, Size picture, const PicturePart& part, int supersampling, double near_m) const;

 private:
  static constexpr int samples_per_pixel = 4;

  Size size_;
  unsigned seen_[2]{}, picture_ = 0, frames_[2]{};
  float offsets_x_[samples_per_pixel]{}, offsets_y_[samples_per_pixel]{};  // of each sample from the middle of its pixel
};

/// Draws a picture of 1 x 1 to 16384 x 16384 pixels in parts of about the same size, row by row: `draw_part` colours the lower left of the canvas,
/// supersampling times as large as the part, and `take` gets what it drew. The canvas is kept for the next picture where it has the same size. Throws
/// Error{usage} for other sizes.
void draw_in_parts(Size picture, int supersampling, std::unique_ptr<Canvas>& canvas, const std::function<void(const DrawnPart&)>& take,
                   const std::function<void(const PicturePart&, const Canvas&)>& draw_part);

}  // namespace arete
