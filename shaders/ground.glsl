// How ground is coloured: by heights, slopes or aspects, with contours and a picture over it. Follows light.glsl and samples.glsl.
// PLAIN: by heights alone. Software drivers run what a uniform turns off, and throw it away.
uniform sampler1DArray ramps;     // colours of heights, slopes and aspects, linear
uniform vec2 ramp_range;         // lowest height and 1 / span
uniform int coloured;            // 0: heights, 1: slopes, 2: aspects
uniform float slope_scale;       // 1 / degrees of the end of the colours of slopes
uniform vec2 facing;             // shares of that end: grey below, all of the colour of aspects above
uniform vec3 flat_colour;
uniform float contours;          // 1 / interval in metres; 0: none
uniform float line_px;           // pixels aside that make one of the picture
uniform bool draped;             // a picture lies over the ground
uniform sampler2D drape;         // colours times opacity, opacity; an atlas of levels (picture_atlas.h)
uniform float drape_rows[15];    // where they begin
uniform int drape_last;          // level
uniform vec2 drape_size;         // of level 0
uniform vec2 drape_corner;       // column and row of the DEM where it begins
uniform vec2 drape_scale;        // pixels per column and row
uniform vec2 drape_cell;         // metres of a column and a row

const vec3 line_ink = vec3(0.055, 0.024, 0.012);
const float line_opacity = 0.75;

// Slope: rise per metre to the east and to the north, without exaggeration.
vec3 land_colour(float height, vec2 slope) {
#ifdef PLAIN
  return textureLod(ramps, vec2((height - ramp_range.x) * ramp_range.y, 0.0), 0.0).rgb;
#else
  if (coloured == 0) return textureLod(ramps, vec2((height - ramp_range.x) * ramp_range.y, 0.0), 0.0).rgb;
  float steep = degrees(atan(length(slope))) * slope_scale;
  if (coloured == 1) return textureLod(ramps, vec2(steep, 1.0), 0.0).rgb;
  float turn = slope == vec2(0.0) ? 0.0 : atan(-slope.x, -slope.y) / radians(360.0);  // downhill, clockwise from north
  return mix(flat_colour, textureLod(ramps, vec2(fract(turn), 2.0), 0.0).rgb, smoothstep(facing.x, facing.y, steep));
#endif
}

// How far away on the plane through a point of the ground the pixels to the right and above see it: east, north. `ahead`: how far ahead the point is.
mat2 pixel_steps(vec3 from_eye, float ahead, vec3 normal) {
  vec3 right = (to_ray * vec4(pixel.x, 0.0, 0.0, 0.0)).xyz * ahead, above = (to_ray * vec4(0.0, pixel.y, 0.0, 0.0)).xyz * ahead;
  float facing_eye = min(dot(normal, from_eye), -0.01 * length(from_eye));
  return mat2((right - from_eye * (dot(normal, right) / facing_eye)).xy, (above - from_eye * (dot(normal, above) / facing_eye)).xy);
}

// How much of a pixel a contour covers where the level, 1 from line to line, changes so much from pixel to pixel of the picture.
float line_share(float level, float change, float width_px) {
  float apart = abs(level - round(level)) / max(change, 1e-9);
  return clamp((0.5 * width_px - apart) * line_px + 0.5, 0.0, 1.0) * (1.0 - smoothstep(0.2, 0.4, change));
}

// Dark lines at the multiples of the interval, every fifth thicker. A little aside: else ground that is level at just a multiple has a line all over it.
vec3 add_contours(vec3 shade, float height, vec2 slope, mat2 steps) {
  float level = height * contours + 1.0 / 1024.0, change = length(slope * steps) * contours * line_px;
  return mix(shade, line_ink, line_opacity * max(line_share(level, change, 1.0), line_share(0.2 * level, 0.2 * change, 1.9)));
}

vec4 drape_level(vec2 place, int level) {
  vec2 at = clamp(place * exp2(-float(level)), vec2(0.5), ceil(drape_size * exp2(-float(level))) - 0.5);
  at += vec2(level > 0 ? drape_size.x : 0.0, drape_rows[level]);
  return textureLod(drape, at / vec2(textureSize(drape, 0)), 0.0);
}

// Trilinear, several times along the longer side of what the pixel sees.
vec4 drape_colour(vec2 place, mat2 steps) {
  float a = length(steps[0]), b = length(steps[1]), longer = max(a, b), shorter = max(min(a, b), 1e-6);
  float count = clamp(ceil(longer / shorter - 0.01), 1.0, 6.0);
  float level = clamp(log2(max(longer / count, 1e-6)), 0.0, float(drape_last));
  vec2 along = (a > b ? steps[0] : steps[1]) / count;
  vec4 sum = vec4(0.0);
  for (float i = 0.5 - 0.5 * count; i < 0.5 * count; i += 1.0)
    sum += mix(drape_level(place + i * along, int(level)), drape_level(place + i * along, min(int(level) + 1, drape_last)), fract(level));
  return sum / count;
}

// The picture that lies over the ground, lightly lit: it has a light of its own.
vec3 add_drape(vec3 shade, vec2 at, vec3 normal, vec2 open, mat2 steps) {
  vec2 place = (at - drape_corner) * drape_scale;
  if (clamp(place, vec2(0.0), drape_size) != place) return shade;
  vec2 to_pixels = vec2(1.0, -1.0) / drape_cell * drape_scale;
  vec4 picture = drape_colour(place, mat2(steps[0] * to_pixels, steps[1] * to_pixels));
  vec3 light_here = lit(vec3(1.0), normal, open) / lit(vec3(1.0), vec3(0, 0, 1), vec2(1.0));
  return picture.rgb * mix(vec3(1.0), light_here, 0.5) + shade * (1.0 - picture.a);
}

// The land under a sky: `open` says how much of it is seen, and of the sun.
vec3 land_shade(float height, vec2 slope, vec3 normal, vec2 open) {
  vec3 land = land_colour(height, slope), shade = lit(land, normal, open);
  // Slopes and aspects are told by the colours: the light tells less.
#ifndef PLAIN
  if (coloured != 0) shade = mix(shade, lit(land, vec3(0, 0, 1), vec2(1.0)), 0.4);
#endif
  return shade;
}

vec3 water_shade(vec3 from_eye) {
  float grazing = 1.0 + clamp(from_eye.z * inversesqrt(dot(from_eye, from_eye)), -1.0, 0.0);
  grazing *= grazing;
  grazing *= grazing;
  return mix(lit(water_colour, vec3(0, 0, 1), vec2(1.0)), haze_colour, 0.5 * grazing);
}

// What lies over the ground at a column and row: the picture, and contours but for water.
vec3 add_marks(vec3 shade, float height, vec2 slope, vec3 normal, vec2 open, vec2 at, float wet, vec3 from_eye, float ahead) {
#ifndef PLAIN
  if (!draped && contours == 0.0) return shade;
  mat2 steps = pixel_steps(from_eye, ahead, normal);
  if (draped) shade = add_drape(shade, at, normal, open, steps);
  if (contours > 0.0) shade = mix(add_contours(shade, height, slope, steps), shade, wet);
#endif
  return shade;
}
