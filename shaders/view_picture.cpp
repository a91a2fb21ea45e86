#include "shaders/view_picture.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace arete {
namespace {

/// Copies columns [from, to) of a frame to where they belong: `at` is the column of the first.
void copy_columns(const Frame& frame, std::int64_t from, std::int64_t to, std::int64_t at, Frame& picture) {
  const std::int64_t count = std::min({to - from, frame.size.width - from, picture.size.width - at});
  if (count <= 0) return;
  for (std::int64_t y = 0; y < std::min(frame.size.height, picture.size.height); ++y)
    std::memcpy(&picture.rgba[static_cast<std::size_t>(4 * (y * picture.size.width + at))],
                &frame.rgba[static_cast<std::size_t>(4 * (y * frame.size.width + from))], static_cast<std::size_t>(4 * count));
}

void draw_line(Frame& picture, std::int64_t column, std::int64_t line_px) {
  const std::int64_t from = std::max<std::int64_t>(0, column - line_px / 2), to = std::min(picture.size.width, from + line_px);
  for (std::int64_t y = 0; y < picture.size.height; ++y)
    for (std::int64_t x = from; x < to; ++x) std::memset(&picture.rgba[static_cast<std::size_t>(4 * (y * picture.size.width + x))], 255, 4);
}

}  // namespace

Size picture_of_one(ViewLayout layout, Size picture) {
  return layout == ViewLayout::side_by_side ? Size{std::max<std::int64_t>(1, picture.width / 2), picture.height} : picture;
}

std::array<std::optional<Frame>, 2> draw_terrains(const ViewedTerrains& terrains, const ViewedScene& scene, Size picture) {
  std::array<std::optional<Frame>, 2> frames;
  const Size size = picture_of_one(scene.layout, picture);
  Camera camera = camera_of(scene.camera);
  for (SceneRenderer* terrain : {terrains.first, terrains.second})
    if (terrain != nullptr) terrain->restyle(scene.style);
  if (terrains.second == nullptr || scene.layout != ViewLayout::second) frames[0] = terrains.first->draw(camera, size, scene.mode);
  if (terrains.second == nullptr || scene.layout == ViewLayout::first) return frames;
  camera.eye = subtract(camera.eye, terrains.offset_m);
  camera.target = subtract(camera.target, terrains.offset_m);
  frames[1] = terrains.second->draw(camera, size, scene.mode);
  return frames;
}

Frame compose_view(const std::array<std::optional<Frame>, 2>& frames, const ViewedScene& scene, Size picture, std::int64_t line_px) {
  Frame whole{picture, std::vector<std::uint8_t>(static_cast<std::size_t>(4 * picture.cells()), 255), 0, 0, 0};
  for (const auto& frame : frames)
    if (frame) whole.patches += frame->patches, whole.triangles += frame->triangles, whole.tiles_loaded += frame->tiles_loaded;
  if (!frames[0] || !frames[1]) {
    whole.rgba = (frames[0] ? frames[0] : frames[1])->rgba;
    return whole;
  }
  const bool swipe = scene.layout == ViewLayout::swipe;
  const std::int64_t column = swipe ? std::llround(scene.divider * static_cast<double>(picture.width)) : picture.width / 2;
  copy_columns(*frames[0], 0, column, 0, whole);
  copy_columns(*frames[1], swipe ? column : 0, picture.width, column, whole);
  draw_line(whole, column, line_px);
  return whole;
}

}  // namespace arete
