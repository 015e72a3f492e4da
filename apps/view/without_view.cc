// Takes the place of view_server.cc and the page in a build without SONARCAL_WITH_VIEW.
#include "apps/view/view_server.h"
#include "core/types/error.h"

namespace sonarcal::view {

struct ViewServer::Http {};

ViewServer::ViewServer(ViewApi&, int) {
  throw UsageError("this sonarcal was built without the live view (SONARCAL_WITH_VIEW)");
}
ViewServer::~ViewServer() = default;

// Never called, because no server can be constructed.
void ViewServer::Start() {}
void ViewServer::Stop() {}
int ViewServer::port() const {
  return 0;
}
const std::string& ViewServer::token() const {
  static const std::string none;
  return none;
}
std::string ViewServer::url() const {
  return {};
}

}  // namespace sonarcal::view
