// gnuplot as a process: a script goes in, an SVG comes out.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace aureole {

/// A picture before it is drawn.
struct Figure {
  std::string name;         ///< Of its files, without the end.
  std::string description;  ///< For those who cannot see it.
  std::string script;       ///< With its data; the picture goes to gnuplot's standard output.
};

/// Errors: there is none on the PATH; the sentence names the package.
Status find_gnuplot();

/// Writes DIR/NAME.svg, and the script to DIR/scripts/NAME.gp, from which
/// `gnuplot NAME.gp > NAME.svg` draws it again. The same script gives the same bytes. Errors: what
/// gnuplot complains of; a file that cannot be written.
Status draw(const Figure& figure, const std::filesystem::path& out);

}  // namespace aureole
