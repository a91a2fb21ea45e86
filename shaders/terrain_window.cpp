#include "shaders/terrain_window.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "core/support/error.h"

namespace arete {
namespace {

constexpr double settle_s = 0.2;   // without a change, until all pixels are drawn
constexpr double wanted_s = 0.08;  // for a picture while it moves
constexpr int coarsest = 4;        // pixels aside that one is drawn for

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string last_glfw_error() {
  const char* description = nullptr;
  glfwGetError(&description);
  return description == nullptr ? "no reason is given" : description;
}

[[noreturn]] void fail_without_window() {
  throw Error(ErrorKind::input, "cannot open a window (" + last_glfw_error() +
                                    "): it takes a display, X11 or XWayland, that DISPLAY names; 'arete preview IN OUT --view perspective' draws without one");
}

/// Shows pictures in the window's own context.
class Screen {
 public:
  explicit Screen(GLFWwindow* window) : window_(window) {
    glfwMakeContextCurrent(window_);
    glGenTextures(1, &texture_);
    glGenFramebuffers(1, &frame_);
  }
  ~Screen() {
    glfwMakeContextCurrent(window_);
    glDeleteFramebuffers(1, &frame_);
    glDeleteTextures(1, &texture_);
  }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Stretched to the window.
  void show(const Frame& picture, Size window) const {
    glfwMakeContextCurrent(window_);
    const auto w = static_cast<GLsizei>(picture.size.width), h = static_cast<GLsizei>(picture.size.height);
    glBindTexture(GL_TEXTURE_2D, texture_);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, w, h, 0, GL_RGBA, GL_UNSIGNED_BYTE, picture.rgba.data());
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_);
    glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    const auto to_w = static_cast<GLint>(window.width), to_h = static_cast<GLint>(window.height);
    glBlitFramebuffer(0, 0, w, h, 0, to_h, to_w, 0, GL_COLOR_BUFFER_BIT, picture.size == window ? GL_NEAREST : GL_LINEAR);
    glfwSwapBuffers(window_);
  }

 private:
  GLFWwindow* window_;
  GLuint texture_ = 0, frame_ = 0;
};

enum class Hand { none, turn, pan, divider };

/// What the window shows and what the hands are doing. The callbacks of GLFW only change this: they must not throw.
struct Session {
  GLFWwindow* window = nullptr;
  ViewedTerrains terrains;
  const WindowOptions* options = nullptr;
  ViewGround ground;
  ViewedScene scene;
  ViewSun sun, lit_sun;
  double exaggeration = 1, lit_exaggeration = 1, first_exaggeration = 1;
  double other_interval_m = 0;  // of the contours, with the next key
  bool resets = false, flying = false, timing = false, repeated = false;
  bool changed = true, uncovered = false, wants_picture = false, wants_keys = false;
  Hand hand = Hand::none;
  double x = 0, y = 0;  // of the cursor, by its events: where it is now may be later than the button
};

Session& session_of(GLFWwindow* window) { return *static_cast<Session*>(glfwGetWindowUserPointer(window)); }

struct Extent {
  double width, height;
};
/// In the units of the cursor.
Extent window_extent(const Session& s) {
  int width = 1, height = 1;
  glfwGetWindowSize(s.window, &width, &height);
  return {std::max(1.0, static_cast<double>(width)), std::max(1.0, static_cast<double>(height))};
}

/// In pixels.
Size window_pixels(GLFWwindow* window) {
  int width = 1, height = 1;
  glfwGetFramebufferSize(window, &width, &height);
  return {width, height};
}

/// Where the cursor is in the terrain's own picture.
WindowPlace cursor_place(const Session& s) {
  const Extent extent = window_extent(s);
  if (s.scene.layout != ViewLayout::side_by_side) return {s.x, s.y, extent.width, extent.height};
  const double half = extent.width / 2;
  return {s.x < half ? s.x : s.x - half, s.y, half, extent.height};
}

