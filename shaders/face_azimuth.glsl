// Azimuths about the normal of a face in its own frame, so that they move with the body: 2 pi frac(b + face / golden
// ratio), b the radical inverse of `ray` in base 2. In units of 2^-32, where the fraction costs nothing.
float face_azimuth(uint face, uint ray) {
  uint turn = bitfieldReverse(ray) + face * 2654435769u;
  return 6.2831853 * (float(turn >> 8u) * exp2(-24.0));
}
