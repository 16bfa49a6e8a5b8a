// The process, and what is done to its SVG.
#include "server/measure/figures/plots/gnuplot.h"

#include <poll.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include "server/measure/figures/plots/panels.h"
#include "server/measure/figures/run_files.h"
#include "server/play/child_process.h"

namespace aureole {
namespace {

/// What viewers are likely to have; gnuplot can name one font only.
constexpr const char* font_list = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

void replace_all(std::string& text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
}

std::string escaped(std::string text) {
  replace_all(text, "&", "&amp;");
  replace_all(text, "<", "&lt;");
  replace_all(text, ">", "&gt;");
  return text;
}

/// Runs `gnuplot SCRIPT > SVG`; what it says on stderr is the error.
Status run_gnuplot(const std::filesystem::path& script, const std::filesystem::path& svg) {
  // The shell only opens the file; paths are arguments and never read as commands.
  auto child = ChildProcess::start(
      "/bin/sh", {"-c", "exec gnuplot \"$1\" > \"$2\"", "sh", script.string(), svg.string()});
  if (!child) return child.error();
  std::string said;
  while (child->descriptor(Output::error) >= 0) {
    pollfd ready{child->descriptor(Output::error), POLLIN, 0};
    poll(&ready, 1, -1);
    child->read(Output::error, [&](const std::string& line) {
      if (!line.empty() && said.size() < 2000) said += (said.empty() ? "" : "\n  ") + line;
    });
  }
  while (child->is_running()) std::this_thread::yield();
  if (child->how_it_ended() == "exit code 0" && said.empty()) return Ok{};
  return Error::format("gnuplot {} ({}):\n  {}", script.string(), child->how_it_ended(), said);
}

}  // namespace

Status find_gnuplot() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((folder + "/gnuplot").c_str(), X_OK) == 0) return Ok{};
  return Error{
      "there is no gnuplot to draw figures with; install Debian's package gnuplot-nox "
      "(docker/setup.sh test does)"};
}

Status draw(const Figure& figure, const std::filesystem::path& out) {
  std::error_code problem;
  std::filesystem::create_directories(out / "scripts", problem);
  if (problem)
    return Error::format("cannot make the folder {}: {}", (out / "scripts").string(),
                         problem.message());
  const auto script = out / "scripts" / (figure.name + ".gp");
  if (auto written = write_whole(script, figure.script); !written) return written;

  const auto svg = out / (figure.name + ".svg"), raw = out / (figure.name + ".svg.raw");
  auto drawn = run_gnuplot(script, raw);
  std::ifstream stream(raw, std::ios::binary);
  std::string picture{std::istreambuf_iterator<char>(stream), {}};
  stream.close();
  std::filesystem::remove(raw, problem);
  if (!drawn) return drawn;

  const std::string name = std::string("font-family=\"") + figure_font + "\"";
  if (picture.find(name) == std::string::npos)
    return Error::format("gnuplot drew nothing for {}", figure.name);
  replace_all(picture, name, std::string("font-family=\"") + font_list + "\"");
  if (const auto from = picture.find("<title>"), to = picture.find("</desc>");
      from != std::string::npos && to != std::string::npos && from < to)
    picture.replace(from, to + 7 - from,
                    "<title>" + escaped(figure.name) + "</title>\n<desc>" +
                        escaped(figure.description) + "</desc>");
  return write_whole(svg, picture);
}

}  // namespace aureole
