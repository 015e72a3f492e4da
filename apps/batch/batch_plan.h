// The plan of a batch: which commands run with which options (docs/guide/batch.md).
//
//   {"format": "sonarcal-batch/1",
//    "entries": [
//      {"name": "tank", "command": "simulate",
//       "options": {"scene": "tank.gltf", "sonar": "p900-45", "poses": "poses.json",
//                   "params": ["a.json", "b.json"], "seed": [1, 2, 3], "noise": true}},
//      {"name": "judged", "command": "compare", "for_each": "tank",
//       "options": {"real": "recorded", "sim": "{out}"}}]}
//
// The options are those of the command, without dashes. A list stands for one job each: an entry's jobs are
// all combinations of its lists, the last one running fastest. "rows": [{...}, {...}] gives options that
// belong together, one job a row, combined with the lists. An entry "for_each" another has its jobs once for
// each of the other's, and runs after them; in its words {out} is that job's output folder, and {params} the
// value of that job's option. Paths are relative to the plan's folder.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sonarcal::batch {

struct BatchJob {
  std::string id;                              // "tank/0003"
  std::string command;                         // "simulate"
  std::map<std::string, std::string> options;  // as they were resolved; "true" for flags
  std::vector<std::string> arguments;          // of the command line, after its command, without --out
  std::string after;                           // id of the job whose output it takes; empty for none
  std::string key;  // SHA-256 of command, arguments, and contents of the files they name
};

struct BatchPlan {
  std::filesystem::path folder;  // absolute: where paths of the jobs are relative to
  std::vector<BatchJob> jobs;    // each after the one it needs
};

// `out` is the batch's folder, absolute; jobs write into its folders <id>. `root` has the commands, for their
// options' names. Throws DataError with file, line and key for what is wrong in the plan: names that stand
// twice, commands that a batch does not run, options that a command does not have or that are the batch's own
// (out, resume, json, quiet), words in braces that mean nothing, more than 100,000 jobs.
BatchPlan ReadBatchPlan(const std::filesystem::path& file, const std::filesystem::path& out,
                        const CLI::App& root);

}  // namespace sonarcal::batch
