// The r1=host:port options, with a sentence for everything that can be wrong with them.
#include "server/commands/peer_options.h"

#include <charconv>
#include <set>

namespace aureole {

Result<std::vector<PeerAddress>> parse_regions(const std::vector<std::string>& texts,
                                               const std::string& option, int count, int self) {
  std::vector<PeerAddress> addresses;
  std::set<int> named;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    int number = -1;
    if (equals != std::string::npos && equals >= 2 && text[0] == 'r') {
      const char* end = text.data() + equals;
      const auto [stop, ec] = std::from_chars(text.data() + 1, end, number);
      if (ec != std::errc{} || stop != end) number = -1;
    }
    if (number < 0)
      return Error::format(
          "{} \"{}\": expected a region and its address, for example r1=127.0.0.1:7001", option,
          text);
    if (number >= count || number == self)
      return Error::format("{} \"{}\": expected one of the other regions; this world has r0 to r{}",
                           option, text, count - 1);
    if (!named.insert(number).second)
      return Error::format("{} \"{}\": r{} has been named before", option, text, number);
    auto endpoint = parse_endpoint(text.substr(equals + 1));
    if (!endpoint) return Error::format("{} r{}: {}", option, number, endpoint.error().message);
    addresses.push_back(
        {PeerId::region(RegionId{static_cast<std::uint16_t>(number)}), std::move(*endpoint)});
  }
  for (int i = 0; i < count; ++i)
    if (i != self && !named.contains(i))
      return Error::format("region r{} is missing: add {} r{}=host:port", i, option, i);
  return addresses;
}

}  // namespace aureole
