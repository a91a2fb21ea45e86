// How a scene is lit, and the air before it.
uniform sampler2D light;         // sky, sun, over the whole terrain
uniform vec3 to_sun;             // east, north, up
uniform vec3 water_colour;       // linear
uniform vec3 haze_colour;
uniform vec3 zenith_colour;
uniform vec3 below_colour;
uniform float haze;              // per metre
uniform float haze_from;         // metres from the eye
uniform bool rolls_off;

const vec3 wall_colour = vec3(0.60, 0.56, 0.515), floor_colour = vec3(0.115, 0.112, 0.118), line_colour = vec3(0.02, 0.03, 0.05);
const vec3 sun_light = vec3(1.12, 1.04, 0.91), sky_light = vec3(0.225, 0.265, 0.345), bounce = vec3(0.05, 0.043, 0.034);

vec3 lit(vec3 albedo, vec3 normal, vec2 open) {
  float direct = max(dot(normal, to_sun), 0.0) * open.y;
  float sky = open.x * (0.5 + 0.5 * normal.z);
  return albedo * (sun_light * direct + sky_light * sky + bounce * (1.0 - 0.5 * normal.z));
}

// A wall that looks that way; depth_below: 0 at the ground, 1 at its foot.
vec3 lit_wall(vec3 face, float depth_below) {
  return wall_colour * (0.52 + 0.3 * max(dot(face, to_sun), 0.0) + 0.06 * face.y) * mix(1.0, 0.85, depth_below);
}

// Highlights roll off instead of clipping, where the picture is for the eye.
vec3 roll_off(vec3 c) { return !rolls_off ? c : mix(c, 0.7 + 0.3 * (1.0 - exp(-(c - 0.7) / 0.3)), step(0.7, c)); }

vec3 sky_colour(vec3 ray) {
  float up = normalize(ray).z;
  vec3 above = mix(haze_colour, zenith_colour, 1.0 - exp(-3.0 * max(up, 0.0)));
  return mix(above, below_colour, smoothstep(0.0, 1.0, -up * 1.2));
}

// What is left of a colour behind so much air. Blue is scattered more than red.
vec3 hazy(vec3 shade, vec3 from_eye) {
  vec3 clear = exp(-max(length(from_eye) - haze_from, 0.0) * haze * vec3(0.85, 1.0, 1.2));
  return mix(haze_colour, shade, clear);
}
