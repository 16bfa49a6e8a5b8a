// What each command says, and with which exit code it ends, when it is asked for what cannot be.
#include "tests/processes/running.h"

using aureole::test::Running;

namespace {

struct Case {
  std::vector<std::string> words;
  std::string exit_code;
  std::string sentence;  ///< A part of the last line on stderr.
};

// docs/operating.md: 1, something failed; 2, something in the command line or a file is wrong.
const std::vector<Case> cases{
    {{"status", "--url", "http://localhost:1"}, "1", "does not answer"},
    {{"status", "--url", "nonsense"}, "2", "is not a URL like http://localhost:8080"},
    {{"region"}, "2", "--region is required"},
    {{"region", "--region", "9"}, "2", "has regions 0 to 3"},
    {{"region", "--region", "0", "--listen", "127.0.0.1"}, "2", "--listen: "},
    {{"region", "--region", "0", "--state", "/proc/nowhere"}, "2", "--state: "},
    {{"gateway", "--region", "r0=nowhere"}, "2", "expected host:port"},
    {{"gateway"}, "2", "--region"},
    {{"play", "--web-root", "/nowhere", "--port", "0"}, "2", "there is no /nowhere/index.html"},
    {{"play", "--world", "nowhere"}, "2", "expected a world file or the name of a shipped world"},
    {{"simulate", "--layout", "nowhere"}, "2", "found no such file"},
    {{"simulate", "--seeds", "0"}, "2", "not in range"},
    {{"simulate", "--json", "/nowhere/x"}, "1", "cannot write /nowhere/x"},
    {{"experiment", "row"}, "2", "row not in {column,corner,grid}"},
    {{"experiment", "column", "--json", "/nowhere/x"}, "1", "cannot write /nowhere/x"},
    {{"experiment", "figures", "--out", "/proc/x"}, "1", "cannot make the folder /proc/x"},
    {{"bench", "nothing"}, "2", "there is no 'nothing'; expected one of physics"},
};

}  // namespace

TEST_CASE(
    "every command that cannot do what it is asked says why in its last line, and how it ended") {
  for (const Case& c : cases) {
    std::string line;
    for (const std::string& word : c.words) line += " " + word;
    INFO("aureole" << line);
    Running command(AUREOLE_BINARY, c.words);
    CHECK(command.wait_for_end() == "exit code " + c.exit_code);
    INFO(command.all());
    REQUIRE_FALSE(command.err.empty());
    CHECK(command.err.back().rfind("aureole: ", 0) == 0);
    CHECK(command.err.back().find(c.sentence) != std::string::npos);
    CHECK(command.out.empty());
  }
}
