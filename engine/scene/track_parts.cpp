#include "engine/scene/track_parts.h"

#include <map>

namespace quadgraph {
namespace {

using Pointer = Json::json_pointer;

double count(const Json& value) {
  double values = 1;
  if (!value.is_structured()) return values;
  for (const Json& item : value) values += count(item);
  return values;
}

// "/lights" of "/lights/3/power".
std::string member_of(const std::string& pointer) {
  return pointer.substr(0, pointer.find('/', 1));
}

// "/lights/3" of "/lights/3/power" where the scene has that light, otherwise the member.
std::string part_of(const Json& still, const std::string& pointer) {
  const std::string member = member_of(pointer);
  if (member == pointer || !still.contains(Pointer(member)) || !still[Pointer(member)].is_array()) return member;
  const std::string entry = pointer.substr(0, pointer.find('/', member.size() + 1));
  return still.contains(Pointer(entry)) ? entry : member;
}

}  // namespace

Json TrackPart::at(double frame) const {
  Json changed = document;
  for (const auto& [track, pointer] : tracks) put(changed, pointer, track->at(frame));
  return changed;
}

double TrackPart::values() const {
  return static_cast<double>(frames.size()) * (count(document) + static_cast<double>(tracks.size()));
}

std::vector<TrackPart> track_parts(const Json& still, const std::vector<Track>& tracks) {
  std::set<std::string> whole;
  for (const Track& track : tracks) {
    const std::string part = part_of(still, track.target());
    if (part == member_of(part)) whole.insert(part);
  }
  std::map<std::string, TrackPart> parts;
  for (const Track& track : tracks) {
    const std::string& pointer = track.target();
    const std::string member = member_of(pointer);
    const std::string name = whole.contains(member) ? member : part_of(still, pointer);
    const auto [found, added] = parts.try_emplace(name);
    TrackPart& part = found->second;
    if (added) {
      if (still.contains("body")) part.document["body"] = still["body"];
      if (name != member) part.document[Pointer(member)] = Json::array({still[Pointer(name)]});
      if (name == member && still.contains(Pointer(member))) part.document[Pointer(member)] = still[Pointer(member)];
    }
    part.tracks.emplace_back(&track, name == member ? pointer : member + "/0" + pointer.substr(name.size()));
    for (const auto& [frame, value] : track.keys()) part.frames.insert(frame);
  }
  std::vector<TrackPart> all;
  for (auto& [name, part] : parts) all.push_back(std::move(part));
  return all;
}

}  // namespace quadgraph