ViewCamera first_camera(const Session& s) {
  const Extent extent = window_extent(s);
  const double width = s.scene.layout == ViewLayout::side_by_side ? extent.width / 2 : extent.width;
  return whole_view(s.ground, s.options->look_from_deg, s.options->pitch_deg, s.options->field_of_view_deg, width / extent.height);
}

void zoom_at_centre(Session& s, double steps) {
  zoom(s.scene.camera, {0.5, 0.5, 1, 1}, steps, s.ground);
}

void exaggerate(Session& s, double ratio) { s.exaggeration = std::clamp(s.exaggeration * ratio, 0.1, 50.0); }

bool held(const Session& s, int key) { return glfwGetKey(s.window, key) == GLFW_PRESS; }
bool shift_held(const Session& s) { return held(s, GLFW_KEY_LEFT_SHIFT) || held(s, GLFW_KEY_RIGHT_SHIFT); }

void reset_view(Session& s) {
  s.sun = s.options->sun;
  s.exaggeration = s.first_exaggeration;
  s.flying = false;
  s.scene.divider = 0.5;
  s.resets = true;  // when the heights are as they will be
}

/// Keys that repeat while they are held.
bool type_step(Session& s, char key) {
  switch (key) {
    case '+': case '=': zoom_at_centre(s, 1); return true;
    case '-': case '_': zoom_at_centre(s, -1); return true;
    case '1': exaggerate(s, 1 / 1.25); return true;
    case '2': exaggerate(s, 1.25); return true;
    case ',': turn_sun(s.sun, -5, 0); return true;
    case '.': turn_sun(s.sun, 5, 0); return true;
    case ';': turn_sun(s.sun, 0, -5); return true;
    case '\'': turn_sun(s.sun, 0, 5); return true;
    case '[': s.scene.divider = clamp_divider(s.scene.divider - 0.02); return true;
    case ']': s.scene.divider = clamp_divider(s.scene.divider + 0.02); return true;
    default: return false;
  }
}

/// Keys that switch once.
bool type_switch(Session& s, char key) {
  const auto toggle = [&](DrawMode mode) { s.scene.mode = s.scene.mode == mode ? DrawMode::lit : mode; };
  switch (key) {
    case 'f': s.flying = !s.flying; return true;
    case 'r': reset_view(s); return true;
    case 'z': toggle(DrawMode::wireframe); return true;
    case 'c': toggle(DrawMode::levels); return true;
    case 'g': s.scene.style.colour = next_colour(s.scene.style.colour); return true;
    case 'k': std::swap(s.scene.style.contour_interval_m, s.other_interval_m); return true;
    case 'o': s.scene.style.drape = !s.scene.style.drape; return true;
    case 't': s.timing = !s.timing; return true;
    case 'p': s.wants_picture = true; return true;
    case 'h': case '?': s.wants_keys = true; return true;
    case 'q':
      // In flight it is the way down.
      if (!s.flying) glfwSetWindowShouldClose(s.window, GLFW_TRUE);
      return true;
    default: return false;
  }
}

void on_char(GLFWwindow* window, unsigned code) {
  Session& s = session_of(window);
  if (code > 126) return;
  const char key = code >= 'A' && code <= 'Z' ? static_cast<char>(code - 'A' + 'a') : static_cast<char>(code);
  if (type_step(s, key) || (!s.repeated && type_switch(s, key))) s.changed = true;
}

void on_key(GLFWwindow* window, int key, int, int action, int) {
  Session& s = session_of(window);
  s.repeated = action == GLFW_REPEAT;
  if (action == GLFW_RELEASE) return;
  // 15 degrees.
  constexpr double turn = 1.0 / 12;
  switch (key) {
    case GLFW_KEY_LEFT: orbit(s.scene.camera, -turn, 0, 1, s.ground); break;
    case GLFW_KEY_RIGHT: orbit(s.scene.camera, turn, 0, 1, s.ground); break;
    case GLFW_KEY_UP: orbit(s.scene.camera, 0, turn / 3, 1, s.ground); break;
    case GLFW_KEY_DOWN: orbit(s.scene.camera, 0, -turn / 3, 1, s.ground); break;
    case GLFW_KEY_PAGE_UP: exaggerate(s, 1.25); break;
    case GLFW_KEY_PAGE_DOWN: exaggerate(s, 1 / 1.25); break;
    case GLFW_KEY_F12: s.wants_picture |= !s.repeated; break;
    case GLFW_KEY_ESCAPE: glfwSetWindowShouldClose(window, GLFW_TRUE); break;
    case GLFW_KEY_TAB:
      if (s.terrains.second != nullptr && !s.repeated) s.scene.layout = next_layout(s.scene.layout);
      break;
    default: return;
  }
  s.changed = true;
}

