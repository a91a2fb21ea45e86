#include "shaders/canvas.h"

#include <algorithm>
#include <string>

#include <epoxy/gl.h>

#include "core/support/error.h"
#include "shaders/gl_uniforms.h"

namespace arete {
namespace {

constexpr std::int64_t largest_picture = 16384;
// Parts that are drawn at once, in pixels of the canvas.
constexpr std::int64_t largest_part = 1280;

void begin(GLuint frame, std::int64_t width, std::int64_t height) {
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
}

}  // namespace

Canvas::Canvas(std::int64_t width, std::int64_t height) : size_{width, height} {
  const auto w = static_cast<GLsizei>(width), h = static_cast<GLsizei>(height);
  glCreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 2, seen_);
  glCreateRenderbuffers(1, &picture_);
  glCreateFramebuffers(2, frames_);
  glTextureStorage2DMultisample(seen_[0], samples_per_pixel, GL_R32UI, w, h, GL_TRUE);
  glTextureStorage2DMultisample(seen_[1], samples_per_pixel, GL_DEPTH_COMPONENT32F, w, h, GL_TRUE);
  glNamedRenderbufferStorage(picture_, GL_RGBA16F, w, h);
  glNamedFramebufferTexture(frames_[0], GL_COLOR_ATTACHMENT0, seen_[0], 0);
  glNamedFramebufferTexture(frames_[0], GL_DEPTH_ATTACHMENT, seen_[1], 0);
  glNamedFramebufferRenderbuffer(frames_[1], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, picture_);
  for (const GLuint frame : frames_)
    if (glCheckNamedFramebufferStatus(frame, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw Error(ErrorKind::format, "the OpenGL driver cannot draw to integers with a depth of 32 bits and four samples, or to half floats");
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
  for (int i = 0; i < samples_per_pixel; ++i) {
    GLfloat at[2];
    glGetMultisamplefv(GL_SAMPLE_POSITION, static_cast<GLuint>(i), at);
    offsets_x_[i] = at[0] - 0.5f;
    offsets_y_[i] = at[1] - 0.5f;
  }
}

Canvas::~Canvas() {
  glDeleteFramebuffers(2, frames_);
  glDeleteTextures(2, seen_);
  glDeleteRenderbuffers(1, &picture_);
}

void Canvas::clear() const {
  const GLuint nothing[4] = {};
  const GLfloat far = 0;
  glDepthMask(GL_TRUE);
  glClearNamedFramebufferuiv(frames_[0], GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(frames_[0], GL_DEPTH, 0, &far);
}

void Canvas::begin_surfaces(std::int64_t width, std::int64_t height) const { begin(frames_[0], width, height); }

void Canvas::begin_colours(std::int64_t width, std::int64_t height) const {
  begin(frames_[1], width, height);
  glBindTextureUnit(0, seen_[0]);
  glBindTextureUnit(1, seen_[1]);
}

void Canvas::read(std::int64_t width, std::int64_t height, std::vector<std::uint16_t>& pixels) const {
  pixels.resize(static_cast<std::size_t>(width * height * 4));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frames_[1]);
  glReadPixels(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height), GL_RGBA, GL_HALF_FLOAT, pixels.data());
}

void Canvas::set_samples(unsigned program, const Camera& camera, Size picture, const PicturePart& part, int supersampling, double near_m) const {
  set(program, "to_ray", ray_matrix(camera, picture, part));
  set(program, "near", near_m);
  set(program, "pixel", 2 / static_cast<double>(part.width * supersampling), 2 / static_cast<double>(part.height * supersampling));
  glProgramUniform4fv(program, glGetUniformLocation(program, "offsets_x"), 1, offsets_x_);
  glProgramUniform4fv(program, glGetUniformLocation(program, "offsets_y"), 1, offsets_y_);
}

void draw_in_parts(Size picture, int supersampling, std::unique_ptr<Canvas>& canvas, const std::function<void(const DrawnPart&)>& take,
                   const std::function<void(const PicturePart&, const Canvas&)>& draw_part) {
  if (picture.width < 1 || picture.height < 1 || picture.width > largest_picture || picture.height > largest_picture)
    throw Error(ErrorKind::usage, "cannot draw a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                                      " pixels: sides are 1 to " + std::to_string(largest_picture));
  const auto side = [&](std::int64_t length) {
    const std::int64_t count = (length * supersampling + largest_part - 1) / largest_part;
    return (length + count - 1) / count;
  };
  const std::int64_t across = side(picture.width), down = side(picture.height);
  const Size size{across * supersampling, down * supersampling};
  // The one of the frame before where it has this size: memory that was touched already.
  if (!canvas || canvas->size() != size) {
    canvas.reset();
    canvas = std::make_unique<Canvas>(size.width, size.height);
  }
  std::vector<std::uint16_t> pixels;
  for (std::int64_t y = 0; y < picture.height; y += down)
    for (std::int64_t x = 0; x < picture.width; x += across) {
      const PicturePart part{x, y, std::min(across, picture.width - x), std::min(down, picture.height - y)};
      draw_part(part, *canvas);
      canvas->read(part.width * supersampling, part.height * supersampling, pixels);
      take({pixels, supersampling, part});
    }
}

}  // namespace arete
