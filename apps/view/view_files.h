// Files and command with which `sonarcal simulate` makes the image on the page.
#pragma once

#include <map>
#include <string>

#include "apps/view/view_session.h"

namespace sonarcal::view {

struct ViewFiles {
  // Text by file name: params.json, poses.json, and sonar.json if the sonar was changed.
  std::map<std::string, std::string> text;
  std::string command;  // `folder` is that of the files
};

ViewFiles FilesOf(const ViewSession& session, const ViewState& state, const std::string& folder);

}  // namespace sonarcal::view
