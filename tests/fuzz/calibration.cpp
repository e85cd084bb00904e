// Calibrations of every format: the files of one folder, read as what they are found to be.
#include "doublet/capture/calibration_file.h"
#include "harness.h"

DOUBLET_HARNESS(calibration) {
  using namespace doublet;
  // Others are files of a folder.
  static const std::set<std::string> kAlone{"calibration.yml",         "Calib.toml",      "session.qca.txt", "setting.json",
                                            "calibration_studio.json", "transforms.json", "cameras.xml",     "calibration.csv"};
  std::set<std::string> names{"intri.yml",  "extri.yml", "cameras.txt", "images.txt", "cameras.bin",
                              "images.bin", "cam0.yml",  "cam1.yml",    "cam0.xml",   "cam0.json"};
  names.insert(kAlone.begin(), kAlone.end());
  const auto files = fuzz::files_of(input, names);
  std::filesystem::remove_all(fuzz::folder() / "calibration");
  std::filesystem::create_directories(fuzz::folder() / "calibration");
  for (const auto &[name, content] : files)
    fuzz::put("calibration/" + name, content);
  for (const auto &[name, content] : files)
    if (kAlone.count(name))
      fuzz::expect_read_or_refused([&name = name] { read_calibration(fuzz::folder() / "calibration" / name); });
  fuzz::expect_read_or_refused([] { read_calibration(fuzz::folder() / "calibration"); });
}
