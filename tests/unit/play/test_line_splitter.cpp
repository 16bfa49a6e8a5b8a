// Lines come out whole, wherever the reads were cut.
#include "server/play/line_splitter.h"
#include "tests/support/catch.h"

using aureole::LineSplitter;

TEST_CASE("lines are the same at every split point of the output") {
  const std::string text = "one\n\ntwo three\nfour";
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    std::vector<std::string> lines;
    const auto keep = [&](const std::string& line) { lines.push_back(line); };
    LineSplitter splitter;
    splitter.add(text.substr(0, cut), keep);
    splitter.add(text.substr(cut), keep);
    REQUIRE(lines == std::vector<std::string>{"one", "", "two three"});
    splitter.finish(keep);
    REQUIRE(lines.back() == "four");
    splitter.finish(keep);
    REQUIRE(lines.size() == 4);
  }
}

TEST_CASE("a line without an end is passed on in bounded pieces") {
  std::size_t bytes = 0, pieces = 0;
  LineSplitter splitter;
  splitter.add(std::string(3 * LineSplitter::max_line_bytes + 1, 'x'),
               [&](const std::string& line) {
                 REQUIRE(line.size() == LineSplitter::max_line_bytes);
                 bytes += line.size();
                 ++pieces;
               });
  REQUIRE(pieces == 3);
  splitter.finish([&](const std::string& line) { bytes += line.size(); });
  REQUIRE(bytes == 3 * LineSplitter::max_line_bytes + 1);
}
