#include "common.h"

#include "doublet/version.h"

PYBIND11_MODULE(_doublet, m) {
  using namespace doublet::python;
  m.doc() = "Native half of doublet; use the package `doublet`.";
  m.attr("__version__") = DOUBLET_VERSION;
  refuse_complex_arrays();
  bind_core(m);
#ifdef DOUBLET_WITH_RAYS
  bind_rays(m);
#endif
#ifdef DOUBLET_WITH_FILES
  bind_files(m);
#endif
#ifdef DOUBLET_WITH_CAPTURE
  bind_capture(m);
#endif
#ifdef DOUBLET_WITH_SEGMENT
  bind_segment(m);
#endif
#ifdef DOUBLET_WITH_BODYMODEL
  bind_bodymodel(m);
#endif
#ifdef DOUBLET_WITH_PBD
  bind_pbd(m);
#endif
#ifdef DOUBLET_WITH_SIMULATE
  bind_simulate(m);
#endif
#ifdef DOUBLET_WITH_ANIMATE
  bind_animate(m);
#endif
#ifdef DOUBLET_WITH_FIT
  bind_fit(m);
#endif
#ifdef DOUBLET_WITH_RECONSTRUCT
  bind_reconstruct(m);
#endif
  name_makers(m);
}
