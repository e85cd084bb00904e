// Every stage can be created from an installed package.
#include <doublet/bodymodel/body_fitter.h>
#include <doublet/capture/performance_capture.h>
#include <doublet/capture/template_builder.h>
#include <doublet/core/error.h>
#include <doublet/fit/material_estimator.h>
#include <doublet/segment/cloth_segmenter.h>

#include <cstdio>

int main() {
  const auto capture = doublet::PerformanceCapture::create();
  const auto segmenter = doublet::ClothSegmenter::create();
  const auto fitter = doublet::BodyFitter::create();
  const auto optimizer = doublet::create_cma_es(5);
  try {
    doublet::read_session("no such session");
  } catch (const doublet::FileNotFound &error) {
    std::printf("%s\n", error.what());
    return capture && segmenter && fitter && optimizer->ask().cols() == 5 ? 0 : 1;
  }
  return 1;
}
