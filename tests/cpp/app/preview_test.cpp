// A preview in the place of a body: what is shown of it, and what another program says of the bake.
#include "engine/app/preview.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <fstream>

#include "engine/base/error.h"

using namespace quadgraph;

namespace {

// A file of its own that goes with the test.
class NewsFile {
 public:
  NewsFile() : path_(std::filesystem::temp_directory_path() / ("news-" + std::to_string(getpid()) + ".json")) {}
  ~NewsFile() { std::filesystem::remove(path_); }

  const std::filesystem::path& path() const { return path_; }
  void write(const std::string& text) const { std::ofstream(path_) << text; }

 private:
  std::filesystem::path path_;
};

Scene wanted() {
  Scene scene;
  scene.body = "preview.qgraph";
  scene.solve.method = Method::quadgraph_fv;
  scene.render.show.quantity = Quantity::phi;
  return scene;
}

}  // namespace

TEST_CASE("a preview is shown by shortest paths, and its body as was wanted, seen and lit as it is now") {
  const Preview preview("news.json", wanted());
  Scene scene = Preview::before(wanted());
  CHECK(scene.solve.method == Method::shortest_path);
  CHECK(scene.render.show == Show{});
  scene.view.azimuth = 77;
  scene.material = "skin1";
  const Scene after = preview.after(scene, "body.qgraph");
  Scene expected = wanted();
  expected.body = "body.qgraph";
  expected.view.azimuth = 77;
  expected.material = "skin1";
  CHECK(after == expected);
}

TEST_CASE("a body that was cut as a preview stays with the method that shows cuts") {
  const Preview preview("news.json", wanted());
  Scene scene = Preview::before(wanted());
  scene.cuts.emplace_back();
  CHECK(preview.after(scene, "body.qgraph").solve.method == Method::shortest_path);
}

TEST_CASE("news are heard once, and none after a failure") {
  const NewsFile file;
  Preview preview(file.path(), wanted());
  CHECK(!preview.heard());
  file.write(R"({"progress": "level 0: 10 tets"})");
  REQUIRE(preview.heard());
  CHECK(!preview.heard());
  CHECK(preview.label().find("being baked: level 0: 10 tets") != std::string::npos);
  file.write(R"({"body": "body.qgraph"})");
  const auto news = preview.heard();
  REQUIRE(news);
  CHECK(news->body == "body.qgraph");
  file.write(R"({"failed": "the surface is open"})");
  REQUIRE(preview.heard());
  CHECK(preview.failed());
  CHECK(preview.label().find("no baked body: the surface is open") != std::string::npos);
  file.write(R"({"body": "body.qgraph"})");
  CHECK(!preview.heard());
}

TEST_CASE("news that say nothing name their file") {
  const NewsFile file;
  for (const std::string text : {"", "[1]", R"({"body": 1})", R"({"bodies": "a"})"}) {
    CAPTURE(text);
    file.write(text);
    try {
      read_news(file.path());
      FAIL("they were taken");
    } catch (const InputError& error) {
      CHECK(std::string(error.what()).starts_with(file.path().string() + ": "));
    }
  }
}
