#version 450 core
uniform sampler2DArray tiles;
uniform sampler2D light;       // sky, sun, over the whole terrain
uniform vec2 light_scale;      // texture coordinate = (sample + 0.5) * light_scale
uniform sampler1D ramp;        // colours of heights, linear
uniform vec2 ramp_range;       // lowest height and 1 / span
uniform vec2 cell;
uniform float exaggeration;
uniform vec3 to_sun;           // east, north, up
uniform vec3 water_colour;     // linear
uniform vec3 haze_colour;
uniform float haze;            // per metre
uniform float haze_from;       // metres from the eye
uniform bool rolls_off;        // highlights do
uniform int mode;              // 0: lit, 1: colours of levels, 2: covered, 3: lines

in vec3 from_eye;
in vec2 texel;
in float depth_below;
flat in ivec4 tile;
in vec3 sample_height;
layout(location = 0) out vec4 colour;

const vec3 wall_colour = vec3(0.60, 0.56, 0.515), floor_colour = vec3(0.115, 0.112, 0.118);

vec4 tile_at(vec2 at) { return texture(tiles, vec3((at + 1.5) / 67.0, float(tile.y))); }

const vec3 sun_light = vec3(1.12, 1.04, 0.91), sky_light = vec3(0.225, 0.265, 0.345), bounce = vec3(0.05, 0.043, 0.034);

vec3 lit(vec3 albedo, vec3 normal, vec2 seen) {
  float direct = max(dot(normal, to_sun), 0.0) * seen.y;
  float open = seen.x * (0.5 + 0.5 * normal.z);
  return albedo * (sun_light * direct + sky_light * open + bounce * (1.0 - 0.5 * normal.z));
}

// Highlights roll off instead of clipping.
vec3 roll_off(vec3 c) { return mix(c, 0.7 + 0.3 * (1.0 - exp(-(c - 0.7) / 0.3)), step(0.7, c)); }

void main() {
  vec4 here = tile_at(texel);
  if (tile.z == 5 ? mode == 2 || mode == 3 : here.b < 0.5) discard;
  if (mode == 2) {
    colour = vec4(1.0);
    return;
  }
  if (mode == 3) {
    colour = vec4(0.02, 0.03, 0.05, 1.0);
    return;
  }
  vec2 spacing = cell * float(1 << tile.x);
  vec2 slope = vec2(tile_at(texel + vec2(1, 0)).g - tile_at(texel - vec2(1, 0)).g, tile_at(texel - vec2(0, 1)).g - tile_at(texel + vec2(0, 1)).g) /
               (2.0 * spacing) * exaggeration;
  vec3 normal = normalize(vec3(-slope, 1.0));
  vec2 seen = texture(light, (sample_height.xy + 0.5) * light_scale).rg;
  vec3 shade;
  if (tile.z == 5) {
    shade = floor_colour;
  } else if (tile.z > 0) {
    vec3 face = tile.z == 1 ? vec3(-1, 0, 0) : tile.z == 2 ? vec3(0, 1, 0) : tile.z == 3 ? vec3(1, 0, 0) : vec3(0, -1, 0);
    shade = wall_colour * (0.52 + 0.3 * max(dot(face, to_sun), 0.0) + 0.06 * face.y) * mix(1.0, 0.85, depth_below);
  } else if (mode == 1) {
    vec3 hue = 0.5 + 0.5 * cos(6.2832 * (float(tile.x) * 0.381966 + vec3(0.0, 0.33, 0.67)));
    shade = lit(mix(vec3(0.75), hue, 0.6), normal, seen);
  } else {
    vec3 land = texture(ramp, (here.g - ramp_range.x) * ramp_range.y).rgb;
    shade = lit(land, normal, seen);
    float wet = smoothstep(0.35, 0.65, here.a);
    float grazing = pow(1.0 - clamp(-normalize(from_eye).z, 0.0, 1.0), 4.0);
    vec3 water = mix(lit(water_colour, vec3(0, 0, 1), vec2(1.0)), haze_colour, 0.5 * grazing);
    shade = mix(shade, water, wet);
  }
  if (rolls_off) shade = roll_off(shade);
  // Blue is scattered more than red.
  vec3 clear = exp(-max(length(from_eye) - haze_from, 0.0) * haze * vec3(0.85, 1.0, 1.2));
  colour = vec4(mix(haze_colour, shade, clear), 1.0);
}
