// One ray of the buried source through the tets; include after the push constants of walk_source.comp.
// Nearly all of its time goes to loads (lavapipe: some 3 loads cost as much as all arithmetic of a tet), so that a tet is
// read only as far as it is new: two words of its crossing, one vertex and, in a varied material, its coefficients.
//
// The ray is carried in barycentric coordinates, which pass from tet to tet with the shared corners: a point then never
// leaves the mesh by rounding. The corner that the next tet does not share always sits in slot 3, opposite the face
// that the ray comes in through.

struct Corner {
  uint id;
  uint place;      // among the corners of the present tet
  vec3 position;   // mm
  float l;         // barycentric coordinate of the ray's point
  vec3 scattered;  // towards this vertex, not yet added to its deposit
};

struct Ray {
  uint tet;
  vec3 direction;
  vec3 power;
  vec3 carry;  // of power, that rounding kept back
};

// Where a ray leaves a tet.
struct Exit {
  uint slot;     // of the corner opposite, 0 to 2
  bool found;    // false in a tet so flat that its faces have no side
  float time;    // length over six volumes, 1/mm^2
  float path;     // mm
  vec4 rate;     // of the barycentric coordinates per time
  vec3 outward;  // normal, not of unit length
};

Corner corner_0, corner_1, corner_2, corner_3;
Optical optical;    // of the present tet
vec3 absorbed;      // by this invocation's rays
vec3 unscattered;   // of them: left through the surface, or still under way at the end

const float NEVER = 1e37;

// Share of the power that is lost along `tau`, 1 - e^-tau, and the mean place of the loss, 0 at entry to 1 at exit,
// 1/tau - 1/(e^tau - 1). Series where these cancel.
void attenuate(vec3 tau, out vec3 lost, out vec3 place) {
  bvec3 small = lessThan(tau, vec3(0.25));
  vec3 t = min(tau, vec3(0.25));
  vec3 series = t * (1.0 - t / 2.0 * (1.0 - t / 3.0 * (1.0 - t / 4.0 * (1.0 - t / 5.0 * (1.0 - t / 6.0)))));
  lost = mix(1.0 - exp(-tau), series, small);
  place = mix(1.0 / tau - (1.0 - lost) / lost, 0.5 - t / 12.0 * (1.0 - t * t / 60.0), small);
}

// Share of the loss that is scattered: never above 1, even where division rounds up.
vec3 albedo() {
  return min(optical.sigma_s_prime / max(optical.sigma_s_prime + optical.sigma_a, vec3(1e-30)), vec3(1));
}

Exit find_exit(vec3 direction) {
  vec3 a = corner_0.position - corner_3.position;
  vec3 b = corner_1.position - corner_3.position;
  vec3 c = corner_2.position - corner_3.position;
  vec3 n_0 = cross(b, c), n_1 = cross(c, a), n_2 = cross(a, b);
  float six_volume = dot(a, n_0);
  float side = six_volume < 0.0 ? -1.0 : 1.0;
  vec3 rate = side * vec3(dot(n_0, direction), dot(n_1, direction), dot(n_2, direction));
  vec3 l = vec3(corner_0.l, corner_1.l, corner_2.l);
  vec3 time = mix(vec3(NEVER), l / -rate, lessThan(rate, vec3(0)));
  Exit exit;
  exit.time = min(time.x, min(time.y, time.z));
  exit.slot = time.x == exit.time ? 0u : time.y == exit.time ? 1u : 2u;
  exit.found = exit.time < NEVER;
  exit.path = exit.time * abs(six_volume);
  exit.rate = vec4(rate, -(rate.x + rate.y + rate.z));
  exit.outward = -side * (exit.slot == 0u ? n_0 : exit.slot == 1u ? n_1 : n_2);
  return exit;
}

// Barycentric coordinates at the exit.
vec4 exit_point(Exit exit) {
  vec4 l = vec4(corner_0.l, corner_1.l, corner_2.l, corner_3.l) + exit.time * exit.rate;
  l = max(l, vec4(0));
  l[exit.slot] = 0.0;
  return l / (l.x + l.y + l.z + l.w);
}

// `scattered` at the mean place of each channel between the ray's point and `l`.
void scatter(uint tet, vec3 scattered, vec4 l, vec3 place) {
  if (push.fem == 1u) {
    corner_0.scattered += scattered * mix(vec3(corner_0.l), vec3(l.x), place);
    corner_1.scattered += scattered * mix(vec3(corner_1.l), vec3(l.y), place);
    corner_2.scattered += scattered * mix(vec3(corner_2.l), vec3(l.z), place);
    corner_3.scattered += scattered * mix(vec3(corner_3.l), vec3(l.w), place);
  } else {
    add_power(push.deposit, tet, scattered);
  }
}