void on_button(GLFWwindow* window, int button, int action, int mods) {
  Session& s = session_of(window);
  s.hand = Hand::none;
  if (action != GLFW_PRESS) return;
  const bool both = s.terrains.second != nullptr && s.scene.layout == ViewLayout::swipe;
  if (button != GLFW_MOUSE_BUTTON_LEFT) s.hand = Hand::pan;
  else if (both && std::abs(s.x - s.scene.divider * window_extent(s).width) < 8) s.hand = Hand::divider;
  else s.hand = (mods & GLFW_MOD_SHIFT) != 0 && !s.flying ? Hand::pan : Hand::turn;
}

void on_cursor(GLFWwindow* window, double x, double y) {
  Session& s = session_of(window);
  const double dx = x - s.x, dy = y - s.y;
  s.x = x;
  s.y = y;
  if (s.hand == Hand::none || (dx == 0 && dy == 0)) return;
  const Extent extent = window_extent(s);
  if (s.hand == Hand::divider) s.scene.divider = clamp_divider(x / extent.width);
  else if (held(s, GLFW_KEY_L)) turn_sun(s.sun, 360 * dx / extent.width, -90 * dy / extent.height);
  else if (s.hand == Hand::pan) pan(s.scene.camera, dx, dy, extent.height, s.ground);
  else if (s.flying) look(s.scene.camera, dx, dy, extent.height);
  else orbit(s.scene.camera, dx, dy, extent.height, s.ground);
  s.changed = true;
}

void on_scroll(GLFWwindow* window, double, double steps) {
  Session& s = session_of(window);
  zoom(s.scene.camera, cursor_place(s), steps, s.ground);
  s.changed = true;
}

void on_resize(GLFWwindow* window, int, int) { session_of(window).changed = true; }
void on_refresh(GLFWwindow* window) { session_of(window).uncovered = true; }

/// Moves by the keys that are held; false where none is.
bool fly_on(Session& s, double seconds) {
  if (!s.flying) return false;
  const auto axis = [&](int more, int less) { return static_cast<double>(held(s, more)) - static_cast<double>(held(s, less)); };
  const double ahead = axis(GLFW_KEY_W, GLFW_KEY_S), right = axis(GLFW_KEY_D, GLFW_KEY_A), up = axis(GLFW_KEY_E, GLFW_KEY_Q);
  if (ahead == 0 && right == 0 && up == 0) return false;
  const double metres = flight_speed(s.scene.camera, s.ground) * (shift_held(s) ? 4 : 1) * std::min(seconds, 0.25);
  fly(s.scene.camera, ahead * metres, right * metres, up * metres, s.ground);
  s.changed = true;
  return true;
}

/// Brings the terrains to the sun and exaggeration that were asked for; false where they are.
bool relight_terrains(Session& s) {
  const bool heights = s.exaggeration != s.lit_exaggeration;
  if (!heights && s.sun.azimuth_deg == s.lit_sun.azimuth_deg && s.sun.elevation_deg == s.lit_sun.elevation_deg) return false;
  for (SceneRenderer* terrain : {s.terrains.first, s.terrains.second})
    if (terrain != nullptr) terrain->relight(s.exaggeration, s.sun.azimuth_deg, s.sun.elevation_deg);
  if (heights) stretch(s.scene.camera, s.exaggeration / s.lit_exaggeration);
  s.ground.box = s.terrains.first->box();
  s.lit_exaggeration = s.exaggeration;
  s.lit_sun = s.sun;
  return true;
}

