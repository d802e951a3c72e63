#include "engine/derivative/surface.h"

#include <cstdint>
#include <utility>

#include "engine/derivative/dual.h"
#include "engine/reference/exitance.h"
#include "engine/reference/received.h"

namespace quadgraph {
namespace {

template <class Value>
struct Light {
  std::vector<Value> exitance, received;
};

template <class Value>
Light<Value> light_of(const Level& level, std::vector<Value> flux, std::span<const Value> received, double reflected) {
  Light<Value> light;
  Value clipped(0);
  light.exitance = clipped_exitance(level, Method::fem, std::move(flux), clipped);
  if (received.empty()) return light;
  std::vector<Value> radiosity = light.exitance;
  for (std::size_t f = 0; f < radiosity.size(); ++f) radiosity[f] = radiosity[f] + received[f] * reflected;
  light.received = received_irradiance(level, std::span<const Value>(radiosity));
  return light;
}

std::vector<Dual> duals(std::span<const glm::dvec3> values, std::span<const glm::dvec3> slopes, int c) {
  std::vector<Dual> result;
  for (std::size_t i = 0; i < values.size(); ++i) result.emplace_back(values[i][c], slopes[i][c]);
  return result;
}

void put_slopes(const std::vector<Dual>& from, int c, std::vector<glm::dvec3>& to) {
  to.resize(from.size(), glm::dvec3(0));
  for (std::size_t i = 0; i < from.size(); ++i) to[i][c] = from[i].slope;
}

}  // namespace

SurfaceLight surface_light(const Level& level, std::span<const glm::dvec3> flux, std::span<const glm::dvec3> received,
                           double reflected) {
  auto [exitance, again] = light_of(level, std::vector<glm::dvec3>(flux.begin(), flux.end()), received, reflected);
  return {std::move(exitance), std::move(again)};
}

Surface::Surface(const Level& level, std::span<const glm::dvec3> flux, std::span<const glm::dvec3> received,
                 double reflected)
    : level_(level),
      flux_(flux.begin(), flux.end()),
      received_(received.begin(), received.end()),
      reflected_(reflected) {}

void Surface::record(int c, Channel& channel) const {
  const Tape::Recording recording(channel.tape);
  channel.by_flux.assign(flux_.size(), 0);
  channel.by_received.assign(received_.size(), 0);
  std::vector<Traced> flux, received;
  for (std::size_t v = 0; v < flux_.size(); ++v) {
    const bool outside = v < level_.surface_vertex_count;
    flux.push_back(outside ? channel.tape.input(flux_[v][c], channel.by_flux[v]) : Traced(flux_[v][c]));
  }
  for (std::size_t f = 0; f < received_.size(); ++f) {
    received.push_back(channel.tape.input(received_[f][c], channel.by_received[f]));
  }
  auto light = light_of(level_, std::move(flux), std::span<const Traced>(received), reflected_);
  channel.exitance = std::move(light.exitance);
  channel.received = std::move(light.received);
}

SurfaceLight Surface::tangent(std::span<const glm::dvec3> flux, std::span<const glm::dvec3> received) const {
  SurfaceLight result;
  for (int c = 0; c < 3; ++c) {
    const std::vector<Dual> before = duals(received_, received, c);
    const auto light = light_of(level_, duals(flux_, flux, c), std::span<const Dual>(before), reflected_);
    put_slopes(light.exitance, c, result.exitance);
    put_slopes(light.received, c, result.received);
  }
  return result;
}

Surface::Inputs Surface::adjoint(const SurfaceLight& weights) const {
  const std::lock_guard lock(serving_);
  Inputs result;
  result.flux.resize(flux_.size(), glm::dvec3(0));
  result.received.resize(received_.size(), glm::dvec3(0));
  for (int c = 0; c < 3; ++c) {
    Channel& channel = channels_[static_cast<std::size_t>(c)];
    if (channel.exitance.empty()) record(c, channel);
    for (std::size_t f = 0; f < channel.exitance.size(); ++f)
      channel.tape.weigh(channel.exitance[f], weights.exitance[f][c]);
    for (std::size_t f = 0; f < channel.received.size(); ++f)
      channel.tape.weigh(channel.received[f], weights.received[f][c]);
    std::fill(channel.by_flux.begin(), channel.by_flux.end(), 0.0);
    std::fill(channel.by_received.begin(), channel.by_received.end(), 0.0);
    channel.tape.back();
    for (std::size_t v = 0; v < channel.by_flux.size(); ++v) result.flux[v][c] = channel.by_flux[v];
    for (std::size_t f = 0; f < channel.by_received.size(); ++f) result.received[f][c] = channel.by_received[f];
  }
  return result;
}

}  // namespace quadgraph
