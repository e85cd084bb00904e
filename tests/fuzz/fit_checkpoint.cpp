// Where a search for the material stood, and what goes on from there.
#include "doublet/fit/minimise.h"
#include "harness.h"

namespace {

using namespace doublet;

class Bowl : public Objective {
public:
  int parameter_count() const override { return 2; }
  MatrixRM evaluate(const MatrixRM &samples, const Context &) override {
    return (samples.array() - 0.7).square().rowwise().sum();
  }
};

} // namespace

DOUBLET_HARNESS(fit_checkpoint) {
  MinimiseOptions options;
  options.checkpoint = fuzz::put("fit_checkpoint.txt", input);
  options.problem = "bowl";
  options.make_optimizer = [](int dimension, std::uint64_t seed) {
    CmaEsOptions few;
    few.seed = seed;
    few.max_evaluations = 24;
    return create_cma_es(dimension, few);
  };
  Bowl bowl;
  fuzz::expect_read_or_refused([&] { minimise(bowl, options); });
}
