// Points in tets and directions that samples of the transport correction take. The shader that includes it, behind
// transport_ray.glsl, has push constants `push` with directions as TransportSweepPush does.
#ifndef QUADGRAPH_SAMPLING_GLSL
#define QUADGRAPH_SAMPLING_GLSL

vec3 on_sphere(float z, float azimuth) {
  float s = sqrt(max(1.0 - z * z, 0.0));
  return vec3(s * cos(azimuth), s * sin(azimuth), z);
}

// Uniform in a tet (Rocchini and Cignoni 2000).
vec4 in_tet(float s, float t, float u) {
  if (s + t > 1.0) {
    s = 1.0 - s;
    t = 1.0 - t;
  }
  if (t + u > 1.0) {
    float before = u;
    u = 1.0 - s - t;
    t = 1.0 - before;
  } else if (s + t + u > 1.0) {
    float before = u;
    u = s + t + u - 1.0;
    s = 1.0 - t - before;
  }
  return vec4(1.0 - s - t - u, s, t, u);
}

// Two unit vectors, orthogonal to each other and to the unit vector n (Duff et al. 2017).
void frame_about(vec3 n, out vec3 a, out vec3 b) {
  float side = n.z < 0.0 ? -1.0 : 1.0;
  float c = -1.0 / (side + n.z), d = n.x * n.y * c;
  a = vec3(1.0 + side * n.x * n.x * c, side * d, -side * n.x);
  b = vec3(d, side + n.y * n.y * c, -n.y);
}

// How many rays of a point are followed at a time: a processor goes on with one while it waits for what another needs.
#ifdef QG_PROCESSOR
const uint ABREAST = 4u;
#else
const uint ABREAST = 1u;
#endif

// Directions that are spread evenly, one after the other.
struct Directions {
  vec3 a, b, axis;  // orthonormal
  vec2 azimuth;     // of the next: cosine and sine
  uint next;
};

vec3 next_of(inout Directions spread) {
  float z = 1.0 - (2.0 * float(spread.next++) + 1.0) / float(push.directions), s = sqrt(max(1.0 - z * z, 0.0));
  vec2 d = s * spread.azimuth;
  const vec2 turn = vec2(-0.737368878, 0.675490294);  // by the golden angle
  spread.azimuth = vec2(turn.x * spread.azimuth.x - turn.y * spread.azimuth.y,
                        turn.y * spread.azimuth.x + turn.x * spread.azimuth.y);
  return d.x * spread.a + d.y * spread.b + z * spread.axis;
}

// The same, turned by three numbers in [0, 1).
Directions turned_by(vec3 turn) {
  Directions spread;
  spread.axis = on_sphere(2.0 * turn.x - 1.0, TWO_PI * turn.y);
  frame_about(spread.axis, spread.a, spread.b);
  spread.azimuth = vec2(cos(TWO_PI * turn.z), sin(TWO_PI * turn.z));
  spread.next = 0u;
  return spread;
}

Ray next_ray(TetPoint at, uint seed, inout Directions spread) {
  uint state = hash(seed + spread.next);
  return ray_from(at, next_of(spread), state);
}

// Where a point that was drawn lies, and how its directions are turned.
struct Place {
  vec4 l;
  vec3 turn;
  uint seed;  // of its rays
};

Place place_of(TransportPoint point) {
  uint start = hash(TRANSPORT_HALVES * point.tet + point.half_of ^ hash(push.seed));
  float u[6];
  for (uint k = 0u; k < 6u; ++k) u[k] = spread_number(start, point.number, k);
  return Place(in_tet(u[0], u[1], u[2]), vec3(u[3], u[4], u[5]), hash(start + point.number));
}

#endif
