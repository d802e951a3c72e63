// Which parts of a scene its tracks change, so that every key can be checked without the rest of the scene.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/scene/track.h"

namespace quadgraph {

// A part that no track of another part changes: a member of the scene, or an entry of one that is an array.
struct TrackPart {
  Json document;                                             // the scene with nothing but its body and this part
  std::vector<std::pair<const Track*, std::string>> tracks;  // and where in `document` each puts its values
  std::set<double> frames;                                   // of all keys of these tracks

  // Throws InputError as put.
  Json at(double frame) const;

  // Values that are read when all keys are checked.
  double values() const;
};

// `still`: the scene without tracks; `tracks` must outlive the parts, and put all of their values into `still`.
std::vector<TrackPart> track_parts(const Json& still, const std::vector<Track>& tracks);

}  // namespace quadgraph
