#include "shaders/scene_renderer.h"

#include <utility>

namespace arete {

std::function<void(const DrawnPart&)> SceneRenderer::develop_into(std::vector<std::uint8_t>& rgba, Size picture) const {
  return [&rgba, picture, threads = threads()](const DrawnPart& drawn) {
    rgba.resize(static_cast<std::size_t>(picture.cells() * 4));
    develop(drawn, threads, picture.width, rgba.data());
  };
}

Frame SceneRenderer::draw(const Camera& camera, Size picture, DrawMode mode) {
  std::vector<std::uint8_t> rgba;
  Frame frame = draw_parts(camera, picture, mode, Highlights::roll_off, develop_into(rgba, picture));
  frame.rgba = std::move(rgba);
  return frame;
}

Frame SceneRenderer::draw_rows(const Camera& camera, Size picture, DrawMode mode, Highlights highlights, const std::function<void(const LightRows&)>& take) {
  LightRows rows;
  return draw_parts(camera, picture, mode, highlights, [&](const DrawnPart& drawn) {
    const PicturePart& part = drawn.part;
    rows.y = part.y;
    rows.size = {picture.width, part.height};
    rows.rgba.resize(static_cast<std::size_t>(rows.size.cells() * 4));
    average(drawn, threads(), rows);
    if (part.x + part.width == picture.width) take(rows);
  });
}

}  // namespace arete
