// A target without libFuzzer: every file of the corpus as it is and in damaged copies, of which there are as
// many as are asked for and which are the same on every run. Files of the corpus are read, but for those
// whose name begins with refused_.
//
//   fuzz_<target> COPIES CORPUS_FOLDER
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

constexpr unsigned kMostSeconds = 10;  // an input

void Try(const std::string& input) {
  alarm(kMostSeconds);
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
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
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s COPIES CORPUS_FOLDER\n", argv[0]);
    return 2;
  }
#if !defined(__SANITIZE_ADDRESS__)  // which reserves terabytes
  const rlimit limit{std::size_t{sonarcal::fuzz::kMostFuzzMemoryMiB} << 20,
                     std::size_t{sonarcal::fuzz::kMostFuzzMemoryMiB} << 20};
  if (setrlimit(RLIMIT_AS, &limit) != 0) return 1;
#endif
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[2])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  int wrong = 0;
  const int copies = std::atoi(argv[1]);
  for (const auto& file : files) {
    std::ifstream stream(file, std::ios::binary);
    const std::string input{std::istreambuf_iterator<char>(stream), {}};
    // Named before it is tried: what ends the program is the line before.
    const std::string name = file.filename().string();
    std::printf("%s\n", name.c_str());
    std::fflush(stdout);
    Try(input);
    const bool is_read = sonarcal::fuzz::last_refusal.empty();
    if (!is_read) std::printf("  %s\n", sonarcal::fuzz::last_refusal.c_str());
    wrong += is_read != !name.starts_with("refused_") ? 1 : 0;
    std::mt19937 random(1);
    for (int copy = 0; copy < copies; ++copy) Try(Damaged(input, random));
  }
  std::printf("%zu files, %d damaged copies of each\n", files.size(), copies);
  if (wrong > 0) std::printf("%d files read that should be refused, or the other way round\n", wrong);
  return files.empty() || wrong > 0 ? 1 : 0;
}
