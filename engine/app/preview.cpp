#include "engine/app/preview.h"

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/base/regular_file.h"

namespace quadgraph {
namespace {

constexpr std::uintmax_t most_bytes = 65536;  // of news

}  // namespace

std::optional<News> read_news(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const std::string text = text_of_regular_file(path, most_bytes, "news");
  try {
    const Json document = parse_json(text);
    const JsonField field(document, "");
    field.allow({"body", "progress", "failed"});
    News news;
    if (const auto body = field.find("body")) news.body = body->text();
    if (const auto progress = field.find("progress")) news.progress = progress->text();
    if (const auto failed = field.find("failed")) news.failed = failed->text();
    return news;
  } catch (const InputError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
}

Preview::Preview(std::filesystem::path news, const Scene& wanted)
    : news_(std::move(news)),
      method_(wanted.solve.method),
      active_layers_(wanted.solve.active_layers),
      show_(wanted.render.show) {}

Scene Preview::before(Scene wanted) {
  wanted.solve.method = Method::shortest_path;
  wanted.solve.active_layers = 0;
  wanted.render.show = {};
  return wanted;
}

Scene Preview::after(Scene shown, const std::filesystem::path& body) const {
  shown.body = body;
  if (shown.cuts.empty()) {
    shown.solve.method = method_;
    shown.solve.active_layers = active_layers_;
    if (shown.render.show == Show{}) shown.render.show = show_;
  }
  return shown;
}

std::optional<News> Preview::heard() {
  if (failed()) return std::nullopt;
  const auto news = read_news(news_);
  if (!news || *news == last_) return std::nullopt;
  last_ = *news;
  return last_;
}

void Preview::fail(std::string why) {
  last_ = {.body = {}, .progress = {}, .failed = std::move(why)};
}

std::string Preview::label() const {
  const std::string what = "Preview of the surface alone, by shortest paths. ";
  if (failed()) return what + "There is no baked body: " + last_.failed;
  return what + "The body is being baked" + (last_.progress.empty() ? "" : ": " + last_.progress);
}

}  // namespace quadgraph
