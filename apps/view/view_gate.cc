#include "apps/view/view_gate.h"

#include <fmt/format.h>

#include <random>

namespace sonarcal::view {
namespace {

// Compares in a time that does not depend on the number of equal characters.
bool SameToken(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

}  // namespace

std::optional<ViewRefusal> Refused(const ViewGate& gate, const ViewCaller& caller) {
  const std::string by_number = fmt::format("127.0.0.1:{}", gate.port);
  const std::string by_name = fmt::format("localhost:{}", gate.port);
  if (caller.host != by_number && caller.host != by_name) {
    return ViewRefusal{403, fmt::format("the request is for another host, expected {}", by_number)};
  }
  if (!caller.origin.empty() && caller.origin != "http://" + by_number &&
      caller.origin != "http://" + by_name) {
    return ViewRefusal{403,
                       fmt::format("the request comes from another site, expected http://{}", by_number)};
  }
  if (caller.method != "GET" && caller.method != "POST") {
    return ViewRefusal{405, "only GET and POST are answered"};
  }
  if (caller.path.starts_with("/api/") && !SameToken(caller.token, gate.token)) {
    return ViewRefusal{
        403, fmt::format("the request lacks the token of the printed address in {}", kViewTokenHeader)};
  }
  return std::nullopt;
}

std::string RandomToken() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random() & 0xffffffffU);
  return token;
}

}  // namespace sonarcal::view
