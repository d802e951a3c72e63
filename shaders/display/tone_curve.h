// From linear radiance to linear display colour, the same on the GPU and in picture files.
#ifndef QUADGRAPH_TONE_CURVE_H
#define QUADGRAPH_TONE_CURVE_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::clamp;
using glm::dot;
using glm::log2;
using glm::max;
using glm::min;
using glm::pow;
#endif

#define TONE_ACES 0u
#define TONE_AGX 1u
#define TONE_LINEAR 2u
#define TONE_AGX_PUNCHY 3u

// What a picture is shown with: the matrix of exposure and white balance, by rows, then a TONE_ curve.
struct ToneTransform {
  vec3 red, green, blue;
  uint curve;
};

// Keeps every curve's quotients finite; all show it as white. What is not a number is taken for that, too.
QG_INLINE float bounded(float value) {
  return value < 1e6f ? max(value, 0.0f) : 1e6f;
}

QG_INLINE float srgb_decode(float code) {
  return code <= 0.04045f ? code / 12.92f : pow((code + 0.055f) / 1.055f, 2.4f);
}

// "ACES Filmic Tone Mapping Curve" (Narkowicz 2015), a rational fit to the ACES reference transform; 1 from 7.4 on.
QG_INLINE float aces_curve(float x) {
  x = min(x, 1e3f);
  return min(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 1.0f);
}

// AgX (Sobotka 2022): the sigmoid through (0, 0) and (1, 1) of slope 2 at its pivot, where middle grey is; powers of
// toe and shoulder are 3 and 3.25, and the scales follow from them.
QG_INLINE float agx_contrast(float x) {
  const float pivot = 0.60606061f, slope = 2.0f;
  const bool toe = x < pivot;
  const float power = toe ? 3.0f : 3.25f, scale = toe ? 0.51227738f : 0.54146416f;
  const float t = slope * (toe ? pivot - x : x - pivot) / scale;
  const float bent = scale * t / pow(1.0f + pow(t, power), 1.0f / power);
  return max(0.5f + (toe ? -bent : bent), 0.0f);
}

// Of a channel of the inset colour: 16.5 stops, 10 of them below middle grey.
QG_INLINE float agx_channel(float x) {
  const float stops = log2(max(x, 1e-10f));
  return agx_contrast(clamp((stops + 12.47393f) / (4.026069f + 12.47393f), 0.0f, 1.0f));
}

// The look "Punchy" of its config: a colour decision list, of which the power darkens and the saturation spreads
// colours about their luminance (ITU-R BT.709).
QG_INLINE vec3 punchy_look(vec3 code) {
  const vec3 darker = vec3(pow(code.x, 1.35f), pow(code.y, 1.35f), pow(code.z, 1.35f));
  const float luminance = dot(vec3(0.2126f, 0.7152f, 0.0722f), darker);
  return luminance + 1.4f * (darker - luminance);
}

// Primaries are moved towards white, so that what is bright loses its colour, and back after the curve. The result are
// the transform's own codes, which are decoded for the laying over backgrounds (matrices: Wrensch 2023).
QG_INLINE vec3 agx_curve(vec3 x, bool punchy) {
  const vec3 inset = vec3(dot(vec3(0.842479062f, 0.0784335999f, 0.0792237451f), x),
                          dot(vec3(0.0423282422f, 0.878468636f, 0.0791661275f), x),
                          dot(vec3(0.0423756549f, 0.0784336000f, 0.879142974f), x));
  vec3 bent = vec3(agx_channel(inset.x), agx_channel(inset.y), agx_channel(inset.z));
  if (punchy) bent = punchy_look(bent);
  const vec3 code = vec3(dot(vec3(1.19687901f, -0.0980208811f, -0.0990297441f), bent),
                         dot(vec3(-0.0528968518f, 1.15190313f, -0.0989611768f), bent),
                         dot(vec3(-0.0529716355f, -0.0980434501f, 1.15107367f), bent));
  return vec3(srgb_decode(clamp(code.x, 0.0f, 1.0f)), srgb_decode(clamp(code.y, 0.0f, 1.0f)),
              srgb_decode(clamp(code.z, 0.0f, 1.0f)));
}

// Linear display colour in [0, 1] of a radiance.
QG_INLINE vec3 tone_mapped(ToneTransform tone, vec3 radiance) {
  const vec3 x =
      vec3(bounded(dot(tone.red, radiance)), bounded(dot(tone.green, radiance)), bounded(dot(tone.blue, radiance)));
  if (tone.curve == TONE_AGX || tone.curve == TONE_AGX_PUNCHY) return agx_curve(x, tone.curve == TONE_AGX_PUNCHY);
  if (tone.curve == TONE_LINEAR) return min(x, vec3(1.0f));
  return vec3(aces_curve(x.x), aces_curve(x.y), aces_curve(x.z));
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
