// Who may talk to `sonarcal view`: its own page in a browser of this machine, and programs that were told the
// token. A page of another site can make a browser send requests here, and by a name of its own that resolves
// to 127.0.0.1 even read the answers; so every request must name this server as its host, none may come from
// another origin, and whatever the page asks of the program must carry a token that only the printed address
// has, in a header that no foreign page may set.
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

// Headers that are absent are empty.
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

// Why the caller is turned away; nothing where it may come in.
std::optional<ViewRefusal> Refused(const ViewGate& gate, const ViewCaller& caller);

// 32 hexadecimal digits of the system's random numbers.
std::string RandomToken();

}  // namespace sonarcal::view
