#include "engine/solve/refractions.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>

#include "engine/base/error.h"
#include "engine/optics/rough_boundary.h"
#include "engine/optics/surface_boundary.h"
#include "engine/reference/operator.h"

namespace quadgraph {
namespace {

double square_of_step(std::uint32_t step) {
  const double root = static_cast<double>(step) / gpu::REFLECTANCE_STEPS;
  return root * root;
}

// Refraction::reflectance of that surface, and behind it, of a rough one, its rough_boundary.
constexpr std::size_t table_values = gpu::REFLECTANCE_VALUES + gpu::BOUNDARY_VALUES;

std::array<float, table_values> reflectances(const OpticalSurface& surface) {
  std::array<float, table_values> found{};
  constexpr std::uint32_t row = gpu::REFLECTANCE_ROW;
  for (std::uint32_t k = 0; k < row * row; ++k) {
    found[k] = static_cast<float>(rough_reflectance(square_of_step(k % row), square_of_step(k / row), surface));
  }
  for (std::uint32_t k = 0; k < row; ++k) {
    found[row * row + k] = static_cast<float>(coat_reflectance(square_of_step(k), surface));
  }
  if (surface.rough()) std::ranges::copy(rough_boundary(surface), found.begin() + gpu::REFLECTANCE_VALUES);
  return found;
}

// boundary: address of its rough_boundary.
gpu::OpticalSurface on_device(const OpticalSurface& surface, std::uint64_t boundary) {
  gpu::OpticalSurface found = single_precision(surface);
  if (!surface.rough()) return found;
  found.roughness = facet_roughness(surface);
  found.boundary = {static_cast<std::uint32_t>(boundary), static_cast<std::uint32_t>(boundary >> 32)};
  return found;
}

gpu::Refraction refraction(const OpticalSurface& surface, std::uint32_t entering, std::uint64_t reflectance) {
  return {.surface = on_device(surface, reflectance + gpu::REFLECTANCE_VALUES * sizeof(float)),
          .transmitted = static_cast<float>(diffuse_transmittance(surface)),
          .kept = static_cast<float>(2 * fresnel_moment(1, surface)),
          .radiance_norm = static_cast<float>(radiance_norm(surface)),
          .entering = entering,
          .reflectance = reflectance};
}

gpu::Boundary single_precision(const Boundary& boundary) {
  return {static_cast<float>(boundary.k11), static_cast<float>(boundary.k12), static_cast<float>(boundary.k22),
          static_cast<float>(boundary.source), static_cast<float>(boundary.reflected)};
}

template <typename Enum>
constexpr std::size_t value_count = Names<Enum>::values.size();

}  // namespace

std::uint32_t BodyBoundaries::bits() const {
  if (std::ranges::adjacent_find(of_body, std::not_equal_to()) == of_body.end()) return 0;
  return std::bit_ceil(static_cast<std::uint32_t>(of_body.size())) - 1;
}

double BodyBoundaries::least_k11() const {
  return std::ranges::min(of_body, {}, &Boundary::k11).k11;
}

std::vector<OpticalSurface> different_surfaces(std::span<const OpticalSurface> surfaces) {
  std::vector<OpticalSurface> different;
  for (const OpticalSurface& surface : surfaces) {
    if (std::ranges::find(different, surface) == different.end()) different.push_back(surface);
  }
  return different;
}

Refractions::Refractions(device::Device& device, std::uint32_t bodies)
    : device_(device),
      surfaces_(bodies),
      on_device_(device, bodies * sizeof(gpu::Refraction), device::Place::device, "material/refraction of bodies"),
      reflectances_(device, bodies * table_values * sizeof(float), device::Place::device,
                    "material/reflectance of bodies"),
      boundaries_on_host_(bodies * value_count<Method> * value_count<Source> * value_count<Model>),
      boundaries_on_device_(device, boundaries_on_host_.size() * sizeof(gpu::Boundary), device::Place::device,
                            "operator/boundaries of bodies") {
  write();
}

void Refractions::write() {
  const std::vector<OpticalSurface> different = different_surfaces(surfaces_);
  std::vector<gpu::Refraction> kinds, bodies;
  std::vector<std::array<float, table_values>> tables;
  for (const OpticalSurface& surface : different) {
    const auto number = static_cast<std::uint32_t>(kinds.size());
    tables.push_back(reflectances(surface));
    kinds.push_back(refraction(surface, number, reflectances_.address() + number * sizeof(tables.front())));
  }
  device::write_bytes(device_, reflectances_, std::as_bytes(std::span(tables)));
  for (const OpticalSurface& surface : surfaces_) {
    bodies.push_back(kinds[static_cast<std::size_t>(std::ranges::find(different, surface) - different.begin())]);
  }
  device::write_bytes(device_, on_device_, std::as_bytes(std::span(bodies)));
  boundaries_.clear();
}

std::vector<float> Refractions::eta() const {
  std::vector<float> found;
  for (const OpticalSurface& surface : surfaces_) found.push_back(static_cast<float>(surface.eta));
  return found;
}

bool Refractions::take(std::vector<OpticalSurface> wanted) {
  if (wanted == surfaces_) return false;
  surfaces_ = std::move(wanted);
  write();
  return true;
}

bool Refractions::set(std::span<const float> eta) {
  if (eta.size() != 1 && eta.size() != surfaces_.size()) {
    throw InputError("eta: " + std::to_string(eta.size()) + " found, one for all, or one for each of " +
                     std::to_string(surfaces_.size()) + " bodies wanted");
  }
  for (const float index : eta) check_eta(static_cast<double>(index));
  std::vector<OpticalSurface> wanted = surfaces_;
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i].eta = double{eta[eta.size() == 1 ? 0 : i]};
  return take(std::move(wanted));
}

