// Where a vertex of a mesh is.
uniform ivec3 eye_place;  // the eye is at eye_place + eye_part, in units
uniform vec3 eye_part;
uniform vec3 unit;        // metres; the height exaggerated
uniform float base;       // the foot of walls, in exaggerated metres from the eye

vec3 from_eye_of(ivec3 place) {
  precise vec3 away = (vec3(place - eye_place) - eye_part) * unit;
  if (place.z < 0) away.z = base;
  return away;
}
