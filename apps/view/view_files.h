// The files by which `sonarcal simulate` makes what the page shows, and the command that does.
#pragma once

#include <map>
#include <string>

#include "apps/view/view_session.h"

namespace sonarcal::view {

struct ViewFiles {
  std::map<std::string, std::string>
      text;             // by name: params.json, poses.json; sonar.json where it was changed
  std::string command;  // `folder` is where the files lie
};

ViewFiles FilesOf(const ViewSession& session, const ViewState& state, const std::string& folder);

}  // namespace sonarcal::view