// What the present tet takes from the ray: the exact integral of sigma_s' e^-tau against the basis functions along the
// way to `l`, the rest absorbed.
void cross_tet(inout Ray ray, float length, vec4 l) {
  vec3 extinction = optical.sigma_s_prime + optical.sigma_a;
  vec3 lost, place;
  attenuate(extinction * length, lost, place);
  // The power that is taken is what its float loses, and the difference is carried: the sum over many tets is then exact.
  precise vec3 wanted = ray.power * lost + ray.carry;
  precise vec3 remaining = ray.power - clamp(wanted, vec3(0), ray.power);
  precise vec3 taken = ray.power - remaining;
  ray.carry = wanted - taken;
  ray.power = remaining;
  vec3 scattered = taken * albedo();
  absorbed += taken - scattered;
  scatter(ray.tet, scattered, l, place);
}

void move_to(vec4 l) {
  corner_0.l = l.x;
  corner_1.l = l.y;
  corner_2.l = l.z;
  corner_3.l = l.w;
}

// Leaves all power at the ray's point; in a clear channel it counts as unscattered.
void end_here(Ray ray) {
  vec3 extinction = optical.sigma_s_prime + optical.sigma_a;
  bvec3 clear = equal(extinction, vec3(0));
  vec3 kept = mix(ray.power, vec3(0), clear);
  vec3 scattered = kept * albedo();
  absorbed += kept - scattered;
  unscattered += ray.power - kept;
  scatter(ray.tet, scattered, vec4(corner_0.l, corner_1.l, corner_2.l, corner_3.l), vec3(0));
}

void flush(Corner corner) {
  if (push.fem == 1u) add_power(push.deposit, corner.id, corner.scattered);
}

void swap_with_3(inout Corner corner) {
  Corner other = corner_3;
  corner_3 = corner;
  corner = other;
}

// Puts the corner opposite the exit into slot 3 and returns what lies across.
uvec2 turn(Ray ray, uint slot) {
  if (slot == 0u) {
    swap_with_3(corner_0);
  } else if (slot == 1u) {
    swap_with_3(corner_1);
  } else {
    swap_with_3(corner_2);
  }
  return push.crossings.at[4u * ray.tet + corner_3.place];
}

void enter(inout Ray ray, uvec2 crossing) {
  flush(corner_3);
  ray.tet = crossing.x;
  if (push.even == 0u) optical = push.optical.at[ray.tet];
  uint id = crossing.y >> 8u;
  corner_0.place = crossing.y >> 2u * corner_0.place & 3u;
  corner_1.place = crossing.y >> 2u * corner_1.place & 3u;
  corner_2.place = crossing.y >> 2u * corner_2.place & 3u;
  corner_3 = Corner(id, crossing.y >> 2u * corner_3.place & 3u, push.vertices.at[id], 0.0, vec3(0));
}

// At an outside face from inside: part leaves, the rest goes on mirrored.
void meet_surface(inout Ray ray, uint face, vec3 outward) {
  vec3 n = outward / length(outward);
  float cosine = dot(ray.direction, n);
  if (push.face_kinds.at[face] == FACE_OPEN) {
    vec3 reflected = ray.power * internal_reflectance(cosine, push.eta);
    vec3 leaving = ray.power - reflected;
    unscattered += leaving;
    add_power(push.unscattered, face, leaving);
    ray.power = reflected;
  }
  ray.direction = normalize(ray.direction - 2.0 * cosine * n);
}

// Follows a ray from the point that the corners hold, until its light is spent.
void walk(Ray ray) {
  vec3 end = WALK_END * ray.power;
  for (uint step = 0u; step < MAX_WALK_STEPS; ++step) {
    Exit exit = find_exit(ray.direction);
    if (!exit.found) break;
    vec4 l = exit_point(exit);
    cross_tet(ray, exit.path, l);
    move_to(l);
    bool spent = all(lessThanEqual(ray.power, end));
    if (spent && optical.sigma_s_prime + optical.sigma_a != vec3(0)) break;
    uvec2 crossing = turn(ray, exit.slot);
    if (crossing.x < push.tet_count) {
      enter(ray, crossing);
    } else {
      meet_surface(ray, crossing.x - push.tet_count, exit.outward);
      if (ray.power == vec3(0)) break;
    }
  }
  end_here(ray);
  flush(corner_0);
  flush(corner_1);
  flush(corner_2);
  flush(corner_3);
}
