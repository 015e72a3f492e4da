// Plan of a batch: commands and their options (docs/guide/batch.md).
//
//   {"format": "sonarcal-batch/1",
//    "entries": [
//      {"name": "tank", "command": "simulate",
//       "options": {"scene": "tank.gltf", "sonar": "p900-45", "poses": "poses.json",
//                   "params": ["a.json", "b.json"], "seed": [1, 2, 3], "noise": true}},
//      {"name": "judged", "command": "compare", "for_each": "tank",
//       "options": {"real": "recorded", "sim": "{out}"}}]}
//
// Options are those of the command, without dashes. A list has one value per job: the jobs of an entry are
// all combinations of its lists, with the last list varying fastest. {"from": 0, "to": 10000, "step": 2500}
// stands for the list of ranges "0:2500", "2500:5000" and so on. "rows": [{...}, {...}] sets several
// options together, one job per row, combined with the lists. An entry with "for_each" runs after each job of
// the named entry. In its words, {out} is the output folder of that job, and {params} the value of that job's
// option. An entry with "for_all" runs after all jobs of the named entry; {out} is the list of their output
// folders, separated by commas. Paths are relative to the folder of the plan.
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
  std::map<std::string, std::string> options;  // as resolved; "true" for flags
  std::vector<std::string> arguments;          // words after the command, without --out
  std::vector<std::string> after;              // ids of the jobs whose output it uses
  std::string key;  // SHA-256 of command, arguments, and contents of the named files
};

struct BatchPlan {
  std::filesystem::path folder;  // absolute; paths of the jobs are relative to it
  std::vector<BatchJob> jobs;    // each after the one that it needs
};

// Reads a plan. `out`: folder of the batch, absolute; jobs write into its folders <id>. `root`: the commands
// with their options. Throws DataError with file, line and key for errors in the plan: duplicate names,
// commands that a batch does not run, unknown options or those of the batch itself (out, resume, json,
// quiet), unknown words in braces, more than 100,000 jobs.
BatchPlan ReadBatchPlan(const std::filesystem::path& file, const std::filesystem::path& out,
                        const CLI::App& root);

}  // namespace sonarcal::batch
