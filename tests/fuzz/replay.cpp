// Reads every input of corpora by their harnesses, without libFuzzer: fuzz_replay CORPUS/NAME...
#include "harness.h"

#include <algorithm>
#include <vector>

namespace doublet::fuzz {

std::map<std::string, Harness> &harnesses() {
  static std::map<std::string, Harness> all;
  return all;
}

} // namespace doublet::fuzz

int main(int argc, char **argv) {
  using namespace doublet;
  for (int i = 1; i < argc; ++i) {
    const Path corpus = argv[i];
    const auto found = fuzz::harnesses().find(corpus.filename().string());
    std::vector<Path> inputs;
    for (const auto &entry : std::filesystem::directory_iterator(corpus))
      inputs.push_back(entry.path());
    if (found == fuzz::harnesses().end() || inputs.empty()) {
      std::fprintf(stderr, "%s: expected a folder of inputs with the name of a harness\n", corpus.c_str());
      return 1;
    }
    std::sort(inputs.begin(), inputs.end());
    for (const Path &input : inputs) {
      std::printf("%s\n", input.c_str());
      std::fflush(stdout); // the last line names what ended the process
      found->second(read_text(input));
    }
  }
  std::filesystem::remove_all(fuzz::folder());
  return 0;
}
