// Texts of errors: short ones as they are, long ones with their beginning and their end.
#include "engine/base/message.h"

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/optics/material.h"

using namespace quadgraph;

TEST_CASE("short messages stay as they are") {
  const std::string text(message_bytes, 'a');
  CHECK(shortened(text) == text);
  CHECK(shortened("").empty());
  CHECK(std::string(InputError("a: found 1, allowed is 2").what()) == "a: found 1, allowed is 2");
}

TEST_CASE("what a terminal would obey is written out") {
  CHECK(shortened("a\x1b[31m\x7f\r \u009b\u00a0\u20ac\n\tb\xc2") == "a\\x1b[31m\\x7f\\x0d \\x9b\u00a0\u20ac\n\tb\xc2");
}

TEST_CASE("long words lose their middle, all else stays") {
  const std::string word(100000, 'x'), kept = std::string(44, 'x') + "..." + std::string(43, 'x');  // and the marks
  CHECK(shortened("a.json: /lights/0: found '" + word + "', allowed is b") ==
        "a.json: /lights/0: found '" + kept + "', allowed is b");
}

TEST_CASE("long texts keep the place and the next step") {
  std::string words;
  for (int i = 0; i < 20000; ++i) words += "word ";
  const std::string text = shortened("a.json: found " + words + "; leave some out");
  CHECK(text.size() <= message_bytes);
  CHECK(text.starts_with("a.json: found word"));
  CHECK(text.ends_with("word ; leave some out"));
}

TEST_CASE("no character is cut") {
  for (const std::size_t shift : {0, 1, 2}) {
    std::string text(shift, 'a');
    for (int i = 0; i < 1000; ++i) text += i % 50 == 0 ? " " : "\u20ac";  // three bytes
    const std::string kept = shortened(text);
    CHECK(kept.size() <= message_bytes);
    CHECK(kept.find("...") != std::string::npos);
    std::string characters = kept;
    std::erase_if(characters, [](char c) { return c == 'a' || c == ' ' || c == '.'; });
    bool whole = characters.size() % 3 == 0;
    for (std::size_t i = 0; i < characters.size(); i += 3) whole = whole && characters.substr(i, 3) == "\u20ac";
    CHECK(whole);
  }
}

TEST_CASE("every error is short, also one that repeats another") {
  const auto message = [](const std::string& text) {
    try {
      parse_material(text);
    } catch (const InputError& error) {
      return std::string(InputError(std::string(100000, 'p') + ": " + error.what()).what());
    }
    return std::string();
  };
  const std::string said = message(std::string(100000, 'x'));
  CHECK(said.size() <= message_bytes);
  CHECK(said.starts_with("ppp"));
  CHECK(said.ends_with("sigma_s_prime=...,sigma_a=...,eta=..."));
}
