// Bounded line buffering; see line_splitter.h.
#include "server/play/line_splitter.h"

namespace aureole {

void LineSplitter::add(std::string_view bytes,
                       const std::function<void(const std::string&)>& line) {
  for (const char c : bytes) {
    if (c != '\n') begun_ += c;
    if (c == '\n' || begun_.size() == max_line_bytes) {
      line(begun_);
      begun_.clear();
    }
  }
}

void LineSplitter::finish(const std::function<void(const std::string&)>& line) {
  if (!begun_.empty()) line(begun_);
  begun_.clear();
}

}  // namespace aureole
