// Materials, as a user writes them: by a name, by coefficients or by a colour.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/range.h"
#include "engine/optics/coat.h"
#include "shaders/shared/shared.h"

namespace quadgraph {

// Index of refraction, inside over outside, of a material that says none.
inline constexpr float default_eta = 1.3f;

// Of a surface, GGX alpha, and that of one that nothing is said of.
inline constexpr Range roughness_range{.low = 0.02, .high = 1};
inline constexpr Range transmission_range{.low = 0, .high = 1};  // 0: smooth
inline constexpr float default_roughness = 0.3f;

// Names in the order they are listed to the user.
const std::vector<std::string>& material_names();

// Where the coefficients of such a name are from, in words. Throws InputError if there is none of it.
std::string_view material_source(std::string_view name);

// How rough the surface is of a material of that text: what its roughness= says, else what its name brings along.
// Nothing if neither says it, also where the text is not of such a material.
std::optional<float> stated_roughness(std::string_view text);

// "none", "veins", "clouds", ..., as `pattern=` takes it.
std::string_view pattern_name(const gpu::Material& material);

// Parses "marble" (a name), or "sigma_s_prime=2.0,sigma_a=0.01,eta=1.3" with one value or R/G/B each; eta may be left
// out (default_eta), the other two are required. Instead of these, "reflectance=0.8/0.6/0.5,mean_free_path=0.5" takes
// the colour that a thick body shows in white light (engine/optics/colour.h) and 1 / sigma_t, mm, and
// "sigma_s=20,g=0.9,sigma_a=0.01" the scattering of a phase function of mean cosine g, whose reduced coefficient is
// (1 - g) sigma_s; g beside a sigma_s_prime, or a name, says what that was reduced by. "NAME,key=value" overrides a
// named material. "pattern=veins,period=16,sharpness=14" mixes in second_sigma_s_prime and second_sigma_a, or
// second_reflectance and second_mean_free_path, or second_sigma_s and second_g. "roughness=0.1" and
// "coat=water,coat_roughness=0.1" are of the surface (stated_roughness, stated_coat). Throws InputError naming the
// field, what was found and what is allowed (sigma_s_prime, sigma_a 0 to 1e6, eta in [1, 3], mean_free_path > 0, g
// above -1 and below 1, roughness in roughness_range; all finite).
gpu::Material parse_material(std::string_view text);

// What is known of the angles by which light scatters: g, their mean cosine, 0 where nothing is; where it is not the
// same everywhere, that alone.
struct ScatteringAngles {
  glm::vec3 g{0};
  bool same = true;

  bool operator==(const ScatteringAngles&) const = default;
};
ScatteringAngles angles_of(const gpu::Material& material);
ScatteringAngles angles_of(std::span<const ScatteringAngles> bodies);

// What a solution knows of them: the reduced coefficient alone, what sweeps do (shaders/shared/forward_scattering.h),
// or that and from walks what is left.
enum class KnownAngles { reduced, swept, measured };

// What is to be said of what the stated error does not know of them; sweeps and walks do where they are the same
// everywhere. Empty where there is nothing.
std::string phase_warning(const ScatteringAngles& angles, KnownAngles known);

// Throws InputError if a coefficient is out of range.
void check_material(const gpu::Material& material);

}  // namespace quadgraph
