// Access control of `sonarcal view`: accepts its own page in a browser of this machine, and programs that
// know the token. A page of another site can make a browser send requests to this server. With a host name
// that resolves to 127.0.0.1 it can even read the answers. So every request must name this server as its
// host, and must not come from another origin. Every API request must also carry a token in a header that no
// foreign page can set. Only the printed address contains the token.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sonarcal::view {

inline constexpr const char* kViewTokenHeader = "X-Sonarcal-Token";

struct ViewGate {
  int port = 0;
  std::string token;
};

// Request headers; an absent header is empty.
struct ViewCaller {
  std::string_view method;
  std::string_view path;
  std::string_view host;
  std::string_view origin;
  std::string_view token;
};

struct ViewRefusal {
  int status = 403;
  std::string sentence;
};

// Returns the refusal of a caller; nullopt if it is accepted.
std::optional<ViewRefusal> Refused(const ViewGate& gate, const ViewCaller& caller);

// Returns 32 hexadecimal digits of the system's random numbers.
std::string RandomToken();

}  // namespace sonarcal::view
