// What is seen at the samples of a pixel, coloured once per surface: samples that show the same surface at about the same depth share one colour. Follows
// light.glsl; the file that includes it says what surfaces look like.
uniform usampler2DMS seen;       // number of a surface, 0 for the sky; the highest bit for lines
uniform sampler2DMS depths;      // near / distance ahead
uniform vec4 offsets_x;          // of the samples from the middle of a pixel
uniform vec4 offsets_y;
uniform vec2 pixel;              // in clip coordinates
uniform mat4 to_ray;             // from clip coordinates to a direction, 1 long ahead
uniform float near;
uniform int mode;                // 0: lit, 1: colours of levels, 2: covered

layout(location = 0) out vec4 colour;

const uint line_mark = 0x80000000u;

bool is_floor(uint number);
vec3 surface_colour(uint number, vec3 from_eye, float ahead);

vec3 seen_colour(uint number, vec3 ray, float depth) {
  if (number == 0u) return sky_colour(ray);
  vec3 from_eye = ray * (near / depth);
  bool line = (number & line_mark) != 0u;
  number &= ~line_mark;
  if (line && !is_floor(number)) return line_colour;
  return hazy(surface_colour(number, from_eye, near / depth), from_eye);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uvec4 numbers = uvec4(texelFetch(seen, at, 0).r, texelFetch(seen, at, 1).r, texelFetch(seen, at, 2).r, texelFetch(seen, at, 3).r);
  if (mode == 2) {
    colour = vec4(numbers.x != 0u && !is_floor(numbers.x) ? 1.0 : 0.0);
    return;
  }
  vec4 depth = vec4(texelFetch(depths, at, 0).r, texelFetch(depths, at, 1).r, texelFetch(depths, at, 2).r, texelFetch(depths, at, 3).r);
  vec3 sum = vec3(0.0);
  vec4 left = vec4(1.0);  // samples that have no colour yet
  do {
    uint number = left.x > 0.0 ? numbers.x : left.y > 0.0 ? numbers.y : left.z > 0.0 ? numbers.z : numbers.w;
    float first = left.x > 0.0 ? depth.x : left.y > 0.0 ? depth.y : left.z > 0.0 ? depth.z : depth.w;
    vec4 alike = left * vec4(equal(numbers, uvec4(number))) * vec4(lessThanEqual(abs(depth - first), vec4(0.02 * first)));
    left -= alike;
    float count = dot(alike, vec4(1.0));
    vec2 clip = (gl_FragCoord.xy + vec2(dot(alike, offsets_x), dot(alike, offsets_y)) / count) * pixel - 1.0;
    sum += count * seen_colour(number, (to_ray * vec4(clip, 0.0, 1.0)).xyz, dot(alike, depth) / count);
  } while (dot(left, vec4(1.0)) > 0.0);
  colour = vec4(0.25 * sum, 1.0);
}
