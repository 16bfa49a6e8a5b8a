// Cuts a child's output into lines, however the reads fall.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace aureole {

class LineSplitter {
 public:
  /// Longer lines are cut into pieces of this many bytes, so that each can be written at once (a
  /// pipe takes 4096 bytes whole).
  static constexpr std::size_t max_line_bytes = 4000;

  /// Calls `line` for every line that is complete now, without its line end.
  void add(std::string_view bytes, const std::function<void(const std::string&)>& line);
  /// The output has ended: what is left is a line too.
  void finish(const std::function<void(const std::string&)>& line);

 private:
  std::string begun_;
};

}  // namespace aureole
