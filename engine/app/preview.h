// What a window shows of a body that another program bakes meanwhile, and what that program says.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "engine/scene/scene.h"

namespace quadgraph {

// What the other program said last.
struct News {
  std::filesystem::path body;  // what has become of the preview; empty as long as it is not baked
  std::string progress;        // the step that the bake is at
  std::string failed;          // why there will be no body

  bool operator==(const News&) const = default;
};

// Of a JSON file with one member: "body", "progress" or "failed", each a text. Nothing if there is no such file yet.
// Throws InputError.
std::optional<News> read_news(const std::filesystem::path& path);

class Preview {
 public:
  // `news`: the file, which is replaced whole. `wanted`: the scene that is to be shown of the baked body.
  Preview(std::filesystem::path news, const Scene& wanted);

  // The scene that is wanted, as a body without levels can be shown: by shortest paths, as it looks.
  static Scene before(Scene wanted);

  // What is shown of the preview, of the baked body: with the method and the view of the inside that are wanted, unless
  // the user has cut the body, which only shortest paths show.
  Scene after(Scene shown, const std::filesystem::path& body) const;

  // The news, if they differ from those before. Throws InputError for a file that says nothing, once.
  std::optional<News> heard();

  // From now on the preview is all there is, and why.
  void fail(std::string why);

  // What to write over the picture.
  std::string label() const;
  bool failed() const { return !last_.failed.empty(); }

 private:
  std::filesystem::path news_;
  Method method_;
  std::uint32_t active_layers_;  // of that method
  Show show_;
  News last_;
};

}  // namespace quadgraph