void set_title(const Session& s, const Frame& picture, double seconds) {
  char text[160] = "";
  if (s.timing)
    std::snprintf(text, sizeof text, " - %.1f ms, %lld triangles in %lld patches, %lld x %lld pixels", 1000 * seconds,
                  static_cast<long long>(picture.triangles), static_cast<long long>(picture.patches), static_cast<long long>(picture.size.width),
                  static_cast<long long>(picture.size.height));
  glfwSetWindowTitle(s.window, (s.options->title + text).c_str());
}

/// What the frames that are kept were drawn for.
bool same_frames(const ViewedScene& a, const ViewedScene& b) {
  return a.camera.target == b.camera.target && a.camera.azimuth_deg == b.camera.azimuth_deg && a.camera.pitch_deg == b.camera.pitch_deg &&
         a.camera.distance_m == b.camera.distance_m && a.mode == b.mode && a.style == b.style && a.layout == b.layout;
}

class Loop {
 public:
  explicit Loop(Session& s) : s_(s), screen_(s.window), start_(now_s()), last_(start_) {}

  WindowReport run() {
    while (!glfwWindowShouldClose(s_.window) && !over()) {
      wait();
      const double now = now_s();
      moving_ = fly_on(s_, now - last_);
      last_ = now;
      if (s_.wants_keys) s_.options->say(window_keys());
      s_.wants_keys = false;
      if (s_.changed) draw(coarse_);
      else if (drawn_coarse_ > 1 && now - changed_at_ >= settle_s) draw(1);
      else if (s_.uncovered) screen_.show(shown_, window_pixels(s_.window));
      s_.changed = s_.uncovered = false;
      if (s_.wants_picture) save();
    }
    return report_;
  }

 private:
  bool over() const { return s_.options->close_after_s > 0 && now_s() - start_ >= s_.options->close_after_s; }

  void wait() const {
    if (s_.changed || moving_) return glfwPollEvents();
    double seconds = INFINITY;
    if (drawn_coarse_ > 1) seconds = settle_s - (now_s() - changed_at_);
    if (s_.options->close_after_s > 0) seconds = std::min(seconds, s_.options->close_after_s - (now_s() - start_));
    if (std::isinf(seconds)) glfwWaitEvents();
    else glfwWaitEventsTimeout(std::max(seconds, 1e-3));
  }

  Size pixels(int coarse) const {
    const Size window = window_pixels(s_.window);
    return {(window.width + coarse - 1) / coarse, (window.height + coarse - 1) / coarse};
  }

  void draw(int coarse) {
    if (pixels(1).cells() == 0) return;  // an icon
    const double before = now_s();
    const bool relit = relight_terrains(s_);
    if (s_.resets) s_.scene.camera = first_camera(s_);
    s_.resets = false;
    // The divider and the title change over frames that are there.
    const bool kept = !relit && drawn_coarse_ <= coarse && shown_.size == pixels(drawn_coarse_) && same_frames(s_.scene, drawn_);
    if (kept) coarse = drawn_coarse_;
    const Size size = pixels(coarse);
    if (!kept) frames_ = draw_terrains(s_.terrains, s_.scene, size), ++report_.frames;
    drawn_ = s_.scene;
    shown_ = compose_view(frames_, s_.scene, size, line_px(coarse));
    screen_.show(shown_, window_pixels(s_.window));
    const double after = now_s();
    if (!kept) {
      // A picture of all pixels would take about coarse^2 times as long.
      coarse_ = std::clamp(static_cast<int>(std::ceil(coarse * std::sqrt((after - before) / wanted_s))), 1, coarsest);
      drawn_coarse_ = coarse;
      drawn_s_ = after - before;
    }
    if (coarse > 1 || s_.changed) changed_at_ = after;
    set_title(s_, shown_, drawn_s_);
  }

  std::int64_t line_px(int coarse) const {
    const double scale = static_cast<double>(window_pixels(s_.window).width) / window_extent(s_).width;
    return std::max<std::int64_t>(1, std::llround(2 * scale / coarse));
  }

