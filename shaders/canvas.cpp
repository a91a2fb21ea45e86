#include "shaders/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <epoxy/gl.h>

#include "core/support/error.h"
#include "core/support/parallel.h"
#include "core/support/random.h"
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

double from_linear(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

/// IEEE 754 binary16, finite values.
float from_half(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const double size = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return static_cast<float>(bits >> 15 ? -size : size);
}

template <typename Function>
std::vector<float> tabulate(const Function& f) {
  std::vector<float> table(65536);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = f(static_cast<std::uint16_t>(i));
  return table;
}

float srgb_of(double linear) { return static_cast<float>(255 * from_linear(std::clamp(linear, 0.0, 1.0))); }

/// Averages pixels of linear light and writes them as sRGB of 8 bits, with noise of one step against banding.
void develop(const std::vector<std::uint16_t>& pixels, std::int64_t rows, int supersampling, const PicturePart& part, int threads, Frame& frame) {
  static const std::vector<float> linear = tabulate(from_half), direct = tabulate([](std::uint16_t bits) { return srgb_of(static_cast<double>(from_half(bits))); });
  const std::int64_t stride = part.width * supersampling;
  const double share = 1.0 / (supersampling * supersampling);
  parallel_for(part.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < part.width; ++x) {
      const std::uint16_t* from = &pixels[static_cast<std::size_t>(((rows - 1 - y * supersampling) * stride + x * supersampling) * 4)];
      float exact[3], covered = linear[from[3]];
      if (supersampling == 1) {
        for (std::size_t c = 0; c < 3; ++c) exact[c] = direct[from[c]];
      } else {
        double sum[4] = {};
        for (std::int64_t v = 0; v < supersampling; ++v, from -= stride * 4)
          for (std::int64_t u = 0; u < 4 * supersampling; ++u) sum[u % 4] += static_cast<double>(linear[from[u]]);
        for (std::size_t c = 0; c < 3; ++c) exact[c] = srgb_of(sum[c] * share);
        covered = static_cast<float>(sum[3] * share);
      }
      std::uint64_t noise = hash_position(11, static_cast<std::uint64_t>(part.x + x), static_cast<std::uint64_t>(part.y + y));
      std::uint8_t* out = &frame.rgba[static_cast<std::size_t>(((part.y + y) * frame.size.width + part.x + x) * 4)];
      // Whole + 1 where the noise is less than the rest.
      for (std::size_t c = 0; c < 3; ++c, noise >>= 21)
        out[c] = static_cast<std::uint8_t>(std::min(255, static_cast<int>(exact[c] + static_cast<float>(0x1fffff - (noise & 0x1fffff)) * 0x1p-21f)));
      out[3] = static_cast<std::uint8_t>(255 * std::clamp(covered, 0.0f, 1.0f) + 0.5f);
    }
  });
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

Frame draw_in_parts(Size picture, int supersampling, int threads, std::unique_ptr<Canvas>& canvas,
                    const std::function<void(const PicturePart&, const Canvas&)>& draw_part) {
  if (picture.width < 1 || picture.height < 1 || picture.width > largest_picture || picture.height > largest_picture)
    throw Error(ErrorKind::usage, "cannot draw a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                                      " pixels: sides are 1 to " + std::to_string(largest_picture));
  Frame frame{picture, std::vector<std::uint8_t>(static_cast<std::size_t>(picture.cells() * 4)), 0, 0, 0};
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
      develop(pixels, part.height * supersampling, supersampling, part, threads, frame);
    }
  return frame;
}

}  // namespace arete
