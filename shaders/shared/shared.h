// Types that GLSL and C++ share, in scalar layout. tests/cpp/vk/struct_layout_test.cpp compares every offset and array
// stride in the compiled shaders with offsetof and sizeof.
#ifndef QUADGRAPH_SHARED_H
#define QUADGRAPH_SHARED_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
#define QG_INLINE inline
namespace quadgraph::gpu {
using glm::mat4;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = std::uint32_t;
// In C++ a buffer reference is the device address of its first element.
#define QG_REF(Name) std::uint64_t
#else
#include "shared/buffers.glsl"
#define QG_INLINE
#define QG_REF(Name) Name
#endif

// Invocations per compute workgroup. Every device of Vulkan 1.3 offers at least 128, GPUs 1024, and the
// processor any number.
#define WORKGROUP_SIZE 256
// Elements that EACH gives a workgroup (stride.glsl), however many invocations that has.
#define GROUP_ELEMENTS 256u

// A face takes in light on four quarters: that of each corner, then the middle one.
#define FACE_QUARTERS 4

// Optical coefficients of a point, per RGB channel.
struct Optical {
  vec3 sigma_s_prime;  // 1/mm, reduced scattering, >= 0; 0 where the body is clear
  vec3 sigma_a;        // 1/mm, absorption, >= 0
};

const uint PATTERN_NONE = 0u;
const uint PATTERN_VEINS = 1u;
const uint PATTERN_CLOUDS = 2u;
const uint PATTERN_BANDS = 3u;
const uint PATTERN_RINGS = 4u;
const uint PATTERN_SPOTS = 5u;
const uint PATTERN_CHECKER = 6u;
const uint PATTERN_LAYERS = 7u;
const uint PATTERNS = 8u;

// A material field in object space: two sets of coefficients, mixed by a pattern. One without a pattern uses the first
// three members only.
struct Material {
  vec3 sigma_s_prime;         // 1/mm
  vec3 sigma_a;               // 1/mm
  float eta;                  // refractive index inside over outside, 1 to 3
  uint pattern;               // PATTERN_*
  vec3 second_sigma_s_prime;  // 1/mm, where the pattern is 1
  vec3 second_sigma_a;        // 1/mm
  float period;               // mm from one vein, cloud, band, ring, spot or cell to the next; depth of the upper layer
  float sharpness;            // >= 1, larger: thinner veins and rings, harder edges of clouds, bands, spots and layers
  // Mean cosine of the angle by which light scatters, where that is known, above -1 and below 1; sigma_s_prime is
  // reduced by it.
  vec3 g;
  vec3 second_g;
};

#ifndef __cplusplus
QG_ARRAY(Opticals, Optical);

#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
