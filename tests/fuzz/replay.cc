// Replays the corpus of one parser: each file as it is, and COPIES damaged copies of it, the same on every
// run. The parser must read the files, except those whose name begins with refused_.
//
//   fuzz_replay TARGET COPIES CORPUS_FOLDER
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"

namespace {

using sonarcal::fuzz::Parser;

constexpr unsigned kMaxSecondsPerInput = 10;

// Returns why the parser refused the input; empty if it read it.
std::string Try(Parser parser, const std::string& input) {
  alarm(kMaxSecondsPerInput);
  return sonarcal::fuzz::Feed(parser, input);
}

// Cut short, grown, bytes changed, counts made huge, parts repeated: up to four of these together.
std::string Damaged(std::string input, std::mt19937& random) {
  const auto below = [&](std::size_t limit) {
    return static_cast<std::size_t>(random()) % std::max<std::size_t>(limit, 1);
  };
  for (std::size_t change = 0; change <= below(4) && !input.empty(); ++change) {
    // Headers are at the beginning: half of the changes go there.
    const std::size_t at = below(random() % 2 == 0 ? input.size() : std::min<std::size_t>(input.size(), 256));
    switch (below(6)) {
      case 0:
        input.resize(at);
        break;
      case 1:
        input[at] = static_cast<char>(random());
        break;
      case 2:
        input[at] = static_cast<char>(input[at] ^ (1 << below(8)));
        break;
      case 3:
        for (std::size_t i = at; i < std::min(at + 4, input.size()); ++i)
          input[i] = static_cast<char>(random() % 2 == 0 ? 0xff : 0x7f);
        break;
      case 4:
        input.insert(at, input.substr(below(input.size()), below(64)));
        break;
      case 5:
        input.erase(at, below(64));
        break;
    }
  }
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  const Parser parser = argc == 4 ? sonarcal::fuzz::FindParser(argv[1]) : nullptr;
  if (parser == nullptr) {
    std::fprintf(stderr, "usage: %s TARGET COPIES CORPUS_FOLDER, TARGET a folder of tests/fuzz/corpus\n",
                 argv[0]);
    return 2;
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which reserve terabytes
  const rlimit limit{std::size_t{sonarcal::fuzz::kMaxFuzzMemoryMiB} << 20,
                     std::size_t{sonarcal::fuzz::kMaxFuzzMemoryMiB} << 20};
  if (setrlimit(RLIMIT_AS, &limit) != 0) return 1;
#endif
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[3])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  int wrong = 0;
  const int copies = std::atoi(argv[2]);
  for (const auto& file : files) {
    std::ifstream stream(file, std::ios::binary);
    const std::string input{std::istreambuf_iterator<char>(stream), {}};
    // Printed before the parser runs, so that the last line names the input that ended the program.
    const std::string name = file.filename().string();
    std::printf("%s\n", name.c_str());
    std::fflush(stdout);
    const std::string refusal = Try(parser, input);
    if (!refusal.empty()) std::printf("  %s\n", refusal.c_str());
    wrong += refusal.empty() == name.starts_with("refused_") ? 1 : 0;
    std::mt19937 random(1);
    for (int copy = 0; copy < copies; ++copy) Try(parser, Damaged(input, random));
  }
  std::printf("%zu files, %d damaged copies of each\n", files.size(), copies);
  if (wrong > 0) std::printf("%d files read that should be refused, or the other way round\n", wrong);
  return files.empty() || wrong > 0 ? 1 : 0;
}
