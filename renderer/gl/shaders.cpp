// The shaders. Light, fog and colours are worked out for vertices: on a software rasteriser a pixel
// must cost a handful of operations. (`noperspective` would save some more, but Mesa 22.3 leaves
// holes where it clips such triangles behind the eye.)
#include "renderer/gl/shaders.h"

namespace aureole::render {
namespace {

// One light set-up for all programs. Colours are worked with as sRGB values: cheap, and what was
// tuned.
const char* const common = R"(#version 420 core
layout(std140) uniform Frame {
  mat4 view_projection;
  float ground_height, pixels_per_unit, fog_density, unused_frame;
  vec4 grid_origin;
  vec4 ground_colour;
};
const vec3 sun = vec3(0.497, 0.796, 0.348);
const vec3 sun_colour = vec3(0.60, 0.53, 0.42);
const vec3 sky_light = vec3(0.66, 0.70, 0.78);
const vec3 bounce_light = vec3(0.53, 0.48, 0.44);
const vec3 zenith_colour = vec3(0.30, 0.56, 0.86);
const vec3 horizon_colour = vec3(0.90, 0.91, 0.90);
const vec3 glow_colour = vec3(1.00, 0.88, 0.70);

vec3 sky_colour(vec3 direction) {
  float up = max(direction.y, 0.0);
  vec3 colour = mix(horizon_colour, zenith_colour, 1.0 - exp(-2.9 * up));
  float towards_sun = max(dot(direction, sun), 0.0);
  float glow = towards_sun * towards_sun;
  return mix(colour, glow_colour, 0.55 * glow * glow + 0.2 * glow * exp(-6.0 * up));
}
// Far things take the colour of the sky behind them, at the horizon.
vec3 fog_colour(vec3 position) {
  return sky_colour(normalize(vec3(position.x, 0.0, position.z) + vec3(1e-4, 0.0, 0.0)));
}
float fog_amount(vec3 position) {
  float depth = fog_density * fog_density * dot(position, position);
  return 1.0 - exp(-depth);
}
vec3 rotate(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
vec3 light_on(vec3 normal, vec3 position) {
  vec3 light = mix(bounce_light, sky_light, 0.5 + 0.5 * normal.y);
  light += sun_colour * max(dot(normal, sun), 0.0);
  // Near the ground less of the sky is seen: it ties bodies to what they stand on.
  light *= 0.78 + 0.22 * clamp((position.y - ground_height) * 1.6, 0.0, 1.0);
  float facing = 1.0 - max(dot(normal, -normalize(position)), 0.0);
  return light + sky_light * (0.22 * facing * facing * facing);
}
)";

const char* const body_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal_and_tone;
layout(location = 2) in vec4 mark;
layout(location = 3) in vec3 body_position;
layout(location = 4) in vec4 body_orientation;
layout(location = 5) in vec4 body_colour;
out vec3 plain_colour;
out vec3 mark_colour;
out vec2 mark_place;
flat out vec2 mark_limits;
void main() {
  vec3 p = body_position + rotate(body_orientation, position);
  vec3 normal = rotate(body_orientation, normal_and_tone.xyz);
  float tone = normal_and_tone.w;
  vec3 light = light_on(normal, p);
  vec3 marked = mix(body_colour.rgb, vec3(step(0.0, tone) * 0.96), abs(tone));
  vec3 fog = fog_colour(p);
  float amount = fog_amount(p);
  plain_colour = mix(body_colour.rgb * light, fog, amount);
  mark_colour = mix(marked * light, fog, amount);
  mark_place = mark.xy;
  mark_limits = mark.zw;
  gl_Position = view_projection * vec4(p, 1.0);
}
)";
const char* const body_fragment = R"(
in vec3 plain_colour;
in vec3 mark_colour;
in vec2 mark_place;
flat in vec2 mark_limits;
out vec4 colour;
void main() {
  vec2 over = abs(mark_place) - mark_limits;
  float inside = max(over.x, over.y);
  // One pixel wide: neither jagged near nor shimmering far away. gl_FragCoord.w is 1 / depth, so this is
  // the distance in pixels of a surface that faces the eye, and no derivatives are needed.
  float m = clamp(inside * pixels_per_unit * gl_FragCoord.w + 0.5, 0.0, 1.0);
  colour = vec4(mix(plain_colour, mark_colour, m), 1.0);
}
)";

const char* const point_vertex = R"(
layout(location = 0) in vec3 body_position;
layout(location = 1) in vec4 body_orientation;
layout(location = 2) in vec4 body_colour;
uniform vec2 radius_and_lightness;
out vec3 upper_colour;
out vec3 lower_colour;
void main() {
  vec3 p = body_position;
  float lightness = radius_and_lightness.y;
  vec3 albedo = mix(body_colour.rgb, vec3(step(0.0, lightness)), abs(lightness));
  // Lit as a ball seen from the eye's side would be, above and below its middle.
  vec3 to_eye = -normalize(p);
  vec3 fog = fog_colour(p);
  float amount = fog_amount(p);
  upper_colour = mix(albedo * light_on(normalize(to_eye + vec3(0.0, 1.0, 0.0)), p), fog, amount);
  lower_colour = mix(albedo * light_on(normalize(to_eye - vec3(0.0, 0.8, 0.0)), p), fog, amount);
  gl_Position = view_projection * vec4(p, 1.0);
  gl_PointSize = max(1.0, 2.0 * radius_and_lightness.x * pixels_per_unit / gl_Position.w);
}
)";
const char* const point_fragment = R"(
in vec3 upper_colour;
in vec3 lower_colour;
out vec4 colour;
void main() {
  vec2 at = gl_PointCoord - 0.5;
  // Slightly more than the inscribed disc, or the smallest points would lose their corners.
  if (dot(at, at) > 0.27) discard;
  colour = vec4(mix(upper_colour, lower_colour, gl_PointCoord.y), 1.0);
}
)";

