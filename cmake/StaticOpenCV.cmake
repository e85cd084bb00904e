# Targets opencv_core ... of Debian's static libraries in the place of those of find_package(OpenCV), for wheels: so none of what
# the shared ones are linked to comes along (LAPACK, OpenGL and X11; TBB alone is used). The functions of these that OpenCV refers
# to are in opencv_unreached.cpp.
find_package(TBB REQUIRED)
find_package(ZLIB REQUIRED)
add_library(opencv_unreached STATIC ${CMAKE_CURRENT_LIST_DIR}/opencv_unreached.cpp)
doublet_warnings(opencv_unreached)

function(doublet_static_opencv module)
  find_library(DOUBLET_STATIC_opencv_${module} libopencv_${module}.a REQUIRED)
  get_target_property(headers opencv_core INTERFACE_INCLUDE_DIRECTORIES)
  add_library(static_opencv_${module} STATIC IMPORTED GLOBAL)
  set_target_properties(static_opencv_${module} PROPERTIES IMPORTED_LOCATION ${DOUBLET_STATIC_opencv_${module}}
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${headers}" INTERFACE_INCLUDE_DIRECTORIES "${headers}")
  set_property(TARGET static_opencv_${module} PROPERTY INTERFACE_LINK_LIBRARIES ${ARGN})
endfunction()
doublet_static_opencv(core opencv_unreached TBB::tbb ZLIB::ZLIB)
doublet_static_opencv(imgproc static_opencv_core)
doublet_static_opencv(flann static_opencv_core)
doublet_static_opencv(features2d static_opencv_flann static_opencv_imgproc)
doublet_static_opencv(calib3d static_opencv_features2d)
