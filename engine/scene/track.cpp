#include "engine/scene/track.h"

#include <algorithm>

namespace quadgraph {
namespace {

bool numbers(const Json& value) {
  return value.is_number() ||
         (value.is_array() && std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_number(); }));
}

Json mixed(const Json& a, const Json& b, double t) {
  if (a.is_number()) return (1 - t) * a.get<double>() + t * b.get<double>();
  Json mix = Json::array();
  for (std::size_t i = 0; i < a.size(); ++i) mix.push_back(mixed(a[i], b[i], t));
  return mix;
}

}  // namespace

void put(Json& document, const std::string& pointer, const Json& value) {
  try {
    Json changed = document;
    const Json::json_pointer target(pointer);
    // What is behind the end of an array would lengthen it, and null is no place.
    for (Json::json_pointer at = target; !at.empty(); at.pop_back()) {
      const Json::json_pointer parent = at.parent_pointer();
      if (document.contains(parent) && document[parent].is_array() && !document.contains(at)) throw InputError("");
    }
    if (target.empty()) throw InputError("");
    changed[target] = value;
    document = std::move(changed);
  } catch (const std::exception&) {
    throw InputError("found \"" + pointer + "\", allowed is the path of a value, like \"/camera/azimuth\"");
  }
}

Track::Track(const JsonField& field) : where_(field.path()) {
  field.allow({"path", "keys", "between"});
  target_ = field.at("path").text();
  if (const auto between = field.find("between")) between_ = between->named<Between>();
  for (const JsonField& key : field.at("keys").items()) {
    const auto parts = key.items();
    if (parts.size() != 2) key.refuse("[FRAME, VALUE]");
    const double frame = parts[0].number();
    const Json& value = parts[1].value();
    if (!keys_.empty() && frame <= keys_.back().first) parts[0].refuse("a frame after the one before");
    const bool alike = keys_.empty() || (value.type_name() == std::string(keys_[0].second.type_name()) &&
                                         value.size() == keys_[0].second.size());
    if (between_ != Between::step && !(numbers(value) && alike)) {
      parts[1].refuse("a number, or as many numbers as in the other keys (or \"between\": \"step\")");
    }
    keys_.emplace_back(frame, value);
  }
  if (keys_.empty()) field.at("keys").refuse("at least one [FRAME, VALUE]");
}

Json Track::at(double frame) const {
  const auto after = std::upper_bound(keys_.begin(), keys_.end(), frame,
                                      [](double wanted, const auto& key) { return wanted < key.first; });
  if (after == keys_.begin()) return keys_.front().second;
  const auto before = after - 1;
  if (after == keys_.end() || between_ == Between::step) return before->second;
  double t = (frame - before->first) / (after->first - before->first);
  if (between_ == Between::smooth) t *= t * (3 - 2 * t);
  return mixed(before->second, after->second, t);
}

void Track::apply(double frame, Json& document) const {
  try {
    put(document, target_, at(frame));
  } catch (const InputError& error) {
    throw InputError(where_ + "/path: " + error.what());
  }
}

}  // namespace quadgraph