bool Refractions::set_finishes(std::span<const Finish> finishes) {
  if (finishes.size() > 1 && finishes.size() != surfaces_.size()) {
    throw InputError("finishes: " + std::to_string(finishes.size()) + " found, one for all, or one for each of " +
                     std::to_string(surfaces_.size()) + " bodies wanted");
  }
  std::vector<OpticalSurface> wanted = surfaces_;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    static_cast<Finish&>(wanted[i]) = finishes.empty() ? Finish{} : finishes[finishes.size() == 1 ? 0 : i];
  }
  return take(std::move(wanted));
}

std::vector<std::uint32_t> Refractions::head(std::uint32_t faces) const {
  const std::uint64_t address = on_device_.address();
  return {static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(address >> 32), faces};
}

std::size_t Refractions::first_of(Method method, Source source, Model model) const {
  const std::size_t by_source =
      static_cast<std::size_t>(method) * value_count<Source> + static_cast<std::size_t>(source);
  return surfaces_.size() * (by_source * value_count<Model> + static_cast<std::size_t>(model));
}

const BodyBoundaries& Refractions::boundaries(Method method, Source source, Model model) {
  const std::tuple key(method, source, model);
  if (const auto known = boundaries_.find(key); known != boundaries_.end()) return known->second;
  const std::size_t first = first_of(method, source, model);
  BodyBoundaries found{.of_body = {}, .on_device = boundaries_on_device_.address() + first * sizeof(gpu::Boundary)};
  for (const OpticalSurface& surface : surfaces_) {
    const auto before = std::ranges::find(surfaces_, surface) - surfaces_.begin();  // the first body of this surface
    const bool known = static_cast<std::size_t>(before) < found.of_body.size();
    found.of_body.push_back(known ? found.of_body[static_cast<std::size_t>(before)]
                                  : boundary_of(method, source, model, surface));
    boundaries_on_host_[first + found.of_body.size() - 1] = single_precision(found.of_body.back());
  }
  device::write_bytes(device_, boundaries_on_device_, std::as_bytes(std::span(boundaries_on_host_)));
  return boundaries_.emplace(key, std::move(found)).first->second;
}

}  // namespace quadgraph
