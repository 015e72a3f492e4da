// Writes a SYNTHETIC set for `sonarcal poses`, seen through a port, with the true poses beside it:
//
//   marker_field_study DIR
#include <iostream>

#include "tests/support/marker_field_files.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: marker_field_study DIR\n";
    return 2;
  }
  sonarcal::testing::WriteFieldFiles(argv[1], {}, true, {.occluders = 3}, 4);
  return 0;
}
