# One helper that declares a library, one that declares its tests, one that installs the package.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# doublet_library(NAME [PUBLIC targets...] [PRIVATE targets...])
# Target doublet_NAME, alias doublet::NAME, from src/ and include/: a static library, or a shared one with BUILD_SHARED_LIBS, which
# shows all its symbols and promises those of the headers (docs/stability.md).
function(doublet_library name)
  cmake_parse_arguments(arg "" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp)
  add_library(doublet_${name} ${sources})
  add_library(doublet::${name} ALIAS doublet_${name})
  set_target_properties(doublet_${name} PROPERTIES EXPORT_NAME ${name} VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} # a minor version may break what there is
    INSTALL_RPATH "$ORIGIN;${CMAKE_INSTALL_RPATH}") # shared ones find each other beside themselves
  target_compile_features(doublet_${name} PUBLIC cxx_std_20)
  target_include_directories(doublet_${name}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(doublet_${name} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  doublet_warnings(doublet_${name})
  set_property(GLOBAL APPEND PROPERTY DOUBLET_TARGETS doublet_${name})
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
endfunction()

# doublet_headers(NAME): a library of headers alone, from include/. Every other library may use it.
function(doublet_headers name)
  add_library(doublet_${name} INTERFACE)
  add_library(doublet::${name} ALIAS doublet_${name})
  set_target_properties(doublet_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(doublet_${name} INTERFACE cxx_std_20)
  target_include_directories(doublet_${name}
    INTERFACE $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set_property(GLOBAL APPEND PROPERTY DOUBLET_TARGETS doublet_${name})
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
endfunction()

function(doublet_warnings target)
  # -ffp-contract=off: the same bits whether or not the compiler has fused multiply-add.
  # Bitwise instead of logical: a mask of lanes is a bool where there is one lane.
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -ffp-contract=off $<$<BOOL:${DOUBLET_WERROR}>:-Werror>
    $<$<CXX_COMPILER_ID:Clang,AppleClang>:-Wno-bitwise-instead-of-logical>)
endfunction()

# doublet_tests(NAME): tests/NAME/*.cpp become the executable test_NAME; every suite of it is one ctest test.
function(doublet_tests name)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE doublet::${name} GTest::gtest_main)
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(test_${name} PRIVATE DOUBLET_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  doublet_warnings(test_${name})
  set_target_properties(test_${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 14) # in unity builds: two of a length for capture, one for others
  # A test is compiled more often than it runs: two thirds of the time of -O3. What it shares with the libraries is inlined, too.
  target_compile_options(test_${name} PRIVATE
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release>>:-O1;-finline-small-functions;-findirect-inlining>)
  set(suites ${CMAKE_CURRENT_BINARY_DIR}/test_${name}_suites.cmake)
  file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/test_${name}_if_built.cmake
    CONTENT "if(EXISTS \"${suites}\")\n  include(\"${suites}\")\nelse()\n  add_test(test_${name}_NOT_BUILT test_${name}_NOT_BUILT)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${CMAKE_CURRENT_BINARY_DIR}/test_${name}_if_built.cmake)
  add_custom_command(TARGET test_${name} POST_BUILD BYPRODUCTS ${suites} VERBATIM
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:test_${name}> -DPREFIX=${name} -DFILE=${suites} -P ${PROJECT_SOURCE_DIR}/cmake/list_suites.cmake)
endfunction()

function(doublet_install_package)
  get_property(targets GLOBAL PROPERTY DOUBLET_TARGETS)
  install(TARGETS ${targets} EXPORT doubletTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(FILES ${PROJECT_BINARY_DIR}/include/doublet/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/doublet COMPONENT development)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/doublet COMPONENT development)
  foreach(library PoissonRecon ufbx) # which are compiled into ours
    install(FILES ${PROJECT_SOURCE_DIR}/third_party/${library}/LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/doublet/${library} COMPONENT development)
  endforeach()
  install(EXPORT doubletTargets NAMESPACE doublet:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/doublet COMPONENT development)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/doubletConfig.cmake.in ${PROJECT_BINARY_DIR}/doubletConfig.cmake
    INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/doublet)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/doubletConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/doubletConfig.cmake ${PROJECT_BINARY_DIR}/doubletConfigVersion.cmake
      ${PROJECT_SOURCE_DIR}/cmake/doubletRooms.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/doublet COMPONENT development)
endfunction()