const char* const ground_vertex = R"(
layout(location = 0) in vec2 ring;
out vec2 place;
out vec4 base_colour_and_clearness;
void main() {
  vec3 p = vec3(ring.x, ground_height, ring.y);
  vec3 fog = fog_colour(p);
  float amount = fog_amount(p);
  vec3 lit = ground_colour.rgb * light_on(vec3(0.0, 1.0, 0.0), p) * 1.12;
  base_colour_and_clearness = vec4(mix(lit, fog, amount), 1.0 - amount);
  place = ring + grid_origin.xy;
  gl_Position = view_projection * vec4(p, 1.0);
}
)";
const char* const ground_fragment = R"(
in vec2 place;
in vec4 base_colour_and_clearness;
out vec4 colour;
void main() {
  vec2 per_pixel = 1.0 / max(fwidth(place), vec2(1e-4));
  // Distances to the nearest lines of one and of ten metres. Thinner than a pixel, a line keeps its
  // light by getting fainter: the second factor.
  vec2 to_fine = abs(fract(place - 0.5) - 0.5);
  vec2 to_coarse = abs(fract(place * 0.1 - 0.5) * 10.0 - 5.0);
  vec2 fine = clamp((0.014 - to_fine) * per_pixel + 0.5, 0.0, 1.0) * min(per_pixel * 0.028, 1.0);
  vec2 coarse = clamp((0.042 - to_coarse) * per_pixel + 0.5, 0.0, 1.0) * min(per_pixel * 0.084, 1.0);
  float line = max(max(fine.x, fine.y) * 0.42, max(coarse.x, coarse.y));
  vec3 lightening = (vec3(0.96, 0.97, 0.94) - ground_colour.rgb * 1.2) * 0.62;
  colour = vec4(base_colour_and_clearness.rgb + lightening * (line * base_colour_and_clearness.w), 1.0);
}
)";

const char* const shadow_vertex = R"(
layout(location = 0) in vec4 centre_and_strength;
layout(location = 1) in vec4 axis_u_and_shear;
layout(location = 2) in vec4 axis_v_and_scale_u;
layout(location = 3) in vec4 bounds;
layout(location = 4) in float scale_v;
out vec3 circle_and_strength;
void main() {
  float u = (gl_VertexID & 1) == 0 ? bounds.x : bounds.y;
  float v = (gl_VertexID & 2) == 0 ? bounds.z : bounds.w;
  vec3 p = centre_and_strength.xyz + axis_u_and_shear.xyz * u + axis_v_and_scale_u.xyz * v;
  circle_and_strength = vec3(u * axis_v_and_scale_u.w, u * axis_u_and_shear.w + v * scale_v,
                             centre_and_strength.w * (1.0 - fog_amount(p)));
  gl_Position = view_projection * vec4(p, 1.0);
}
)";
const char* const shadow_fragment = R"(
in vec3 circle_and_strength;
out vec4 colour;
void main() {
  float inside = max(1.0 - dot(circle_and_strength.xy, circle_and_strength.xy), 0.0);
  colour = vec4(0.10, 0.13, 0.24, circle_and_strength.z * inside * (2.0 - inside) * inside);
}
)";

const char* const sky_vertex = R"(
layout(location = 0) in vec3 direction;
out vec3 sky;
void main() {
  sky = sky_colour(direction);
  vec4 p = view_projection * vec4(direction * 10.0, 1.0);
  // Drawn first and without a depth test: any depth inside the view will do.
  gl_Position = vec4(p.xy, 0.0, p.w);
}
)";
const char* const sky_fragment = R"(
in vec3 sky;
out vec4 colour;
void main() { colour = vec4(sky, 1.0); }
)";

const char* const wall_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in float height;
out vec3 relative;
out float up;
void main() {
  relative = position;
  up = height;
  gl_Position = view_projection * vec4(position, 1.0);
}
)";
const char* const wall_fragment = R"(
in vec3 relative;
in float up;
out vec4 colour;
void main() {
  float far = min(fog_density * fog_density * dot(relative, relative), 1.0);
  float fade = (1.0 - up) * (1.0 - up);
  float foot = clamp(1.0 - up * 14.0, 0.0, 1.0);
  colour = vec4(mix(vec3(0.36, 0.42, 0.98), vec3(0.75, 0.55, 1.0), up) + 0.25 * foot,
                (0.34 * fade + 0.5 * foot) * (1.0 - far));
}
)";

ShaderPair pair(const char* vertex, const char* fragment) {
  return {std::string(common) + vertex, std::string(common) + fragment};
}

}  // namespace

ShaderPair body_shaders() {
  return pair(body_vertex, body_fragment);
}
ShaderPair point_shaders() {
  return pair(point_vertex, point_fragment);
}
ShaderPair ground_shaders() {
  return pair(ground_vertex, ground_fragment);
}
ShaderPair shadow_shaders() {
  return pair(shadow_vertex, shadow_fragment);
}
ShaderPair sky_shaders() {
  return pair(sky_vertex, sky_fragment);
}
ShaderPair wall_shaders() {
  return pair(wall_vertex, wall_fragment);
}

}  // namespace aureole::render