  void save() {
    s_.wants_picture = false;
    if (drawn_coarse_ > 1) draw(1);
    s_.options->save(shown_);
    ++report_.pictures;
  }

  Session& s_;
  Screen screen_;
  double start_, last_, changed_at_ = 0, drawn_s_ = 0;
  bool moving_ = false;
  int coarse_ = 1, drawn_coarse_ = 1;
  std::array<std::optional<Frame>, 2> frames_;
  ViewedScene drawn_;
  Frame shown_;
  WindowReport report_;
};

/// Ends what glfwInit began.
struct GlfwSystem {
  GlfwSystem() {
    if (glfwInit() == GLFW_FALSE) fail_without_window();
  }
  ~GlfwSystem() { glfwTerminate(); }
};

GLFWwindow* open_window(const WindowOptions& options) {
  // EGL, as the renderer: one thread cannot have contexts of both EGL and GLX.
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  GLFWwindow* window = glfwCreateWindow(static_cast<int>(options.size.width), static_cast<int>(options.size.height), options.title.c_str(), nullptr, nullptr);
  if (window == nullptr) fail_without_window();
  glfwSetWindowSizeLimits(window, 64, 64, 16384, 16384);
  return window;
}

void listen(GLFWwindow* window, Session& session) {
  glfwSetWindowUserPointer(window, &session);
  glfwSetCharCallback(window, on_char);
  glfwSetKeyCallback(window, on_key);
  glfwSetMouseButtonCallback(window, on_button);
  glfwSetCursorPosCallback(window, on_cursor);
  glfwSetScrollCallback(window, on_scroll);
  glfwSetFramebufferSizeCallback(window, on_resize);
  glfwSetWindowRefreshCallback(window, on_refresh);
}

}  // namespace

std::string window_keys() {
  return "left drag, arrow keys   turn (in flight: left drag looks round)\n"
         "right or middle drag    pan; shift and left drag too\n"
         "wheel, + -              zoom, the wheel towards the cursor\n"
         "F                       fly, and back: W A S D move, E up, Q down, shift faster\n"
         "R                       the first view, sun and exaggeration\n"
         "1 2, PageDown PageUp    exaggerate heights less, more\n"
         "L and drag, , .  ; '    move the sun: azimuth, height\n"
         "Z  C                    sides of triangles; colours of levels of detail (of a DEM)\n"
         "G  K  O                 colours of heights, slopes, aspects; contours; the raster that is draped over them\n"
         "Tab  [ ]                two terrains: side by side, swipe, first, second; move the divider (or drag it)\n"
         "T                       time and triangles of a picture, in the title\n"
         "P, F12                  save the picture\n"
         "H, ?                    print this\n"
         "Esc, Q                  close (in flight Q goes down)\n";
}

void require_display() { const GlfwSystem system; }

WindowReport run_terrain_window(const ViewedTerrains& terrains, const WindowOptions& options) {
  const GlfwSystem system;
  Session session;
  session.window = open_window(options);
  session.terrains = terrains;
  session.options = &options;
  session.ground = {terrains.first->box(), [&terrains](double x, double y) { return terrains.first->ground_height(x, y); }};
  session.exaggeration = session.lit_exaggeration = session.first_exaggeration = terrains.first->facts().exaggeration;
  session.sun = session.lit_sun = options.sun;
  session.scene.layout = terrains.second == nullptr ? ViewLayout::first : ViewLayout::swipe;
  session.scene.style = terrains.first->style();
  if (session.scene.style.contour_interval_m == 0) session.other_interval_m = contour_interval(terrains.first->facts().high_m - terrains.first->facts().low_m);
  session.scene.camera = first_camera(session);
  if (terrains.second != nullptr) terrains.second->relight(session.exaggeration, options.sun.azimuth_deg, options.sun.elevation_deg);
  glfwGetCursorPos(session.window, &session.x, &session.y);
  listen(session.window, session);
  Loop loop(session);
  return loop.run();
}

}  // namespace arete
