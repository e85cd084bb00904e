// What Debian's static OpenCV refers to, and doublet never comes to: LAPACK, for decompositions of 25 rows and products of 100
// (there is none of more than 14 here: distances, filters, features, lenses), and OpenGL, for windows. Whoever does come there
// is told so.

#include <stdexcept>
#include <string>

namespace {

[[noreturn]] void unreached(const char *function) {
  throw std::logic_error(std::string("OpenCV called ") + function + ", which is not in this build of doublet");
}

} // namespace

// The arguments do not matter.
#define UNREACHED(name)                                                                                                          \
  extern "C" void name();                                                                                                        \
  extern "C" void name() {                                                                                                       \
    unreached(#name);                                                                                                            \
  }
UNREACHED(sgesv_)
UNREACHED(dgesv_)
UNREACHED(sposv_)
UNREACHED(dposv_)
UNREACHED(spotrf_)
UNREACHED(dpotrf_)
UNREACHED(sgetrf_)
UNREACHED(dgetrf_)
UNREACHED(sgels_)
UNREACHED(dgels_)
UNREACHED(sgeqrf_)
UNREACHED(dgeqrf_)
UNREACHED(sgesdd_)
UNREACHED(dgesdd_)
UNREACHED(cblas_sgemm)
UNREACHED(cblas_dgemm)
UNREACHED(cblas_cgemm)
UNREACHED(cblas_zgemm)
UNREACHED(glXGetProcAddressARB)
