#include "common.h"

#include "doublet/files/files.h"
#include "doublet/files/hash.h"

namespace doublet::python {

void bind_files(py::module_ &m) {
  m.def("write_garment", &write_garment, py::arg("path"), py::arg("garment"), Release(), "Writes garment.npz atomically.");
  m.def("read_garment", &read_garment, py::arg("path"), py::arg("actor"), Release(),
        "garment.npz of this actor. Raises FileNotFoundError, or Error naming file and array.");
  m.def("write_actor", &write_actor, py::arg("path"), py::arg("actor"), Release(), "Writes actor.npz atomically.");
  m.def("read_actor", &read_actor, py::arg("path"), Release(),
        "actor.npz. Raises FileNotFoundError, or Error naming file and array.");
  m.def("write_performance", &write_performance, py::arg("path"), py::arg("performance"), Release(),
        "Writes performance.npz atomically.");
  m.def("read_performance", &read_performance, py::arg("path"), py::arg("actor"), Release(),
        "performance.npz of this actor. Raises FileNotFoundError, or Error naming file and array.");
  m.def("write_segmentation", &write_segmentation, py::arg("path"), py::arg("segmentation"), Release(),
        "Writes segmentation.npz atomically.");
  m.def("read_segmentation", &read_segmentation, py::arg("path"), Release(),
        "segmentation.npz. Raises FileNotFoundError, or Error naming file and array.");
  m.def("write_body", &write_body, py::arg("path"), py::arg("fit"), Release(), "Writes body.npz atomically.");
  m.def("read_body", &read_body, py::arg("path"), Release(),
        "body.npz. Raises FileNotFoundError, or Error naming file and array.");
  m.def("write_proxies", &write_proxies, py::arg("path"), py::arg("capsules"), py::arg("skeleton"), Release(),
        "Writes proxies.json atomically.");
  m.def("read_proxies", &read_proxies, py::arg("path"), py::arg("skeleton"), Release(),
        "proxies.json of this skeleton. Raises FileNotFoundError, or Error naming file and capsule.");
  m.def("write_observations", &write_observations, py::arg("path"), py::arg("observations"), Release(),
        "Writes observations.npz atomically.");
  m.def("read_observations", &read_observations, py::arg("path"), Release(),
        "observations.npz. Raises FileNotFoundError, or Error naming file and array.");
  m.def("hash_files", &hash_files, py::arg("path"), Release(),
        "SHA-256 of a file in hexadecimal digits; of a folder that of the names and contents of all files in it.");
}

} // namespace doublet::python
